"""Push: an object that cannot be carried is pushed along the table into a requested relation."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Pose
from vcage.plans.relations import holds
from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE
from vcage.schema.subtasks import Check, Refusal, Subtask, TemplateName
from vcage.sim.kinematics import ArmKinematics, follow
from vcage.tasks.feasibility import opens_wide_enough
from vcage.tasks.findings import Feasibility, Report, reach_check, travel
from vcage.tasks.grasps import hand_boxes
from vcage.tasks.ground import Ground
from vcage.tasks.primitives.push import PushWay, push_ways
from vcage.tasks.scene_objects import SceneObject, SolidBox, first_met
from vcage.tasks.templates.proposal import Proposal
from vcage.tasks.wording import wordings
from vcage.tasks.workplace import Workplace

HEADINGS = np.linspace(0, 2 * np.pi, 12, endpoint=False)
"""Directions in which an object is pushed, turned from its own +x, radians; a push is known by its number here."""

FACES = (0, 3, 6, 9)
"""Numbers of the directions against the faces of a box: its own +x, +y, -x, -y."""


@dataclass(frozen=True)
class PushSettings:
    """Limits of what can be pushed, and settings of the search for pushes.

    Args:
        flattest_m: a lower object slips under the finger tips.
        gravity_m_per_s2: acceleration.
        strongest_n: friction on the table against which an arm still pushes exactly.
        round_share: an object whose widths differ by no more than this is pushed in any direction.
        shortest_m, longest_m, step_m: distances to try.
        margin_m: distance of an object from the end of its push at which the goal must still hold.
        room_m: room that the object keeps beside it and before it.
        distances: examined for each direction, from the shortest to the longest that would do.
        spacing_m: between neighbouring hand poses that are examined along a push.
    """

    flattest_m: float = 0.012
    gravity_m_per_s2: float = 9.81
    strongest_n: float = 24.0
    round_share: float = 0.02
    shortest_m: float = 0.06
    longest_m: float = 0.6
    step_m: float = 0.01
    margin_m: float = 0.025
    room_m: float = 0.012
    distances: int = 3
    spacing_m: float = 0.04


SETTINGS = PushSettings()


@dataclass(frozen=True)
class Push:
    """A straight push that an arm can do.

    Args:
        heading: number of its direction in :data:`HEADINGS`.
        end: object frame in the world.
        finding: its checks, and the arms.
    """

    heading: int
    end: Pose
    finding: Feasibility


def examine_pushes(thing: SceneObject, goal: Goal, workplace: Workplace) -> tuple[list[Push], dict[int, str]]:
    """For each direction a push that achieves the goal, the best first; for the others the reason for none.

    Args:
        thing: where it stands.
        goal: a relation to another object.
        workplace: with the other objects.
    """
    others, ground = workplace.others(thing.id), workplace.ground
    found: list[Push] = []
    refused: dict[int, str] = {}
    for heading in headings(thing):
        ends = _ends(thing, goal, others, ground, heading)
        if not ends:
            most = _farthest(thing, ground, heading) * 100
            refused[heading] = (
                f"pushed {_words(thing, heading)}, at most {most:.0f} cm, it does not come to be so that {goal}"
            )
        for number in np.unique(np.linspace(0, len(ends) - 1, SETTINGS.distances).astype(int)) if ends else ():
            finding = _examine(thing, heading, ends[number], others, workplace.kinematics)
            if finding.feasible:
                found.append(Push(heading, ends[number], finding))
                refused.pop(heading, None)
                break
            refused.setdefault(heading, finding.reason)
    return sorted(found, key=lambda push: -push.finding.grasps[0].score), refused


def headings(thing: SceneObject) -> Sequence[int]:
    """Numbers of the directions in which an object can be pushed: against its faces, or any if it is round."""
    ways = np.stack([np.cos(HEADINGS), np.sin(HEADINGS)])
    widths = np.ptp(thing.outline @ ways, axis=0)
    return range(len(HEADINGS)) if np.ptp(widths) <= SETTINGS.round_share * widths.max() else FACES


def _direction(thing: SceneObject, heading: int) -> np.ndarray:
    """(3,) unit vector in the world."""
    angle = thing.pose.yaw + HEADINGS[heading]
    return np.array([np.cos(angle), np.sin(angle), 0.0])


def _ends(thing: SceneObject, goal: Goal, others: Sequence[SceneObject], ground: Ground, heading: int) -> list[Pose]:
    """Poses of the object after a push, on the ground, at which the goal holds with a margin; nearest first."""
    near = next(o for o in others if o.id == goal.reference).aabb
    off = (-SETTINGS.margin_m, 0, SETTINGS.margin_m)
    nudges = [np.array([x, y, 0.0]) for x in off for y in off]
    distances = np.arange(SETTINGS.shortest_m, _farthest(thing, ground, heading), SETTINGS.step_m)
    ways = [distance * _direction(thing, heading) for distance in distances]
    return [
        Pose(thing.pose.p + way, thing.pose.q)
        for way in ways
        if all(holds(goal.relation, thing.aabb + way + nudge, near) for nudge in nudges)  # pyrefly: ignore
    ]


def _farthest(thing: SceneObject, ground: Ground, heading: int) -> float:
    """Longest push that does not leave the ground, metres."""
    way = _direction(thing, heading)[:2]
    room = np.where(way > 0, ground.upper - thing.outline.max(axis=0), thing.outline.min(axis=0) - ground.lower)
    rooms = room[np.abs(way) > 1e-6] / np.abs(way[np.abs(way) > 1e-6])
    return float(np.clip(rooms.min(), 0.0, SETTINGS.longest_m))


def _words(thing: SceneObject, heading: int) -> str:
    x, y, _ = _direction(thing, heading)
    if abs(x) > abs(y):
        return "to the right" if x > 0 else "to the left"
    return "away from the robot" if y > 0 else "towards the robot"


def _examine(
    thing: SceneObject, heading: int, end: Pose, others: Sequence[SceneObject], kinematics: Mapping[str, ArmKinematics]
) -> Feasibility:
    """All checks of a push to ``end``."""
    distance = float(np.linalg.norm(end.p - thing.pose.p))
    where = f"{thing.record.phrase} pushed {distance * 100:.0f} cm {_words(thing, heading)}"
    met = first_met([_swept(thing, heading, distance)], others)
    message = f"nothing is in the way of {where}" if met is None else f"{met.record.phrase} is in the way of {where}"
    free = Check(name="way_free", passed=met is None, message=message)
    if met is not None:
        return Feasibility([free], [])
    reports = {arm: _examine_arm(thing, end, others, arm, k, where) for arm, k in kinematics.items()}
    return Feasibility.of_arms(heading, [free], reports)


def _examine_arm(
    thing: SceneObject, end: Pose, others: Sequence[SceneObject], arm: str, kinematics: ArmKinematics, where: str
) -> Report:
    """The checks of one arm, and the score of a push that it can do."""
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
            reached = reach_check("reach_motion", where, True, arm)
            return [reached], -travel([kinematics.home, *path, kinematics.home])
    if blocked is not None:
        message = f"{blocked} is in the way of the hand with {where}"
        return [Check(name="way_free", passed=False, message=message)], None
    return [reach_check("reach_motion", where, False, arm)], None


def _along(way: PushWay) -> list[Pose]:
    """Hand poses from behind the face to where it is drawn back."""
    path = way.pushed.p - way.touch.p
    count = max(1, int(np.ceil(np.linalg.norm(path) / SETTINGS.spacing_m)))
    on = [Pose(way.touch.p + share * path, way.touch.q) for share in np.linspace(0, 1, count + 1)]
    return [way.before, *on, way.after]


def _swept(thing: SceneObject, heading: int, distance: float) -> SolidBox:
    """The box that the object sweeps, with room beside it and before it."""
    frame = Pose.from_yaw(thing.pose.p, thing.pose.yaw + HEADINGS[heading])
    flat = (thing.outline - frame.p[:2]) @ frame.rotation()[:2, :2]
    lower, upper = flat.min(axis=0) - [0.0, SETTINGS.room_m], flat.max(axis=0) + SETTINGS.room_m
    height = thing.box.top - frame.p[2]
    return SolidBox(np.array([[*lower, 0.0], [upper[0] + distance, upper[1], height]]), frame)


NAME: TemplateName = "push"


_RELATIONS = ("left_of", "right_of", "in_front_of", "behind", "beside", "near")


class Pushing:
    """The template: every object with a requested relation to another."""

    name = NAME

    def proposals(self, objects: Sequence[SceneObject], asked: Collection[Goal]) -> tuple[list[Shove], list[Refusal]]:
        """Every object with each of its requested relations."""
        by_id = {o.id: o for o in objects}
        goals = [g for g in asked if g.relation in _RELATIONS and g.subject in by_id and g.reference in by_id]
        return [Shove(NAME, by_id[goal.subject], goal) for goal in goals], []

    def calls(self, subtask: Subtask) -> list[str]:
        """The lines of the script's ``play``; GRASPS is a constant of the script."""
        return [f"task.push({subtask.object!r}, arms=[arm for _, arm, _ in GRASPS])", "task.home()"]


