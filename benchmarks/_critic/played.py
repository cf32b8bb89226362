"""A sub-task that was carried out in the simulator, and what could have come of it instead, made by hand."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from vcage.base.geometry import Pose
from vcage.schema.episodes import Truth
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Subtask
from vcage.sim.arms import WAITS
from vcage.sim.state import WorldState
from vcage.sim.world import World
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import Slot
from vcage.tasks.state import Watch
from vcage.tasks.synthesis import Script
from vcage.tasks.task import Task, TaskFailed
from vcage.tasks.truth import goals_hold, subtask_done

HELD = ("held_up", "held_by_both")
"""Goals of what is in the air at the end."""

LIFTS = ("lifted", "shaken", *HELD)
"""Goals of which a picture shows the subject in the air."""

DROP = 0.03
"""Height above where it could lie from which a thing is dropped by hand, metres."""

SETTLE = 500
"""Physics steps in which what was moved by hand comes to rest."""

OPEN = 0.99
"""From this opening on, 0 closed to 1 open, a hand counts as open: it holds nothing and is not closing."""


@dataclass(frozen=True)
class Shots:
    """States for the critic, with the truth about them.

    Args:
        before, after: the sub-task.
        moment: that tells most; None where there is none.
        later: a second one, where a stroke of wiping ends or at the last lean of a shake; None where there is none.
        start: of the episode, where that is shown.
        arm: whose wrist looks on at the moment.
        truth: by the simulator's state.
        asked: the sub-task that is asked about, where it is another.
    """

    before: WorldState
    after: WorldState
    moment: WorldState | None
    start: WorldState
    arm: str | None
    truth: Truth
    asked: Subtask | None = None
    later: WorldState | None = None

    @property
    def moments(self) -> list[WorldState]:
        """The states that are shown between before and after, at most two."""
        return [state for state in (self.moment, self.later) if state is not None]

    def with_moments(self, states: Sequence[WorldState]) -> Shots:
        """The same with other states between before and after."""
        moment, later = [*states, None, None][:2]
        return replace(self, moment=moment, later=later)


@dataclass(frozen=True)
class Case:
    """A sub-task where it can begin.

    Args:
        subtask, script: what is done.
        objects: by id, as they stood at the start of the episode.
        slots: id of an object → where it goes.
        build: makes the world as it is before.
        others: further sub-tasks of the scene, whose words may be wrong here.
        rng: of all choices.
        start: of the episode, where that is not the state before.
    """

    subtask: Subtask
    script: Script
    objects: Mapping[str, SceneObject]
    slots: Mapping[str, Slot]
    build: Callable[[], World]
    others: Sequence[Subtask]
    rng: np.random.Generator
    start: WorldState | None = None

    def play(self) -> Played:
        """Carry it out once."""
        world = self.build()
        world.settle()
        before, begun, gave_up = world.state(), world.snapshot(), False
        task, watch = Task(world, self.objects, self.slots), Watch(world, self.objects, self.subtask.goals)
        try:
            self.script.play(task)
            truth = _done(self.subtask, watch)
        except TaskFailed as error:
            gave_up, truth = True, Truth(success=False, reason=error.message)
        watch.stop()
        start = self.start or before
        shots = Shots(before, world.state(), task.moment, start, task.arm, truth, later=task.later)
        return Played(self, shots, gave_up, begun, world.snapshot())


@dataclass(frozen=True)
class Played:
    """A sub-task that was carried out in a world of its own.

    Args:
        case: what was to be done.
        shots: what came of it.
        gave_up: whether the robot did.
        begun, ended: snapshots of the world before and after.
    """

    case: Case
    shots: Shots
    gave_up: bool
    begun: bytes = field(repr=False)
    ended: bytes = field(repr=False)

    @property
    def subtask(self) -> Subtask:
        """The sub-task that was done."""
        return self.case.subtask

    @property
    def rng(self) -> np.random.Generator:
        """Of all choices."""
        return self.case.rng

    @property
    def goal(self) -> Goal:
        """The goal of the sub-task."""
        return self.subtask.goals[0]

    def now(self, state: WorldState) -> dict[str, SceneObject]:
        """The objects in a state, by id."""
        return {
            name: o.moved(state.objects[name], tuple(state.object_joints.get(name, ())))
            for name, o in self.case.objects.items()
        }

    @property
    def subject(self) -> SceneObject:
        """The goal's object, as it was before."""
        return self.now(self.shots.before)[self.goal.subject]

    @property
    def place(self) -> SceneObject:
        """The receptacle or support, as it is afterwards."""
        return self.now(self.shots.after)[str(self.subtask.receptacle)]

    @property
    def ends(self) -> tuple[Pose, Pose]:
        """Poses of the goal's subject before and afterwards."""
        shots, name = self.shots, self.goal.subject
        return shots.before.objects[name], shots.after.objects[name]

    @property
    def table(self) -> float:
        """Height of the table top, metres."""
        return min(o.aabb[0, 2] for o in self.case.objects.values())

    @property
    def loose(self) -> list[SceneObject]:
        """Objects that could be carried, with nothing on them and themselves in nothing."""
        now = self.now(self.shots.before)
        holding = {o.record.container for o in now.values()}
        return [
            o
            for o in now.values()
            if o.record.container is None and o.id not in holding and o.asset.annotation.carrying_points
        ]

    def surface(self, at: np.ndarray, thing: SceneObject) -> float:
        """Height of the highest top under a point, or of the table, metres: a thing is dropped from above it."""
        under = [
            o.around_boxes[1, 2]
            for o in self.now(self.shots.before).values()
            if o.id != thing.id and np.all((o.around_boxes[0, :2] <= at[:2]) & (at[:2] <= o.around_boxes[1, :2]))
        ]
        return max([self.table, *under])

    def with_objects_as(self, state: WorldState) -> Shots:
        """The shots with the objects as in another state at each moment between before and after.

        A hand that is not wide open then has its opening in that state, or is closed if it is open there: it has lost
        its thing.
        """
        changed = {"objects": state.objects, "object_joints": state.object_joints}
        openings = {name: 0.0 if opening >= OPEN else opening for name, opening in self._openings(state).items()}
        moments = [replace(one, **changed) for one in self.shots.moments]
        return self.shots.with_moments([self._with_openings(one, openings) for one in moments])

    def closed(self, state: WorldState) -> WorldState:
        """A state with nothing in any hand: fingers that are not wide open touch, as they do in the simulator when a
        thing slips out."""
        return self._with_openings(state, dict.fromkeys(state.joints, 0.0))

    def _openings(self, state: WorldState) -> dict[str, float]:
        """Opening of each hand in a state, 0 closed to 1 open."""
        self._world.set_state(state)
        return {name: arm.opening for name, arm in self._world.arms.items()}

    def _with_openings(self, state: WorldState, openings: Mapping[str, float]) -> WorldState:
        """A state in which each hand that is not wide open has another opening."""
        self._world.set_state(state)
        for name, arm in self._world.arms.items():
            if arm.opening < OPEN:
                arm.put_fingers(openings[name])
        return replace(state, joints=self._world.state().joints)

    @cached_property
    def _world(self) -> World:
        """A world to measure and to change states in; nothing moves there."""
        return self.case.build()

    def step(self, far: tuple[float, float]) -> np.ndarray:
        """(2,) a way along the table in any direction, of a length between two, metres."""
        angle, length = self.rng.uniform(0, 2 * np.pi), self.rng.uniform(*far)
        return length * np.array([np.cos(angle), np.sin(angle)])

    def leaning(self, pose: Pose, most: float = 1.0) -> Pose:
        """A pose tilted by chance, by ``most`` radians at most."""
        tilt, angle = self.rng.uniform(0.2, most), self.rng.uniform(0, 2 * np.pi)
        axis = np.sin(tilt / 2) * np.array([np.cos(angle), np.sin(angle), 0.0])
        return Pose(pose.p, (Pose(q=pose.q) * Pose(q=[np.cos(tilt / 2), *axis])).q)

    def tumbled(self, pose: Pose) -> Pose:
        """A pose turned by chance, as of what falls."""
        return self.leaning(Pose(pose.p, Pose.from_yaw([0, 0, 0], self.rng.uniform(0, 2 * np.pi)).q), most=0.6)

    def untrue(self, reason: str, moments: Sequence[WorldState] | None = None, **states: Any) -> Shots:
        """Replace states of the sub-task, which then is no success.

        Args:
            reason: why it is none.
            moments: those between before and after; as they were when not given.
            states: others, by their names.
        """
        shots = self.shots if moments is None else self.shots.with_moments(moments)
        return replace(shots, **states, truth=Truth(success=False, reason=reason))

    def instead(
        self,
        poses: Mapping[str, Pose] | None = None,
        joints: Mapping[str, Sequence[float]] | None = None,
        ended: bool = True,
    ) -> Shots:
        """Things put elsewhere by hand after the sub-task, or in its stead, and left to come to rest.

        Args:
            poses, joints: of objects, by id.
            ended: True if everything else is as it was afterwards, False if as before.
        """
        world = self.case.build()
        world.restore(self.begun)
        watch = Watch(world, self.case.objects, self.subtask.goals)
        if ended:
            world.restore(self.ended)
        for name, pose in (poses or {}).items():
            world.set_object_pose(name, pose)
        for name, positions in (joints or {}).items():
            world.set_object_joints(name, positions)
        world.settle(SETTLE)
        _rest_fingers(world)
        after, truth = world.state(), _done(self.subtask, watch)
        watch.stop()
        return replace(self.with_objects_as(after), after=after, truth=truth)

    def about(self, other: Subtask) -> Shots:
        """The same outcome, in the words of another sub-task."""
        world = self.case.build()
        world.restore(self.ended)
        watch = Watch(world, self.case.objects, other.goals)
        truth = goals_hold(other.goals, watch)
        watch.stop()
        return replace(self.shots, truth=truth, asked=other)


Kind = Callable[[Played], Shots | None]
"""Makes an outcome from one that was played; None where that makes no sense, or does not come out as it should."""


def _done(subtask: Subtask, watch: Watch) -> Truth:
    return subtask_done(subtask, subtask.goals, watch)


def _rest_fingers(world: World) -> None:
    """Step a world until no finger moves any more: a hand closes once what it held is taken out."""
    for _ in range(WAITS.most_finger_steps):
        before = [arm.finger_width for arm in world.arms.values()]
        world.step()
        if np.allclose(before, [arm.finger_width for arm in world.arms.values()], rtol=0.0, atol=WAITS.fingers_still_m):
            break
