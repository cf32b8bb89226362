"""The actions of a task that use a thing in a hand, and put it back or leave it there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vcage.base.geometry import Pose
from vcage.sim.paths import JointPath
from vcage.sim.state import WorldState
from vcage.sim.world import PHYSICS_HZ
from vcage.tasks.hitting import SETTINGS as HITTING
from vcage.tasks.primitives.come_down import carry_out_down, plan_down
from vcage.tasks.primitives.grip import Grip, feel, minding
from vcage.tasks.primitives.pick import carry_out_pick
from vcage.tasks.primitives.place import SETTINGS, PlacePlan, Surroundings, carry_out_place, old_places, plan_place
from vcage.tasks.primitives.pour import carry_out_pour
from vcage.tasks.primitives.slide import INTO_A_HOLE, OVER_A_PEG, carry_out_slide
from vcage.tasks.primitives.wipe import carry_out_wipe
from vcage.tasks.reading import reads
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.touching import Allowance
from vcage.tasks.use_choices import UseChoices
from vcage.tasks.wiping import SETTINGS as WIPING
from vcage.tasks.workcell import CAREFUL_SPEED_SHARE, failing_at

SHOWN_FOR = 0.5
"""Time for which a scanner is held before a code, seconds."""


class Use(UseChoices):
    """Takes a thing, uses it, and puts it back where it stood, unless it stays where it was slid.

    Attributes:
        moment, later: states of the world for the critic, see :class:`vcage.tasks.task.Task`.
    """

    moment: WorldState | None = None
    later: WorldState | None = None

    def show(self, object_id: str, other_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Take an object, hold its bar code or window before the other's for a moment, and put it back.

        Where it turned in the hand on its way, so that nothing is read, the hand turns it back first.

        Args:
            object_id: the scanner, or what has a code.
            other_id: what has a code, or the scanner.
            grasps: (contact point, arm) to try, in this order.

        Raises:
            TaskFailed: no way can be planned, or the object is lost.
            UnknownName: there is no such object, contact point or arm.
        """
        cell = self._cell
        plan, hover, groups = self._choose_showing(object_id, other_id, grasps, tight=True)
        grip = carry_out_pick(cell, plan)
        feel(cell, grip)
        shown, _ = plan_place(cell, grip, hover, ((None, poses) for poses in groups if poses))
        with minding(cell, grip):
            cell.carry_out(grip.arm, shown.path)
            if not reads(cell.object(object_id), cell.object(other_id)):
                cell.carry_out(grip.arm, self._turned_back(shown))
            self.world.step(round(SHOWN_FOR * PHYSICS_HZ))
        self.moment = self.world.state()
        self._put_back(plan.target, hover, shown)

    def hit(self, tool_id: str, thing_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Take a tool, bring its head down on the middle of an object until it touches, and put the tool back.

        Args:
            tool_id: the tool, which has a head.
            thing_id: what it hits.
            grasps: (contact point, arm) to try, in this order.

        Raises:
            TaskFailed: no way can be planned, the tool is lost, or its head touches nothing or something else.
            UnknownName: there is no such object, contact point or arm.
        """
        cell = self._cell
        plan, hover, poses = self._choose_hitting(tool_id, thing_id, grasps, tight=True)
        grip = carry_out_pick(cell, plan)
        self._lift(grip)
        over, _ = plan_place(cell, grip, hover, [(None, poses)])
        with minding(cell, grip):
            cell.carry_out(grip.arm, over.path)
            down = plan_down(cell, grip, thing_id, HITTING.above_m)
            self.moment = carry_out_down(cell, grip, thing_id, down, does="hits")
        self._put_back(plan.target, hover, over, leaves=thing_id)

    def wipe(self, tool_id: str, thing_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Take a tool, draw its pad to and fro over the flat top of an object, and put the tool back.

        Args:
            tool_id: the tool, which has a pad.
            thing_id: what it wipes; nothing lies on it.
            grasps: (contact point, arm) to try, in this order.

        Raises:
            TaskFailed: no way can be planned, the tool is lost, or its pad touches nothing or something else.
            UnknownName: there is no such object, contact point or arm.
        """
        cell = self._cell
        plan, hover, way = self._choose_wiping(tool_id, thing_id, grasps, tight=True)
        grip = carry_out_pick(cell, plan)
        self._lift(grip)
        over, _ = plan_place(cell, grip, hover, [(None, way[:1])])
        with minding(cell, grip):
            cell.carry_out(grip.arm, over.path)
            down = plan_down(cell, grip, thing_id, WIPING.above_m)
            self.moment = carry_out_down(cell, grip, thing_id, down, does="wipes")
            self.later = carry_out_wipe(cell, grip, thing_id, way)
        self._put_back(plan.target, hover, over, leaves=thing_id)

    def pour(self, vessel_id: str, target_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Take a vessel, tip it over a container until all has rolled out of it, and put it back where it stood.

        Args:
            vessel_id: the vessel, with balls in it.
            target_id: the container.
            grasps: (contact point, arm) to try, in this order.

        Raises:
            TaskFailed: no way can be planned, the vessel is lost, or a ball stays in it or meets something else.
            UnknownName: there is no such object, contact point or arm.
        """
        cell = self._cell
        plan, hover, ways = self._choose_pouring(vessel_id, target_id, grasps)
        grip = carry_out_pick(cell, plan)
        self._lift(grip)
        with minding(cell, grip):
            self.moment, empty = carry_out_pour(cell, grip, target_id, ways)
        feel(cell, empty)
        self._set_down_at(plan.target, hover, empty)

    def hang(self, thing_id: str, rack_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Take a thing, slide its closed handle over a free peg of a rack, and let it go there.

        The hand is drawn back with the motion that follows.

        Args:
            thing_id: the thing, with a closed handle.
            rack_id: the rack.
            grasps: (contact point, arm) to try, in this order.

        Raises:
            TaskFailed: no way can be planned, or the thing is lost, or meets something else.
            UnknownName: there is no such object, contact point or arm.
        """
        plan, _, ways = self._choose_hanging(thing_id, rack_id, grasps)
        grip = carry_out_pick(self._cell, plan)
        self._lift(grip)
        self.moment = carry_out_slide(self._cell, grip, rack_id, ways, OVER_A_PEG)

    def insert(self, thing_id: str, place_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Take a thing, slide its shaft into a free hole along that, and let it go there.

        The hand is drawn back with the motion that follows.

        Args:
            thing_id: the thing, with a shaft.
            place_id: what has the hole.
            grasps: (contact point, arm) to try, in this order.

        Raises:
            TaskFailed: no way can be planned, or the thing is lost, or meets something else.
            UnknownName: there is no such object, contact point or arm.
        """
        plan, _, ways = self._choose_inserting(thing_id, place_id, grasps)
        grip = carry_out_pick(self._cell, plan)
        self._lift(grip)
        self.moment = carry_out_slide(self._cell, grip, place_id, ways, INTO_A_HOLE)

    def _put_back(self, stood: SceneObject, hover: Surroundings, shown: PlacePlan, leaves: str | None = None) -> None:
        """Put the object in a hand back where it stood, turned a little where the arm does not reach its heading.

        Args:
            stood: the object as it was taken.
            hover: its surroundings there.
            shown: how it was brought to where it is.
            leaves: id of the object that it touches.

        Raises:
            TaskFailed: it is lost, or no way can be planned.
        """
        cell, grip = self._cell, shown.grip
        feel(cell, grip)
        left = [] if leaves is None else [leaves]
        up = replace(grip.load, ignore=[*grip.load.ignore, *cell.parts(*left)])
        may = Allowance("load", frozenset(left), self.world.arms[grip.arm].tool_pose)
        with failing_at("place"):
            rise = cell.planner(grip.arm).follow(cell.begun(grip.arm).end, self._rising(grip.arm, shown.way.above), up)
        cell.put_off(grip.arm, rise, [may])
        self._set_down_at(stood, hover, grip)

    def _set_down_at(self, stood: SceneObject, hover: Surroundings, grip: Grip) -> None:
        """Bring the object in a hand to where it stood, and let it go there.

        Raises:
            TaskFailed: no way can be planned.
        """
        back = [(None, [pose]) for pose in old_places(stood.pose)]
        put, _ = plan_place(self._cell, grip, replace(hover, raises=SETTINGS.raises_m, hovers=None), back)
        carry_out_place(self._cell, put)

    def _turned_back(self, shown: PlacePlan) -> JointPath:
        """The straight way that brings an object that turned in the hand to its planned pose.

        Raises:
            TaskFailed: there is none.
        """
        cell, arm, meant = self._cell, shown.grip.arm, shown.path.legs[-1].load.held
        assert meant is not None, "an object is in the hand"
        now = cell.held(shown.grip.object_id, self.world.arms[arm].tool_pose)
        hand = shown.way.release * meant.in_gripper * now.in_gripper.inverse()
        load = replace(shown.grip.load, held=now, speed=CAREFUL_SPEED_SHARE)
        with failing_at("place"):
            return cell.planner(arm).line(cell.begun(arm).end, hand, load)

    def _rising(self, arm: str, above: Pose) -> list[Pose]:
        """Poses of the hand on its way to one above: first a little straight up, where that is farther on."""
        now = self.world.arms[arm].tool_pose.p
        up = Pose(now + [0.0, 0.0, min(WIPING.above_m, above.p[2] - now[2])], above.q)
        return [above] if np.linalg.norm((now - above.p)[:2]) < SETTINGS.beside_m else [up, above]

    def _lift(self, grip: Grip) -> None:
        """Lift what was picked, as far as that is still to do."""
        feel(self._cell, grip)
        with minding(self._cell, grip):
            self._cell.finish(grip.arm)
