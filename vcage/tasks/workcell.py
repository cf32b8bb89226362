"""The workcell that every primitive plans in: a world, the geometry of its objects, and failures with their stage."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager

import numpy as np

from vcage.base.errors import UnknownName, VcageError
from vcage.base.geometry import Pose
from vcage.schema.episodes import AttemptStage
from vcage.schema.plan import TABLE
from vcage.sim.arms import move_together
from vcage.sim.bodies import Body
from vcage.sim.collision import CollisionScene, Held
from vcage.sim.joints import part_names
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.paths import OPEN_HAND, JointPath, Leg
from vcage.sim.trajectory import Trajectory
from vcage.sim.world import World
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.state import lying_on
from vcage.tasks.touching import SETTINGS, Allowance, Touched, only_touching

CAREFUL_SPEED_SHARE = 0.85
"""Share of the speed limit near things that are to be touched."""


class TaskFailed(VcageError):
    """A step could not be planned, or the hand felt that it failed; ends the attempt.

    Args:
        stage: how far the attempt came.
        exhausted: True if nothing is left to change; another attempt would end in the same way.
    """

    code = "task_failed"

    def __init__(self, stage: AttemptStage, message: str, exhausted: bool = False):
        super().__init__(message)
        self.stage: AttemptStage = stage
        self.exhausted = exhausted


@contextmanager
def failing_at(stage: AttemptStage) -> Iterator[None]:
    """A motion inside that finds no way ends the attempt at ``stage``."""
    try:
        yield
    except MotionFailed as error:
        raise TaskFailed(stage, error.message) from error


def first_reasons(reasons: Sequence[str]) -> str:
    """The first three different reasons in one sentence, and how many more there are."""
    different = list(dict.fromkeys(reasons))
    more = f"; and {len(different) - 3} more" if len(different) > 3 else ""
    return ("; ".join(different[:3]) or "nothing to try") + more


class Workcell:
    """A world, and the geometry of the objects in it.

    Args:
        world: where everything stands.
        objects: by id; their poses are read from the world.
    """

    def __init__(self, world: World, objects: Mapping[str, SceneObject]):
        self.world = world
        self._objects = objects
        self._put_off: dict[str, tuple[JointPath, tuple[Allowance, ...]]] = {}
        self._taken: dict[str, frozenset[str]] = {}

    def object(self, object_id: str) -> SceneObject:
        """An object as it stands now.

        Raises:
            UnknownName: there is no such object.
        """
        if object_id not in self._objects:
            raise UnknownName("object", object_id, self._objects)
        body = self.world.body(object_id)
        return self._objects[object_id].moved(body.pose, body.joints)

    def objects(self) -> dict[str, SceneObject]:
        """All objects as they stand now, by id."""
        return {key: self.object(key) for key in self._objects}

    def objects_but(self, *object_ids: str) -> list[SceneObject]:
        """All other objects as they stand now."""
        return [self.object(key) for key in self._objects if key not in object_ids]

    def parts(self, *object_ids: str) -> list[str]:
        """The planner's names of all parts of objects."""
        return [name for key in object_ids for name in part_names(key, self.world.bodies[key].model)]

    def contents(self, object_id: str) -> frozenset[str]:
        """Ids of the objects in or on an object, and in or on those.

        For an object taken by an arm, these are its contents at that time: it may lean since.
        """
        if object_id in self._taken:
            return self._taken[object_id]
        lying = [o.id for o in lying_on(self.object(object_id), self.objects_but(object_id))]
        return frozenset(lying).union(*(self.contents(name) for name in lying))

    def take(self, object_id: str) -> None:
        """Remember the contents of an object that an arm takes now."""
        self._taken[object_id] = self.contents(object_id)

    def let_go(self, object_id: str) -> None:
        """Forget what :meth:`take` remembers."""
        self._taken.pop(object_id, None)

    def emptied(self, object_id: str) -> None:
        """Forget the contents of what an arm has taken: they are poured out."""
        self._taken[object_id] = frozenset()

    def held(self, object_id: str, gripper: Pose) -> Held:
        """An object and its contents where they are, in a gripper at a pose in the world."""
        thing, contents = self.object(object_id), [self.object(name) for name in sorted(self.contents(object_id))]
        to_thing = thing.pose.inverse()
        lying = tuple((o.id, Body(o.asset.model, to_thing * o.pose, o.joints)) for o in contents)
        return Held(thing.id, thing.asset.model, gripper.inverse() * thing.pose, thing.joints, contents=lying)

    def begun(self, arm: str) -> JointPath:
        """The path that the arm follows first: the next plan continues from its end without a jump."""
        here = JointPath((Leg(self.world.arms[arm].command[None, :-1], OPEN_HAND),))
        return self._put_off[arm][0] if arm in self._put_off else here

    def finish(self, arm: str) -> None:
        """Carry out the arm's postponed motion, if it has one.

        Raises:
            TaskFailed: as :meth:`carry_out`.
        """
        if arm in self._put_off:
            self.carry_out(arm, self.begun(arm))

    def put_off(self, arm: str, path: JointPath, allowed: Sequence[Allowance] = ()) -> None:
        """Begin the arm's next motion with ``path``, so that it need not stop at its end.

        Args:
            arm: its name.
            path: from where it is.
            allowed: contacts that are allowed on it.
        """
        self._put_off[arm] = path, tuple(allowed)

    def carry_out(self, arm: str, path: JointPath, allowed: Sequence[Allowance] = ()) -> None:
        """Move an arm along a path that begins with the postponed motion.

        An object released on the way may be touched by the hand, and touch anything.

        Args:
            arm: its name.
            path: from its present joints.
            allowed: contacts allowed on it, besides those of the postponed motion.

        Raises:
            TaskFailed: the arm, or its load, presses on something else.
        """
        _, before = self._put_off.pop(arm, (None, ()))
        last = path.legs[-1].load.held
        load = None if last is None else last.object_id
        let_go = frozenset(leg.load.held.object_id for leg in path.legs if leg.load.held is not None) - {load}
        try:
            may = [*before, *allowed, Allowance("hand", let_go)]
            with only_touching(self.world, arm, load, may, self._taken.get(load or "", ())):
                self.world.arms[arm].move(self.planner(arm).fastest(path))
        except Touched as touched:
            raise TaskFailed(*self._touch(arm, load, touched)) from touched

    def carry_out_together(self, object_id: str, trajectories: Mapping[str, Trajectory]) -> None:
        """Move arms at the same time that hold one object together, from where it stands.

        Args:
            object_id: the object.
            trajectories: of each arm that holds it.

        Raises:
            TaskFailed: an arm, or the object, presses on something else.
        """
        arms, contents = self.world.arms, self._taken.get(object_id, frozenset())
        held = Allowance("hand", frozenset({object_id, *contents}))
        load = Allowance("load", frozenset({*trajectories, *self.beside(object_id)}))
        with ExitStack() as watched:
            for name in trajectories:
                mine = name == min(trajectories)
                watched.enter_context(
                    only_touching(self.world, name, object_id if mine else None, [held, load], contents if mine else ())
                )
            try:
                move_together([(arms[name], trajectory) for name, trajectory in trajectories.items()])
            except Touched as touched:
                raise TaskFailed(*self._touch(min(trajectories), object_id, touched)) from touched

    def _touch(self, arm: str, load: str | None, touched: Touched) -> tuple[AttemptStage, str]:
        """At which stage an attempt ends with a touch, and why."""
        names = {key: f"the {o.record.phrase}" for key, o in self._objects.items()}
        other = names.get(touched.other, f"the {touched.other}" + " arm" * (touched.other in self.world.arms))
        mine = names.get(touched.name, f"the {arm} arm")
        if load is not None and self.world.arms[arm].empty:
            return "grasp", f"{names[load]} slipped out of the fingers and touches {other}"
        return "grasp" if load is None else "place", f"{mine} touches {other} on its way"

    def beside(self, object_id: str) -> frozenset[str]:
        """Name an object's container, support and neighbours, by their boxes: ids of other objects and ``table``.

        Contacts do not show it: the physics engine reports none of sleeping bodies.
        """
        lower, upper = self.object(object_id).around_boxes
        found = {TABLE} if lower[2] - self.world.table.height < SETTINGS.beside_m else set[str]()
        for other in self.objects_but(object_id):
            low, high = other.around_boxes
            if np.all(low - SETTINGS.beside_m < upper) and np.all(lower < high + SETTINGS.beside_m):
                found.add(other.id)
        return frozenset(found)

    def planner(self, arm: str) -> MotionPlanner:
        """A planner around everything as it stands now."""
        return MotionPlanner(CollisionScene.of_world(self.world, arm))

    def planner_among(self, arm: str, joints: Mapping[str, np.ndarray], changed: Mapping[str, Body]) -> MotionPlanner:
        """A planner around everything in a future state.

        Args:
            arm: whose.
            joints: (n,) of the other arms by name, rad; at home where not given.
            changed: objects, by id, that will be elsewhere.
        """
        bodies = {name: self.world.body(name) for name in self.world.object_ids} | dict(changed)
        return MotionPlanner(CollisionScene(self.world.robot, arm, self.world.table, bodies, joints))  # pyrefly: ignore
