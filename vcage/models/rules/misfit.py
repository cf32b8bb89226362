"""How far a place is from what a relation looks like at its best: tells apart places that all keep the relation."""

from __future__ import annotations

import numpy as np

from vcage.plans.relations import DIRECTIONS, middles
from vcage.schema.plan import TABLE, Relation
from vcage.schema.scene import Scene

GAP = 0.03
"""Free space between neighbours, metres."""


def misfit(r: Relation, subject: np.ndarray, reference: np.ndarray, scene: Scene) -> np.ndarray:
    """(n,) how far boxes (…, 2, 3) are from what the relation looks like at its best, metres, weighted."""
    offset = middles(subject) - middles(reference)
    if r.relation == "center":
        back = _back(subject, scene) if r.reference == TABLE else 0
        return 10 * np.linalg.norm(offset - back, axis=-1)
    if r.relation in ("inside", "on"):
        return np.zeros(len(offset))
    reach = (subject[..., 1, :2] - subject[..., 0, :2] + reference[..., 1, :2] - reference[..., 0, :2]) / 2
    gaps = np.maximum(np.abs(offset) - reach, 0)
    near = np.abs(np.hypot(gaps[..., 0], gaps[..., 1]) - GAP)
    if r.relation not in DIRECTIONS:
        return 3 * near
    direction = np.array(DIRECTIONS[r.relation])
    along, across = offset @ direction, np.abs(offset @ direction[::-1])
    return 30 * np.maximum(reach @ np.abs(direction) - along, 0) + near + across


def _back(subject: np.ndarray, scene: Scene) -> np.ndarray:
    """(n, 2) the middle place: a little away from the robot, to leave room for what stands in front."""
    half = (subject[..., 1, 1] - subject[..., 0, 1]) / 2
    room = scene.workspace.upper[1] - scene.table.centre[1] - half
    back = np.clip(0.3 * room, 0.0, 0.05)
    return np.stack([np.zeros_like(back), back], axis=-1)
