"""Ground truth from the simulator's state: it judges the critic, and is never shown to it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from vcage.plans.relations import holds
from vcage.schema.asset import FunctionalPoint
from vcage.schema.episodes import Truth
from vcage.schema.goals import Goal, part_words
from vcage.sim.joints import joint_index, joint_positions
from vcage.sim.world import World
from vcage.tasks.scene_objects import SceneObject

EDGE_TOLERANCE = 0.005
"""An object's centre may be this far outside the opening's rectangle, metres."""

RIM_MARGIN = 0.005
"""An object's bottom is this far below the rim of a deep opening: else it lies across it, metres."""

HEIGHT_TOLERANCE = 0.02
"""An object's bottom may be this far off the floor that carries it, metres: it may lie on another content's edge."""

OPENED, CLOSED = 0.8, 0.12
"""Share of the range beyond which a joint counts as opened, pressed or turned, and below which as closed."""


class Watch:
    """Follows the joints of objects while a world goes on: what was pressed comes back, but it was pressed.

    Args:
        world: that is watched, from now on.
    """

    def __init__(self, world: World):
        self._world = world
        self._furthest = {name: np.abs(joints) for name, joints in world.joints_of_objects().items()}
        world.before_step.append(self._note)

    def stop(self) -> None:
        """Follow them no more."""
        self._world.before_step.remove(self._note)

    def furthest(self, thing: SceneObject, part: str) -> float:
        """How far from rest a part was at most, as a share of its range."""
        model = thing.asset.model
        index = joint_index(model, part)
        return float(self._furthest[thing.id][index]) / abs(model.links[index].joint.far_end)

    def _note(self, world: World) -> None:
        for name, joints in world.joints_of_objects().items():
            self._furthest[name] = np.maximum(self._furthest[name], np.abs(joints))


def goals_hold(goals: Sequence[Goal], objects: Mapping[str, SceneObject], watch: Watch | None = None) -> Truth:
    """Whether every goal is true of the state, or was done.

    Args:
        objects: by id, at their present poses and joint positions.
        watch: of the world while it was done; only what was pressed needs one.
    """
    for goal in goals:
        complaint = _complaint(goal, objects, watch)
        if complaint:
            return Truth(success=False, reason=complaint)
    return Truth(success=True, reason="; ".join(map(str, goals)))


def _complaint(goal: Goal, objects: Mapping[str, SceneObject], watch: Watch | None) -> str | None:
    """Why a goal does not hold, or None when it does."""
    thing = objects[goal.subject]
    if goal.relation in ("open", "closed", "turned"):
        return _joint_complaint(goal, thing)
    if goal.relation == "pressed":
        assert watch is not None and goal.part is not None  # whoever asks for it watches
        share = watch.furthest(thing, goal.part)
        return (
            None
            if share >= OPENED
            else f"the {part_words(goal.part)} of {thing.id} was pressed by {100 * share:.0f} % only"
        )
    if goal.reference not in objects:
        raise ValueError(f"no ground truth is defined for {str(goal)!r}")
    receptacle = objects[goal.reference]
    if goal.relation not in ("inside", "on"):
        there = holds(goal.relation, thing.aabb, receptacle.aabb)  # pyrefly: ignore
        return None if there else f"{thing.id} is not {goal.relation} {receptacle.id}"
    points = [
        point for point in receptacle.asset.annotation.functional_points
        if point.link == goal.part and (point.holds == "in") == (goal.relation == "inside")
    ]  # fmt: skip
    found = [place_complaint(thing, receptacle, point) for point in points]
    return None if None in found else next(iter(found), f"nothing is put {goal.relation} {receptacle.id}")


def _joint_complaint(goal: Goal, thing: SceneObject) -> str | None:
    model, part = thing.asset.model, str(goal.part)
    index = joint_index(model, part)
    share = float(joint_positions(model, thing.joints)[index]) / model.links[index].joint.far_end
    enough = share <= CLOSED if goal.relation == "closed" else share >= OPENED
    state = "turned" if goal.relation == "turned" else "open"
    return None if enough else f"the {part_words(part)} of {thing.id} is {state} by {100 * share:.0f} %"


def place_complaint(subject: SceneObject, receptacle: SceneObject, point: FunctionalPoint) -> str | None:
    """Why an object does not rest at a functional point, or None when it does."""
    opening = receptacle.asset.opening(point)
    frame = receptacle.frame(point.id)
    local = frame.inverse().apply(subject.aabb.mean(axis=0))
    outside = np.abs(local[:2] - opening.centre) - np.asarray(opening.size) / 2
    if np.any(outside > EDGE_TOLERANCE):
        return f"{subject.id} is {100 * outside.max():.1f} cm outside {receptacle.id}"
    floor = frame.apply([*opening.centre, opening.floor])[2]
    above = subject.aabb[0, 2] - floor
    limit = max(HEIGHT_TOLERANCE, opening.depth - RIM_MARGIN)
    if not -HEIGHT_TOLERANCE <= above <= limit:
        return f"{subject.id} is {100 * above:.1f} cm above the floor of {receptacle.id}"
    if receptacle.pose.rotation()[2, 2] < np.cos(np.radians(10)):
        return f"{receptacle.id} is tipped"
    return None