@dataclass(frozen=True)
class Shove(Proposal):
    """An object and its wanted relation: it may be pushed against its faces."""

    @property
    def goals(self) -> list[Goal]:
        """Its goal: it stands on the table as before."""
        return [self.goal, Goal(subject=self.thing.id, relation="on", reference=TABLE)]

    @property
    def candidates(self) -> int:
        """Number of directions, though none is tried for an object that a hand can carry."""
        return len(headings(self.thing))

    def impossible(self) -> Refusal | None:
        """Refuse an object that stands in or on another, or is flat or heavy."""
        phrase, model = self.thing.record.phrase, self.thing.asset.model
        if self.thing.record.container is not None:
            return self.refusal(f"{phrase} does not stand on the table")
        height, force = float(self.thing.asset.size[2]), model.total_mass * model.friction * SETTINGS.gravity_m_per_s2
        if height < SETTINGS.flattest_m:
            return self.refusal(f"{phrase} is {height * 1000:.0f} mm high, too flat for finger tips to push it")
        if force > SETTINGS.strongest_n:
            return self.refusal(f"{phrase} resists a push with {force:.0f} N, more than {SETTINGS.strongest_n:.0f} N")
        return None

    def examine(self, workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task if an arm can push the object so; a refusal for each direction; none for a portable object."""
        points = self.thing.asset.annotation.carrying_points
        if any(opens_wide_enough(self.thing, point, workplace.kinematics).passed for point in points):
            return None, []
        found, refused = examine_pushes(self.thing, self.goal, workplace)
        refusals = [self.refusal(reason, heading) for heading, reason in refused.items()]
        return (self._subtask(workplace.objects, found) if found else None), refusals

    def _subtask(self, objects: Sequence[SceneObject], found: Sequence[Push]) -> Subtask:
        text, *others = wordings(self.goal, {o.id: o.record.phrase for o in objects}, pushed=True)
        return self.subtask(
            f"{self.thing.id}-pushed-{self.goal.relation}-{self.goal.reference}",
            objects,
            text=text,
            texts=others,
            receptacle=TABLE,
            grasps=[grasp for push in found for grasp in push.finding.grasps],
            goals=self.goals,
            checks=found[0].finding.checks,
        )


PUSH = Pushing()
