"""Solves a layout plan's relations on the table plane: where each object goes, and how far it turns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.geometry import wrap_angle
from vcage.models.offline.footprints import Footprint
from vcage.schema.plan import TABLE, LayoutPlan, Relation
from vcage.schema.scene import Scene

GAP = 0.03
"""Free space between neighbours, metres."""

STEP = 0.01
"""Spacing of the positions that are tried, metres."""

_DIRECTIONS = {"left_of": (-1, 0), "right_of": (1, 0), "in_front_of": (0, -1), "behind": (0, 1)}


@dataclass(frozen=True)
class Placement:
    """Where an object goes: world x, y of its centre, and how far it turns from where it stands now (radians)."""

    centre: np.ndarray
    turn: float


def arrange(scene: Scene, plan: LayoutPlan, items: Sequence[Footprint]) -> dict[str, Placement]:
    """A placement for every object: relations first, then no overlap, then short distances.

    Objects are placed one after another on a grid of positions, references before those that refer to them;
    each takes the cheapest position left. Where relations and free space cannot both be had, relations give way
    gradually, so no object is ever lost.
    """
    by_id = {item.record.id: item for item in items}
    lower, upper = np.array(scene.workspace.lower), np.array(scene.workspace.upper)
    axes = [np.arange(lo, hi + STEP / 2, STEP) for lo, hi in zip(lower, upper, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    placed: dict[str, Placement] = {}
    for object_id in _order(plan, list(by_id)):
        item = by_id[object_id]
        turn = _turn(item)
        half = item.half_size(turn)
        relations = [r for r in plan.relations if r.subject == object_id]
        supports = {r.reference for r in relations if r.relation in ("inside", "on")}
        boxes = {k: (p.centre, by_id[k].half_size(p.turn)) for k, p in placed.items()}
        cost = _relation_cost(grid, half, relations, boxes, scene)
        cost += _overlap_cost(grid, half, [box for key, box in boxes.items() if key not in supports])
        outside = np.maximum(lower + half - grid, 0) + np.maximum(grid + half - upper, 0)
        cost += 1e3 * outside.sum(axis=1) + 1e-3 * np.linalg.norm(grid - item.centre, axis=1)
        placed[object_id] = Placement(grid[int(np.argmin(cost))], turn)
    return placed


def _order(plan: LayoutPlan, ids: Sequence[str]) -> list[str]:
    """References before subjects; among those that are free, the plan's order, and unplanned objects last."""
    subjects = list(dict.fromkeys(r.subject for r in plan.relations if r.subject in ids))
    waiting = subjects + [object_id for object_id in ids if object_id not in subjects]
    done: list[str] = []
    while waiting:
        needs = {s: {r.reference for r in plan.relations if r.subject == s} - {TABLE} - set(done) for s in waiting}
        ready = next((s for s in waiting if not needs[s] & set(waiting)), waiting[0])
        waiting.remove(ready)
        done.append(ready)
    return done


def _turn(item: Footprint) -> float:
    """Long contents are laid pointing away from the robot; receptacles face it; the rest stays as it is."""
    if item.record.role == "receptacle":
        return float(wrap_angle(-item.record.pose.pose().yaw))
    if item.elongated:
        return float((np.pi / 2 - item.axis + np.pi / 2) % np.pi - np.pi / 2)
    return 0.0


def _relation_cost(
    grid: np.ndarray,
    half: np.ndarray,
    relations: Sequence[Relation],
    boxes: dict[str, tuple[np.ndarray, np.ndarray]],
    scene: Scene,
) -> np.ndarray:
    """(n,) how far each position is from what the relations ask for; metres, weighted."""
    cost = np.zeros(len(grid))
    for relation in relations:
        if relation.reference == TABLE:
            cost += 10 * np.linalg.norm(grid - np.array(scene.table.centre) - _back(scene, half), axis=1)
        elif relation.reference in boxes:
            cost += _one_relation(grid, half, relation.relation, *boxes[relation.reference])
    return cost


def _back(scene: Scene, half: np.ndarray) -> np.ndarray:
    """Offset of the middle place: a little away from the robot, to leave room for what stands in front."""
    room = scene.workspace.upper[1] - scene.table.centre[1] - half[1]
    return np.array([0.0, np.clip(0.3 * room, 0.0, 0.05)])


def _one_relation(grid: np.ndarray, half: np.ndarray, word: str, centre: np.ndarray, other: np.ndarray) -> np.ndarray:
    """(n,) cost of one relation to a box at ``centre`` with half size ``other``."""
    offset = grid - centre
    gaps = np.maximum(np.abs(offset) - half - other, 0)
    distance = np.linalg.norm(gaps, axis=1)
    if word in ("inside", "on", "center"):
        return 10 * np.linalg.norm(offset, axis=1)
    near = np.abs(distance - GAP)
    if word in ("near", "beside"):
        return 3 * near
    direction = np.array(_DIRECTIONS[word])
    along = offset @ direction
    across = np.abs(offset @ direction[::-1])
    wanted = (half + other) @ np.abs(direction)
    return 30 * np.maximum(wanted - along, 0) + near + across


def _overlap_cost(grid: np.ndarray, half: np.ndarray, boxes: Sequence[tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """(n,) penetration of the boxes grown by the gap; metres, weighted far above any relation."""
    cost = np.zeros(len(grid))
    for centre, other in boxes:
        depth = (half + other + GAP - np.abs(grid - centre)).min(axis=1)
        cost += np.where(depth > 1e-9, 100 + 1e3 * depth, 0.0)
    return cost
