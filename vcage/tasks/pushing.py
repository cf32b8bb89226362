"""Which straight pushes bring about a goal: where they end, what is in their way, and whether an arm reaches."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Pose, world_aabb
from vcage.plans.relations import holds
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Check, Grasp
from vcage.sim.kinematics import ArmKinematics
from vcage.tasks.feasibility import Feasibility, follow, reach_check, travel
from vcage.tasks.grasps import hand_boxes
from vcage.tasks.ground import Ground
from vcage.tasks.primitives.push import PushWay, push_ways
from vcage.tasks.scene_objects import SceneObject, SolidBox, first_met

SIDES = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
"""Directions in which an object is pushed, in its own frame; a push is known by its number here."""

SHORTEST, LONGEST, STEP = 0.03, 0.6, 0.01
"""Distances that are tried, metres."""

MARGIN = 0.025
"""How far an object may end up from where it was pushed to so that the goal still holds, metres."""

ROOM = 0.012
"""Room that what is pushed keeps beside it and before it, metres."""

TRIED = 3
"""Distances of one direction that are looked into, from the shortest to the longest that would do."""

SPACING = 0.04
"""Between neighbouring hand poses that are looked into along a push, metres."""


@dataclass(frozen=True)
class Push:
    """A straight push that an arm can do.

    Args:
        side: number of its direction in :data:`SIDES`.
        end: object frame in the world.
        finding: its checks, and the arms.
    """

    side: int
    end: Pose
    finding: Feasibility


def examine_pushes(
    thing: SceneObject,
    goal: Goal,
    others: Sequence[SceneObject],
    kinematics: Mapping[str, ArmKinematics],
    ground: Ground,
) -> tuple[list[Push], dict[int, str]]:
    """For each direction a push that brings about the goal, the best first; of the other directions why there is none.

    Args:
        thing: where it stands.
        goal: a relation to one of ``others``.
        others: the other objects of the scene.
        kinematics: by arm.
        ground: of the table.
    """
    found: list[Push] = []
    refused: dict[int, str] = {}
    for side in range(len(SIDES)):
        ends = list(_ends(thing, goal, others, ground, side))
        if not ends:
            most = _farthest(thing, ground, side) * 100
            refused[side] = (
                f"pushed {_words(thing, side)}, at most {most:.0f} cm, it does not come to be so that {goal}"
            )
        for number in np.unique(np.linspace(0, len(ends) - 1, TRIED).astype(int)) if ends else ():
            finding = _examine(thing, side, ends[number], others, kinematics)
            if finding.feasible:
                found.append(Push(side, ends[number], finding))
                refused.pop(side, None)
                break
            refused.setdefault(side, finding.reason)
    return sorted(found, key=lambda push: -push.finding.grasps[0].score), refused


def _ends(thing: SceneObject, goal: Goal, others: Sequence[SceneObject], ground: Ground, side: int) -> Iterator[Pose]:
    """Where the object stands after a push, on the ground and so that the goal holds with a margin; nearest first."""
    near = next(o for o in others if o.id == goal.reference).aabb
    nudges = [np.array([x, y, 0.0]) for x in (-MARGIN, 0, MARGIN) for y in (-MARGIN, 0, MARGIN)]
    for distance in np.arange(SHORTEST, LONGEST, STEP):
        end = _pushed(thing.pose, side, distance)
        box = world_aabb(thing.asset.bounds, end)
        if _inside(box, ground) and all(holds(goal.relation, box + way, near) for way in nudges):  # pyrefly: ignore
            yield end


def _farthest(thing: SceneObject, ground: Ground, side: int) -> float:
    """How far it can be pushed without leaving the ground, metres."""
    inside = [
        d for d in np.arange(0.0, LONGEST, STEP)
        if _inside(world_aabb(thing.asset.bounds, _pushed(thing.pose, side, d)), ground)
    ]  # fmt: skip
    return max(inside, default=0.0)


def _pushed(pose: Pose, side: int, distance: float) -> Pose:
    return Pose(pose.p + distance * (pose.rotation() @ SIDES[side]), pose.q)


def _inside(box: np.ndarray, ground: Ground) -> bool:
    return bool(np.all(box[0, :2] >= ground.lower) and np.all(box[1, :2] <= ground.upper))


def _words(thing: SceneObject, side: int) -> str:
    x, y, _ = thing.pose.rotation() @ SIDES[side]
    if abs(x) > abs(y):
        return "to the right" if x > 0 else "to the left"
    return "away from the robot" if y > 0 else "towards the robot"


def _examine(
    thing: SceneObject, side: int, end: Pose, others: Sequence[SceneObject], kinematics: Mapping[str, ArmKinematics]
) -> Feasibility:
    """Whether an arm can push the object to ``end``, and nothing is in its way."""
    distance = float(np.linalg.norm(end.p - thing.pose.p))
    where = f"{thing.record.phrase} pushed {distance * 100:.0f} cm {_words(thing, side)}"
    met = first_met([_swept(thing, side, distance)], others)
    message = f"nothing is in the way of {where}" if met is None else f"{met.record.phrase} is in the way of {where}"
    free = Check(name="way_free", passed=met is None, message=message)
    if met is not None:
        return Feasibility([free], [])
    checks, grasps = [free], []
    for arm, k in kinematics.items():
        check, score = _examine_arm(thing, end, others, arm, k, where)
        if score is not None:
            grasps.append(Grasp(contact=side, arm=arm, score=round(score, 4)))
        if score is not None or not grasps:
            checks = [free, check]
    return Feasibility(checks, sorted(grasps, key=lambda grasp: (-grasp.score, grasp.arm)))


def _examine_arm(
    thing: SceneObject, end: Pose, others: Sequence[SceneObject], arm: str, kinematics: ArmKinematics, where: str
) -> tuple[Check, float | None]:
    """What decides whether an arm can do a push, and the score of its motion."""
    blocked = None
    for way in push_ways(thing, end, kinematics.arm.gripper):
        poses = _along(way)
        boxes = [SolidBox(part, p) for p in poses for part in hand_boxes(kinematics.arm.gripper, way.opening)]
        met = first_met(boxes, others)
        if met is not None:
            blocked = met.record.phrase
            continue
        path = follow(kinematics, [way.above, *poses, way.up], kinematics.home)
        if path is not None:
            return reach_check("reach_motion", where, True, arm), -travel([kinematics.home, *path, kinematics.home])
    if blocked is not None:
        message = f"{blocked} is in the way of the hand with {where}"
        return Check(name="way_free", passed=False, message=message), None
    return reach_check("reach_motion", where, False, arm), None


def _along(way: PushWay) -> list[Pose]:
    """Hand poses from behind the face to where it is drawn back."""
    path = way.pushed.p - way.touch.p
    count = max(1, int(np.ceil(np.linalg.norm(path) / SPACING)))
    on = [Pose(way.touch.p + share * path, way.touch.q) for share in np.linspace(0, 1, count + 1)]
    return [way.before, *on, way.after]


def _swept(thing: SceneObject, side: int, distance: float) -> SolidBox:
    """What the object sweeps, with room beside it and before it."""
    lower, upper = thing.asset.bounds.copy()
    lower[:2] -= ROOM
    upper[:2] += ROOM
    return SolidBox(
        np.array([lower + np.minimum(SIDES[side] * distance, 0), upper + np.maximum(SIDES[side] * distance, 0)]),
        thing.pose,
    )
