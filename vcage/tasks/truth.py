"""Ground truth from the simulator's state: it judges the critic, and is never shown to it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from vcage.schema.episodes import Truth
from vcage.schema.subtasks import Goal
from vcage.tasks.scene_objects import SceneObject

EDGE_TOLERANCE = 0.005
"""An object's centre may be this far outside the opening's rectangle, metres."""

RIM_MARGIN = 0.005
"""An object's bottom is this far below the rim of a deep opening: else it lies across it, metres."""

HEIGHT_TOLERANCE = 0.02
"""An object's bottom may be this far off the floor that carries it, metres: it may lie on another content's edge."""


def goals_hold(goals: Sequence[Goal], objects: Mapping[str, SceneObject], points: Mapping[str, int]) -> Truth:
    """Whether every goal is true of the state.

    Args:
        objects: by id, at their present poses.
        points: receptacle id → the functional point that is meant.
    """
    for goal in goals:
        complaint = _complaint(goal, objects[goal.subject], objects[goal.reference], points[goal.reference])
        if complaint:
            return Truth(success=False, reason=complaint)
    return Truth(success=True, reason="; ".join(f"{g.subject} is {g.relation} {g.reference}" for g in goals))


def _complaint(goal: Goal, subject: SceneObject, receptacle: SceneObject, point_id: int) -> str | None:
    """Why a goal does not hold, or None when it does."""
    if goal.relation not in ("inside", "on"):
        raise ValueError(f"no ground truth is defined for the relation {goal.relation!r}")
    opening = receptacle.asset.opening(receptacle.asset.annotation.functional_point(point_id))
    local = receptacle.pose.inverse().apply(subject.aabb.mean(axis=0))
    outside = np.abs(local[:2] - opening.centre) - np.asarray(opening.size) / 2
    if np.any(outside > EDGE_TOLERANCE):
        return f"{subject.id} is {100 * outside.max():.1f} cm outside {receptacle.id}"
    floor = receptacle.pose.apply([*opening.centre, opening.floor])[2]
    above = subject.aabb[0, 2] - floor
    limit = max(HEIGHT_TOLERANCE, opening.depth - RIM_MARGIN)
    if not -HEIGHT_TOLERANCE <= above <= limit:
        return f"{subject.id} is {100 * above:.1f} cm above the floor of {receptacle.id}"
    if receptacle.pose.rotation()[2, 2] < np.cos(np.radians(10)):
        return f"{receptacle.id} is tipped"
    return None
