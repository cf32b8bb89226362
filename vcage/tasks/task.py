"""The task API: what a sub-task script may tell the robot to do, and what it asks the critic.

A task knows the state of its world, as an expert does; whether the sub-task was done is not its to say.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.errors import UnknownName
from vcage.base.geometry import Pose
from vcage.schema.episodes import AttemptStage
from vcage.schema.robot import Gripper
from vcage.schema.subtasks import Goal
from vcage.sim.collision import CollisionScene, Held
from vcage.sim.joints import part_names
from vcage.sim.motion import Load, MotionFailed, MotionPlanner
from vcage.sim.trajectory import Trajectory
from vcage.sim.world import PHYSICS_HZ, World
from vcage.tasks.failures import StagedPlanner, TaskFailed, joined
from vcage.tasks.feasibility import TURNS
from vcage.tasks.grasps import approach_opening, grasp_poses
from vcage.tasks.operating import EMPTY, Operation
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.waypoints import MAX_DROP, PickWay, PlaceWay, pick_way, place_way, transfer_height

CAREFUL = 0.85
"""Share of the speed limit near things that are to be touched."""


@dataclass(frozen=True)
class Asked:
    """What the critic is asked after a sub-task."""

    text: str
    goals: list[Goal]


@dataclass(frozen=True)
class _Grip:
    """What is in which hand."""

    arm: str
    object_id: str
    load: Load


class Task:
    """One attempt at one sub-task in a world.

    Args:
        world: where it happens; the robot is at home.
        objects: by id, with their geometry; poses are read from the world.
        slots: object id → where it goes, in its receptacle's frame.
        attempt: number of the attempt; later ones begin with other grasps.
    """

    def __init__(self, world: World, objects: Mapping[str, SceneObject], slots: Mapping[str, Pose], attempt: int = 0):
        self.world = world
        self.arm: str | None = None
        self.contact: int | None = None
        self._objects = objects
        self._slots = slots
        self._attempt = attempt
        self._grip: _Grip | None = None

    # --- what scripts call -----------------------------------------------------------------------------

    def pick(self, object_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Grasp an object with the first of ``grasps`` (contact point, arm) that can be planned, and lift it.

        Raises:
            TaskFailed: none can be planned, or the fingers closed on nothing.
            UnknownName: there is no such object, contact point or arm.
        """
        target = self._object(object_id)
        first = self._attempt % max(1, len(grasps))
        reasons: list[str] = []
        for contact, arm in [*grasps[first:], *grasps[:first]]:
            planned = self._plan_pick(target, contact, arm, reasons)
            if planned is not None:
                self.arm, self.contact = arm, contact
                self._grasp(target, arm, *planned)
                return
        raise TaskFailed("plan", f"no grasp of {target.record.phrase} can be planned: {joined(reasons)}")

    def place(self, receptacle_id: str, point: int = 0) -> None:
        """Carry what is held to its slot in the receptacle, let it go, and draw the hand back.

        Raises:
            TaskFailed: nothing is held any more, or no way can be planned.
        """
        grip = self._holding()
        receptacle = self._object(receptacle_id)
        way, carry, lower = self._plan_place(grip, receptacle, point)
        control = self.world.arms[grip.arm]
        control.move(carry)
        self._holding()
        control.move(lower)
        opened = _opening(control.finger_width, control.arm.gripper)
        control.grip(opened)
        self._grip = None
        away = Load(opening=opened, ignore=self._parts(grip.object_id, receptacle_id), speed=CAREFUL)
        control.move(self._plan(grip.arm, "place").line(self._joints(grip.arm), way.after, away))

    def operate(self, object_id: str, contact_id: int, target: float, arm: str | None = None) -> None:
        """Bring a moving part to a joint position by its handle or button, and the arm home again.

        Args:
            object_id: the object that the part belongs to.
            contact_id: contact point on the part.
            target: position of the part's joint, metres or radians; what is pressed may spring back.
            arm: which arm; the first that can, the nearest first, when not given.

        Raises:
            TaskFailed: no way can be planned, the fingers miss the handle, or the part did not get there.
            UnknownName: there is no such object, contact point or arm.
        """
        if arm is not None and arm not in self.world.arms:
            raise UnknownName("arm", arm, self.world.arms)
        thing = self._object(object_id)
        contact = thing.asset.annotation.contact_point(contact_id)
        arms = [arm] if arm is not None else self._nearest_first(thing)
        operation = Operation(self.world, thing, contact, target)
        self.arm = operation.run(arms, self._attempt)
        self.contact = contact_id
        self.home()
        operation.confirm()

    def home(self) -> None:
        """Bring every arm home, open the grippers, and wait until everything is at rest."""
        for name, control in self.world.arms.items():
            if np.abs(self._joints(name) - control.arm.home).max() > 1e-3:
                control.move(self._plan(name, "place").move(self._joints(name), np.array(control.arm.home)))
            control.grip(1.0)
        self.world.settle(max_steps=PHYSICS_HZ)

    def ask(self, text: str, goals: Sequence[tuple[str, str, str]]) -> Asked:
        """The question for the critic: the sub-task in words, and its goals (subject, relation, reference)."""
        return Asked(text, [Goal(subject=s, relation=r, reference=o) for s, r, o in goals])

    def _nearest_first(self, thing: SceneObject) -> list[str]:
        """The arms, the one whose base is nearest to an object first."""
        bases = {name: control.arm.base.pose().p for name, control in self.world.arms.items()}
        return sorted(bases, key=lambda name: (float(np.linalg.norm(bases[name] - thing.pose.p)), name))

    # --- planning --------------------------------------------------------------------------------------

    def _plan(self, arm: str, stage: AttemptStage) -> StagedPlanner:
        """A planner around everything as it stands now."""
        return StagedPlanner(MotionPlanner(CollisionScene.of_world(self.world, arm)), stage)

    def _plan_pick(
        self, target: SceneObject, contact_id: int, arm: str, reasons: list[str]
    ) -> tuple[PickWay, list[Trajectory]] | None:
        contact = target.asset.annotation.contact_point(contact_id)
        if arm not in self.world.arms:
            raise UnknownName("arm", arm, self.world.arms)
        if contact.link is not None:
            reasons.append(f"{contact.name!r} is on a moving part: {target.record.phrase} is not carried by it")
            return None
        gripper = self.world.arms[arm].arm.gripper
        others = [o for o in map(self._object, self._objects) if o.id != target.id]
        height = transfer_height(others, self.world.table.height)
        planner = MotionPlanner(CollisionScene.of_world(self.world, arm))
        opening = _opening(target.asset.grasp_width(contact), gripper)
        closing = Load(opening, ignore=self._parts(target.id), speed=CAREFUL)
        for grasp in grasp_poses(target.pose, contact, gripper, target.box.bottom):
            way = pick_way(target, grasp, height)
            try:
                reach = planner.move(self._joints(arm), way.before, then=[way.grasp, way.lifted])
                down = planner.line(reach.end, way.grasp, closing)
            except MotionFailed as error:
                reasons.append(f"{arm} arm at {contact.name!r}: {error.message}")
                continue
            self.world.arms[arm].command_gripper(opening)
            return way, [reach, down]
        return None

    def _plan_place(self, grip: _Grip, receptacle: SceneObject, point: int) -> tuple[PlaceWay, Trajectory, Trajectory]:
        control = self.world.arms[grip.arm]
        others = [o for o in map(self._object, self._objects) if o.id not in (grip.object_id, receptacle.id)]
        obstacles = [*receptacle.walls(point), *(o.box for o in others)]
        height = transfer_height([*others, receptacle], self.world.table.height)
        held = self._object(grip.object_id).pose.inverse() * control.tool_pose
        planner = MotionPlanner(CollisionScene.of_world(self.world, grip.arm))
        reasons: list[str] = []
        for goal in self._goals(grip.object_id, receptacle):
            way = place_way(held, goal, obstacles, control.arm.gripper, control.finger_width, height)
            if way.drop > MAX_DROP:
                reasons.append(f"it would fall {way.drop * 100:.1f} cm")
                continue
            try:
                carry = planner.move(self._joints(grip.arm), way.above, grip.load, then=[way.release, way.after])
                careful = Load(grip.load.opening, grip.load.held, grip.load.ignore, CAREFUL)
                return way, carry, planner.line(carry.end, way.release, careful)
            except MotionFailed as error:
                reasons.append(error.message)
        raise TaskFailed("plan", f"{grip.object_id} cannot be brought to {receptacle.id}: {joined(reasons)}")

    def _goals(self, object_id: str, receptacle: SceneObject) -> Iterator[Pose]:
        """Where the object may come to rest, in the world; both headings fill its slot."""
        if object_id not in self._slots:
            raise UnknownName("slot", object_id, self._slots)
        for turn in TURNS:
            yield receptacle.pose * self._slots[object_id] * Pose.from_yaw([0, 0, 0], turn)

    # --- execution -------------------------------------------------------------------------------------

    def _grasp(self, target: SceneObject, arm: str, way: PickWay, reach: list[Trajectory]) -> None:
        control = self.world.arms[arm]
        for part in reach:
            control.move(part)
        control.grip(0.0)
        if control.finger_width < EMPTY:
            raise TaskFailed("grasp", f"the fingers closed on nothing where {target.record.phrase} should be")
        now = self._object(target.id)
        held = Held(target.id, target.asset.model, control.tool_pose.inverse() * now.pose, now.joints)
        self._grip = _Grip(arm, target.id, Load(opening=control.opening, held=held))
        lift = Load(opening=control.opening, ignore=[*self._parts(target.id), "table"], speed=CAREFUL)
        control.move(self._plan(arm, "grasp").line(self._joints(arm), way.lifted, lift))
        self._holding()

    # --- state -----------------------------------------------------------------------------------------

    def _object(self, object_id: str) -> SceneObject:
        if object_id not in self._objects:
            raise UnknownName("object", object_id, self._objects)
        body = self.world.body(object_id)
        return self._objects[object_id].moved(body.pose, body.joints)

    def _parts(self, *object_ids: str) -> list[str]:
        """The names of all parts of objects, as the planner's obstacles are called."""
        return [name for key in object_ids for name in part_names(key, self.world.bodies[key].model)]

    def _joints(self, arm: str) -> np.ndarray:
        """Joints that the arm was last told to take: plans go on from there without a jump."""
        return self.world.arms[arm].command[:-1]

    def _holding(self) -> _Grip:
        """What is held, by the feel of the fingers."""
        if self._grip is None:
            raise TaskFailed("grasp", "nothing was picked up before placing")
        if self.world.arms[self._grip.arm].finger_width < EMPTY:
            raise TaskFailed("grasp", f"{self._grip.object_id} slipped out of the fingers")
        return self._grip


def _opening(width: float, gripper: Gripper) -> float:
    """The command, 0 closed to 1 open, that leaves room on both sides of ``width`` of material."""
    return approach_opening(width, gripper) / gripper.max_width
