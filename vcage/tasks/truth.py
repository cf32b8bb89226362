"""Ground truth from the simulator's state: it judges the critic, and is never shown to it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.plans.relations import holds
from vcage.plans.thresholds import THRESHOLDS
from vcage.schema.asset import FunctionalPoint
from vcage.schema.episodes import Truth
from vcage.schema.goals import Goal, GoalWord, part_words
from vcage.schema.plan import TABLE
from vcage.schema.subtasks import Statement, Subtask
from vcage.sim.joints import joint_index, joint_positions
from vcage.sim.world import World
from vcage.tasks.events import LASTS, Watch
from vcage.tasks.ground import faces_customer, on_customers_half
from vcage.tasks.scene_objects import SceneObject


def goals_hold(goals: Sequence[Goal], objects: Mapping[str, SceneObject], watch: Watch | None = None) -> Truth:
    """Whether every goal is true of the state, or was done.

    Args:
        objects: by id, at their present poses and joint positions.
        watch: of the world while it was done; needed for what was done, and for what stands on the table.
    """
    for goal in goals:
        complaint = _complaint(goal, objects, watch)
        if complaint:
            return Truth(success=False, reason=complaint)
    return Truth(success=True, reason="; ".join(map(str, goals)) or "nothing was asked for that lasts")


def subtask_done(subtask: Subtask, goals: Sequence[Goal], objects: Mapping[str, SceneObject], watch: Watch) -> Truth:
    """Check if a sub-task brought about some goals with the arm that it is asked of, and left the rest as it was.

    Args:
        subtask: that was done.
        goals: that it was to bring about.
        objects: by id, as they are now.
        watch: since it began, of the object that was taken hold of where that is asked of an arm.
    """
    truth = goals_hold(goals, objects, watch)
    if not truth.success:
        return truth
    complaints = (_arm_complaint(subtask, watch), *(_changed(s, objects, watch) for s in subtask.statements))
    for complaint in complaints:
        if complaint is not None:
            return Truth(success=False, reason=complaint)
    left = others_stay(subtask, watch)
    return truth if left.success else left


def watch_of(subtask: Subtask, world: World, objects: Mapping[str, SceneObject]) -> Watch:
    """A watch of all that tells whether a sub-task was done.

    Args:
        subtask: that begins.
        world: where it is done.
        objects: by id, as they stood at the start of the episode.
    """
    handled = None if subtask.arm is None else subtask.grasped or subtask.object
    return Watch(world, objects, subtask.goals, handled)


def _arm_complaint(subtask: Subtask, watch: Watch) -> str | None:
    """Why it was not done with the arm that it is asked of, or None when it was."""
    if subtask.arm is None:
        return None
    asked = [subtask.arm] if subtask.hand_to is None else [subtask.arm, subtask.hand_to]
    if watch.hands == asked:
        return None
    did, should = (f"the {' and then the '.join(arms)} arm" if arms else "no arm" for arms in (watch.hands, asked))
    return f"{did} took hold of {subtask.grasped or subtask.object}, which was asked of {should}"


def others_stay(subtask: Subtask, watch: Watch) -> Truth:
    """Whether all stand where they stood that a sub-task has no business with; what lies in or on what it moves goes
    along.

    Args:
        subtask: that was done.
        watch: since it began.
    """
    handled = [watch.began[name] for name in (subtask.object, subtask.tool, subtask.grasped) if name is not None]
    for name, thing in watch.began.items():
        if any(thing is other or _bears(other, thing) for other in handled):
            continue
        complaint = _moved(name, watch)
        if complaint is not None:
            return Truth(success=False, reason=f"{complaint} on the way")
    return Truth(success=True, reason="nothing else was moved")


def _moved(name: str, watch: Watch) -> str | None:
    """How an object was moved or tipped since a watch began, or None where it was not."""
    was, now = watch.began[name].pose, watch.world.object_pose(name)
    moved = float(np.linalg.norm(now.p - was.p))
    tilt = float(np.arccos(np.clip(now.rotation()[:, 2] @ was.rotation()[:, 2], -1, 1)))
    if moved > THRESHOLDS.disturbed_m:
        return f"{name} was moved by {100 * moved:.0f} cm"
    return f"{name} was tipped by {np.degrees(tilt):.0f}°" if tilt > THRESHOLDS.tipped_rad else None


def _changed(statement: Statement, objects: Mapping[str, SceneObject], watch: Watch) -> str | None:
    """Why what was to stay as it was did not, or None when it did."""
    goal = statement.goal
    complaint = _moved(statement.subject, watch) if goal is None else _complaint(goal, objects, watch)
    return None if complaint is None else f"not {statement} any more: {complaint}"


def _bears(below: SceneObject, thing: SceneObject) -> bool:
    """Whether a thing stands within the outline of another, and not lower."""
    middle = thing.aabb.mean(axis=0)[:2]
    (lower, upper), bottom = below.around_boxes[:, :2], below.around_boxes[0, 2]
    return bool(np.all((lower <= middle) & (middle <= upper))) and thing.lowest >= bottom


def _complaint(goal: Goal, objects: Mapping[str, SceneObject], watch: Watch | None) -> str | None:
    """Why a goal does not hold, or None when it does."""
    check = _GoalCheck.on_table if goal.reference == TABLE else _CHECKS.get(goal.relation, _GoalCheck.beside)
    return check(_GoalCheck(goal, objects, watch))


@dataclass(frozen=True)
class _GoalCheck:
    """Check of one goal: each method says why a goal of its kind does not hold, or None when it does.

    Args:
        goal: to check.
        objects: by id, as they are now.
        seen: while it was done, None where nothing watched.
    """

    goal: Goal
    objects: Mapping[str, SceneObject]
    seen: Watch | None

    @property
    def thing(self) -> SceneObject:
        return self.objects[self.goal.subject]

    @property
    def part(self) -> str:
        return str(self.goal.part)

    @property
    def watch(self) -> Watch:
        assert self.seen is not None  # whoever asks for it watches
        return self.seen

    @property
    def reference(self) -> SceneObject:
        """The object that the goal refers to.

        Raises:
            ValueError: it refers to none.
        """
        if self.goal.reference not in self.objects:
            raise ValueError(f"no ground truth is defined for {str(self.goal)!r}")
        return self.objects[self.goal.reference]

    def joint(self) -> str | None:
        relation, model = self.goal.relation, self.thing.asset.model
        index = joint_index(model, self.part)
        share = float(joint_positions(model, self.thing.joints)[index]) / model.links[index].joint.far_end
        enough = share <= THRESHOLDS.closed_share if relation == "closed" else share >= THRESHOLDS.opened_share
        state = "turned" if relation == "turned" else "open"
        return None if enough else f"the {part_words(self.part)} of {self.thing.id} is {state} by {100 * share:.0f} %"

    def pressed(self) -> str | None:
        share = self.watch.furthest(self.thing, self.part)
        pressed = f"the {part_words(self.part)} of {self.thing.id} was pressed by {100 * share:.0f} % only"
        return None if share >= THRESHOLDS.opened_share else pressed

    def lasted(self) -> str | None:
        relation, lasted = self.goal.relation, self.watch.lasted(self.goal)
        if relation == "handed" and not lasted:
            return f"the {self.goal.reference} arm did not take {self.thing.id} from the hand of another"
        return None if lasted >= LASTS[relation] else f"{self.thing.id} was {relation} for {lasted:.1f} s only"

    def back(self) -> str | None:
        away = float(np.linalg.norm(self.thing.pose.p - self.watch.objects[self.thing.id].pose.p))
        return None if away <= THRESHOLDS.back_m else f"{self.thing.id} is {100 * away:.1f} cm from where it stood"

    def presented(self) -> str | None:
        if not on_customers_half(self.thing.pose):
            return f"{self.thing.id} is not on the customer's half of the table"
        faces = faces_customer(self.thing.pose)
        return None if faces else f"the front of {self.thing.id} does not face the customer"

    def on_table(self) -> str | None:
        bearers = self.watch.world.touching(self.thing.id) & set(self.objects)
        stands = abs(self.thing.aabb[0, 2] - self.watch.world.table.height) <= THRESHOLDS.height_m
        return None if stands and not bearers else f"{self.thing.id} does not stand on the table alone"

    def held(self) -> str | None:
        receptacle, inside = self.reference, self.goal.relation == "inside"
        points = [
            point for point in receptacle.asset.annotation.functional_points
            if point.link == self.goal.part and (point.holds == "in") == inside
        ]  # fmt: skip
        found = [place_complaint(self.thing, receptacle, point) for point in points]
        if None not in found:
            return next(iter(found), f"nothing is put {self.goal.relation} {receptacle.id}")
        share = 0.0 if self.seen is None else self.seen.world.borne_by(self.thing.id).get(TABLE, 0.0)
        return f"the table bears {100 * share:.0f} % of {self.thing.id}" if share > THRESHOLDS.borne_share else None

    def beside(self) -> str | None:
        there = holds(self.goal.relation, self.thing.aabb, self.reference.aabb)  # pyrefly: ignore
        return None if there else f"{self.thing.id} is not {self.goal.relation} {self.reference.id}"


_CHECKS: Mapping[GoalWord, Callable[[_GoalCheck], str | None]] = {
    "inside": _GoalCheck.held,
    "on": _GoalCheck.held,
    "open": _GoalCheck.joint,
    "closed": _GoalCheck.joint,
    "turned": _GoalCheck.joint,
    "pressed": _GoalCheck.pressed,
    "weighed": _GoalCheck.lasted,
    "scanned": _GoalCheck.lasted,
    "handed": _GoalCheck.lasted,
    "back": _GoalCheck.back,
    "presented": _GoalCheck.presented,
}
"""The check for each goal word; the sides of a thing have one check: :meth:`_GoalCheck.beside`."""


def resting_point(subject: SceneObject, receptacle: SceneObject) -> FunctionalPoint | None:
    """The functional point of a receptacle that an object rests at; None where it rests at none."""
    points = receptacle.asset.annotation.functional_points
    return next((point for point in points if place_complaint(subject, receptacle, point) is None), None)


def place_complaint(subject: SceneObject, receptacle: SceneObject, point: FunctionalPoint) -> str | None:
    """Why an object does not rest at a functional point, or None when it does."""
    opening = receptacle.asset.opening(point)
    frame = receptacle.frame(point.id)
    local = frame.inverse().apply(subject.aabb.mean(axis=0))
    outside = np.abs(local[:2] - opening.centre) - np.asarray(opening.size) / 2
    if np.any(outside > THRESHOLDS.edge_m):
        return f"{subject.id} is {100 * outside.max():.1f} cm outside {receptacle.id}"
    floor = frame.apply([*opening.centre, opening.floor])[2]
    above = subject.lowest - floor
    limit = max(THRESHOLDS.height_m, opening.depth - THRESHOLDS.rim_m)
    if not -THRESHOLDS.height_m <= above <= limit:
        return f"{subject.id} is {100 * above:.1f} cm above the floor of {receptacle.id}"
    if receptacle.pose.rotation()[2, 2] < np.cos(THRESHOLDS.upright_rad):
        return f"{receptacle.id} is tipped"
    return None
