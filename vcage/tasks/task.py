"""The task API: what a sub-task script may tell the robot to do, and what it asks the critic.

A task knows the state of its world, as an expert does; whether the sub-task was done is not its to say.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.errors import UnknownName
from vcage.base.geometry import Pose
from vcage.schema.plan import RelationWord
from vcage.schema.subtasks import Goal
from vcage.sim.world import PHYSICS_HZ, World
from vcage.tasks.primitives.operate import Operation
from vcage.tasks.primitives.pick import Grip, carry_out_pick, feel, plan_pick
from vcage.tasks.primitives.place import carry_out_place, plan_place
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.workcell import TaskFailed, Workcell, failing_at


@dataclass(frozen=True)
class Asked:
    """What the critic is asked after a sub-task."""

    text: str
    goals: list[Goal]


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
        self._cell = Workcell(world, objects)
        self._slots = slots
        self._attempt = attempt
        self._grip: Grip | None = None

    def pick(self, object_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Grasp an object with the first of ``grasps`` (contact point, arm) that can be planned, and lift it.

        Raises:
            TaskFailed: none can be planned, or the fingers closed on nothing.
            UnknownName: there is no such object, contact point or arm.
        """
        target = self._cell.object(object_id)
        first = self._attempt % max(1, len(grasps))
        plan = plan_pick(self._cell, target, [*grasps[first:], *grasps[:first]])
        self.arm, self.contact = plan.arm, plan.contact
        self._grip = carry_out_pick(self._cell, plan)

    def place(self, receptacle_id: str, point: int = 0) -> None:
        """Carry what is held to its slot in the receptacle, let it go, and draw the hand back.

        Raises:
            TaskFailed: nothing is held any more, or no way can be planned.
            UnknownName: there is no such receptacle or functional point, or what is held has no slot.
        """
        if self._grip is None:
            raise TaskFailed("grasp", "nothing was picked up before placing")
        feel(self._cell, self._grip)
        receptacle, held = self._cell.object(receptacle_id), self._grip.object_id
        if held not in self._slots:
            raise UnknownName("slot", held, self._slots)
        plan = plan_place(self._cell, self._grip, receptacle, point, self._slots[held])
        carry_out_place(self._cell, plan)
        self._grip = None

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
        thing = self._cell.object(object_id)
        contact = thing.asset.annotation.contact_point(contact_id)
        arms = [arm] if arm is not None else self._nearest_first(thing)
        operation = Operation(self._cell, thing, contact, target)
        self.arm = operation.run(arms, self._attempt)
        self.contact = contact_id
        self.home()
        operation.confirm()

    def home(self) -> None:
        """Bring every arm home, open the grippers, and wait until everything is at rest."""
        for name, control in self.world.arms.items():
            if np.abs(self._cell.joints(name) - control.arm.home).max() > 1e-3:
                with failing_at("place"):
                    way = self._cell.planner(name).move(self._cell.joints(name), np.array(control.arm.home))
                control.move(way)
            control.grip(1.0)
        self.world.settle(max_steps=PHYSICS_HZ)

    def ask(self, text: str, goals: Sequence[tuple[str, RelationWord, str]]) -> Asked:
        """The question for the critic: the sub-task in words, and its goals (subject, relation, reference)."""
        return Asked(text, [Goal(subject=s, relation=r, reference=o) for s, r, o in goals])

    def _nearest_first(self, thing: SceneObject) -> list[str]:
        """The arms, the one whose base is nearest to an object first."""
        bases = {name: control.arm.base.pose().p for name, control in self.world.arms.items()}
        return sorted(bases, key=lambda name: (float(np.linalg.norm(bases[name] - thing.pose.p)), name))
