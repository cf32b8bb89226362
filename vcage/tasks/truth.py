"""Ground truth from the simulator's state, which judges the critic and is never shown to it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from vcage.goals.thresholds import THRESHOLDS
from vcage.schema.episodes import Truth
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Statement, Subtask
from vcage.sim.world import World
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import StillState, Watch


def goals_hold(goals: Sequence[Goal], state: StillState) -> Truth:
    """Judge whether every goal is true of the state, or was done.

    Args:
        goals: to judge.
        state: a watch of the world, for events and goals on the table; a still state suffices for the others.
    """
    for goal in goals:
        complaint = _complaint(goal, state)
        if complaint:
            return Truth(success=False, reason=complaint)
    return Truth(success=True, reason="; ".join(map(str, goals)) or "nothing was asked for that lasts")


def subtask_done(subtask: Subtask, goals: Sequence[Goal], watch: Watch) -> Truth:
    """Check if a sub-task achieved some goals with its required arm, and left the rest unchanged.

    Args:
        subtask: that was done.
        goals: to be achieved.
        watch: from its start, following the grasped object if an arm is required.
    """
    truth = goals_hold(goals, watch)
    if not truth.success:
        return truth
    complaints = (_arm_complaint(subtask, watch), *(_changed(s, watch) for s in subtask.statements))
    for complaint in complaints:
        if complaint is not None:
            return Truth(success=False, reason=complaint)
    left = others_stay(subtask, watch)
    return truth if left.success else left


def watch_of(subtask: Subtask, world: World, objects: Mapping[str, SceneObject]) -> Watch:
    """A watch of everything that shows if a sub-task was done.

    Args:
        subtask: the next one.
        world: its world.
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
    """Judge if all objects outside a sub-task stand at their old places.

    Contents of what the hand takes move along; what it only touches with that, to hit or to scan it, stays too.

    Args:
        subtask: that was done.
        watch: since it began.
    """
    handled = watch.began[subtask.grasped or subtask.object]
    limits = {goal.subject: goal.kind.stays_m for goal in subtask.goals}
    for name, thing in watch.began.items():
        if thing is handled or _is_below(handled, thing):
            continue
        complaint = _moved(name, watch, limits.get(name) or THRESHOLDS.disturbed_m)
        if complaint is not None:
            return Truth(success=False, reason=f"{complaint} on the way")
    return Truth(success=True, reason="nothing else was moved")


def _moved(name: str, watch: Watch, most_m: float = THRESHOLDS.disturbed_m) -> str | None:
    """Say by how much an object was moved or tipped since a watch began; None where it was not."""
    was, now = watch.began[name].pose, watch.thing(name).pose
    moved = float(np.linalg.norm(now.p - was.p))
    tilt = float(np.arccos(np.clip(now.rotation()[:, 2] @ was.rotation()[:, 2], -1, 1)))
    if moved > most_m:
        return f"{name} was moved by {100 * moved:.0f} cm"
    return f"{name} was tipped by {np.degrees(tilt):.0f}°" if tilt > THRESHOLDS.tipped_rad else None


def _changed(statement: Statement, watch: Watch) -> str | None:
    """Why a statement of unchanged state is false, or None when it holds."""
    goal = statement.goal
    complaint = _moved(statement.subject, watch) if goal is None else _complaint(goal, watch)
    return None if complaint is None else f"not {statement} any more: {complaint}"


def _is_below(below: SceneObject, thing: SceneObject) -> bool:
    """True where an object stands within the outline of another, and not lower."""
    middle = thing.aabb.mean(axis=0)[:2]
    (lower, upper), bottom = below.around_boxes[:, :2], below.around_boxes[0, 2]
    return bool(np.all((lower <= middle) & (middle <= upper))) and thing.lowest >= bottom


def _complaint(goal: Goal, state: StillState) -> str | None:
    """Why a goal does not hold, or None when it does."""
    return goal.kind.complaint(goal, state)  # pyrefly: ignore[bad-argument-type]  # kinds ask for what their words need
