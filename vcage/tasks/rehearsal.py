"""Rehearse a chain before anything moves: each sub-task must be feasible where those before it leave things."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from vcage.base.attempts import LIMITS, GaveUp, first_accepted
from vcage.base.errors import InfeasibleScene, NoFeasibleTask
from vcage.base.geometry import Pose
from vcage.schema.asset import ContactPoint
from vcage.schema.plan import TABLE
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask
from vcage.sim.bodies import Body
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.paths import Load
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.tasks.asked_arms import asked_arms, bound_to
from vcage.tasks.chain_slots import slots_for_chain
from vcage.tasks.choosing import as_chosen, preferred_first
from vcage.tasks.feasibility import feasible, transfers
from vcage.tasks.findings import best_first
from vcage.tasks.grasps import command_of
from vcage.tasks.hanging import hung_poses
from vcage.tasks.hitting import SETTINGS as HITTING
from vcage.tasks.pouring import balls_in
from vcage.tasks.primitives.along import plan_along
from vcage.tasks.primitives.come_down import way_down
from vcage.tasks.primitives.hold_with_both import plan_with_both
from vcage.tasks.primitives.place import Surroundings
from vcage.tasks.primitives.pour import SETTINGS as POURING
from vcage.tasks.primitives.shake import plan_shake
from vcage.tasks.primitives.slide import INTO_A_HOLE, OVER_A_PEG, Sliding, plan_slide
from vcage.tasks.primitives.wipe import rehearse_wipe
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import POURS, TAKES, compose, find_subtasks, judging
from vcage.tasks.slots import Slot, asks_for_heading
from vcage.tasks.stowing import heaped_in
from vcage.tasks.synthesis import script_of
from vcage.tasks.task import Task
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.workcell import TaskFailed, failing_at, first_reasons
from vcage.tasks.workplace import Workplace

ANOTHER = "another --seed gives another layout"

_GoesOn = Callable[[MotionPlanner, np.ndarray, Load], object]
"""Plans a motion of an arm from (n,) joints on, with a load; raises :class:`MotionFailed` where there is none."""


class _NotWithTheseSlots(NoFeasibleTask):
    """The chain cannot be done where it puts things; with other slots it may be."""


def examined(subtask: Subtask, workplace: Workplace) -> Subtask | None:
    """The sub-task as it is feasible in a workplace, changing hands on its way only where it did before.

    Args:
        subtask: as found with objects at other places.
        workplace: with all arms of the robot.
    """
    workplace = workplace.with_arms(subtask.arm, subtask.hand_to)
    into = subtask.template == "hand_over" and subtask.functional_point is not None
    plain = subtask.template == "place" and not asks_for_heading(subtask.goals)
    kind, asked = ("place" if into else subtask.template), [] if plain else subtask.goals
    for proposal in TEMPLATES[kind].proposals(workplace.objects, asked)[0]:
        if proposal.thing.id == subtask.object and proposal.goal in subtask.goals:
            found, _ = proposal.examine(workplace)
            if found is not None and found.id == subtask.id:
                return as_chosen(bound_to(found, subtask.arm), subtask)
    return None


class Rehearsal(Task):
    """A task that plans its motions and carries none out: things are then where they would have been brought."""

    def pick(self, object_id: str, grasps: Sequence[tuple[int, str]], hand_to: str | None = None) -> None:
        """Plan it, with the hand-over if there is one."""
        self._picked = self._choose(self._cell.object(object_id), grasps, hand_to)

    def hand_over(self, to: str) -> None:
        """Nothing: :meth:`pick` has looked."""

    def show(self, object_id: str, other_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Plan it, with the way to a pose there; the object is put back."""
        self._picked, hover, groups = self._choose_showing(object_id, other_id, grasps, tight=False)
        self._carry(hover, groups)

    def hit(self, tool_id: str, thing_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Plan it, with the way down; the tool is put back."""
        self._picked, hover, poses = self._choose_hitting(tool_id, thing_id, grasps, tight=False)
        self._carry(hover, [poses], partial(way_down, thing=self._cell.parts(thing_id), above_m=HITTING.above_m))

    def wipe(self, tool_id: str, thing_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Plan it, with the way down and the strokes; the tool is put back."""
        self._picked, hover, way = self._choose_wiping(tool_id, thing_id, grasps, tight=False)
        self._carry(hover, [way[:1]], partial(rehearse_wipe, thing=self._cell.parts(thing_id), way=way))

    def pour(self, vessel_id: str, target_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Plan it; the balls lie in the container, and the vessel is put back."""
        cell = self._cell
        vessel, target = cell.object(vessel_id), cell.object(target_id)
        self._picked, _, ways = self._choose_pouring(vessel_id, target_id, grasps)
        up, load = self._lifted()
        with failing_at("plan"):
            plan_along(cell.planner(self._picked.arm), up, load, next(ways), POURING.speed)
        balls = balls_in(vessel, cell.objects_but(vessel_id))
        for name, pose in heaped_in(target, balls, np.random.default_rng(0)).items():
            self.world.set_object_pose(name, pose)

    def hang(self, thing_id: str, rack_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Plan it; the thing hangs where it comes to rest."""
        self._picked, _, ways = self._choose_hanging(thing_id, rack_id, grasps)
        way = self._slid(next(ways), OVER_A_PEG)
        thing, rack = self._cell.object(thing_id), self._cell.object(rack_id)
        rests = hung_poses(thing, rack, self._cell.objects_but(thing_id))
        nearest = min(rests, key=lambda pose: float(np.linalg.norm(pose.p - way[-1].p)))
        self.world.set_object_pose(thing_id, nearest)

    def insert(self, thing_id: str, place_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Plan it; the thing is where it is let go."""
        self._picked, _, ways = self._choose_inserting(thing_id, place_id, grasps)
        self.world.set_object_pose(thing_id, self._slid(next(ways), INTO_A_HOLE)[-1])

    def _slid(self, way: Sequence[Pose], sliding: Sliding) -> Sequence[Pose]:
        """Plan that what was picked is lifted and slid along a way, which is returned."""
        up, load = self._lifted()
        with failing_at("plan"):
            plan_slide(self._cell.planner(self._picked.arm), up, load, way, sliding)
        return way

    def wait(self, seconds: float) -> None:
        """Nothing."""

    def hold(self) -> None:
        """Lift the picked object, with its contents; the arm stays there."""
        plan, cell = self._picked, self._cell
        up, _ = self._lifted()
        for name in (plan.target.id, *cell.contents(plan.target.id)):
            pose = self.world.object_pose(name)
            self.world.set_object_pose(name, Pose(pose.p + plan.way.lifted.p - plan.way.grasp.p, pose.q))
        control = self.world.arms[plan.arm]
        control.reset(up - control.arm.home)
        control.command_gripper(0.0)

    def hold_with_both(self, object_id: str) -> None:
        """Plan it; no arm is left to do anything else."""
        plan_with_both(self._cell, self._cell.object(object_id))

    def shake(self) -> None:
        """Plan it; the object is where it was."""
        plan = self._picked
        up, load = self._lifted()
        middle = plan.target.aabb.mean(axis=0) + plan.way.lifted.p - plan.way.grasp.p
        with failing_at("plan"):
            plan_shake(self._cell.planner(plan.arm), up, plan.way.lifted, middle, load)

    def _lifted(self) -> tuple[np.ndarray, Load]:
        """(n,) joints of the arm that has lifted what it picked, and the load of its hand."""
        plan, cell = self._picked, self._cell
        opening = command_of(plan.target.asset.grasp_width(self._contact), cell.world.arms[plan.arm].arm.gripper)
        load = Load(opening, cell.held(plan.target.id, plan.way.grasp))
        with failing_at("grasp"):
            lift = cell.planner(plan.arm).line(plan.path.end, plan.way.lifted, replace(load, ignore=[TABLE]))
        return lift.end, load

    @property
    def _contact(self) -> ContactPoint:
        """The contact point of the picked object."""
        return self._picked.target.asset.annotation.contact_point(self._picked.contact)

    def place(self, receptacle_id: str = TABLE, point: int | None = None) -> None:
        """Bring the picked object, with its contents, to its slot, at the heading that is nearest for its arm."""
        if self.slot is not None:
            if self._keeping:  # an arm that holds something up is more in the way than one at home
                around = Surroundings.of(self._cell, self._picked.target.id, self.slot.receptacle, self.slot.point)
                self._carry(around, [self.slot.poses(self._cell.objects())])
            plan, arm = self._picked, self._cell.planner(self._picked.arm).kinematics
            held = plan.target.pose.inverse() * plan.way.grasp
            poses = self.slot.poses(self._cell.objects())
            nearest = min(poses, key=lambda pose: arm.distance(plan.path.end, pose * held))
            way = nearest * plan.target.pose.inverse()
            for name in (plan.target.id, *self._cell.contents(plan.target.id)):
                self.world.set_object_pose(name, way * self.world.object_pose(name))

    def _carry(self, around: Surroundings, groups: Iterable[Sequence[Pose]], then: _GoesOn | None = None) -> None:
        """Plan the way of the lifted object, past the other arms, to one of some poses.

        Args:
            around: its surroundings there.
            groups: poses of the object, in the world; those to try first come first.
            then: plans how it goes on from there.

        Raises:
            TaskFailed: there is none.
        """
        cell, (up, load) = self._cell, self._lifted()
        thing, planner = self._picked.target, cell.planner(self._picked.arm)
        held, width = thing.pose.inverse() * self._picked.way.grasp, thing.asset.grasp_width(self._contact)
        reasons: list[str] = []
        for poses in filter(None, groups):
            try:
                ways = around.ways(planner.kinematics, held, width, poses, up)[: LIMITS.ways_past_arms]
            except MotionFailed as error:
                reasons.append(error.message)
                continue
            for way in ways:
                try:
                    carry = planner.move(up, way.above, load, then=[way.release, way.after])
                    there = planner.line(carry.end, way.release, load).end
                    if then is not None:
                        then(planner, there, load)
                    return
                except MotionFailed as error:
                    reasons.append(error.message)
        raise TaskFailed("plan", f"{thing.id} cannot be brought {around.where}: {first_reasons(reasons)}")

    def push(self, object_id: str, arms: Sequence[str] = ()) -> None:
        """Plan it; the object is where it is pushed to."""
        self.world.set_object_pose(object_id, self._choose_push(self._cell.object(object_id), arms).goal)

    def operate(self, object_id: str, contact_id: int, target: float, arms: Sequence[str] = ()) -> None:
        """Plan it; the part is at its target with the objects on it, unless it springs back."""
        operation, _ = self._choose_operation(object_id, contact_id, target, arms)
        if self._cell.object(object_id).asset.annotation.contact_point(contact_id).use == "press":
            return
        for name, body in operation.at_target().items():
            self.world.set_object_pose(name, body.pose)
            if body.joints:
                self.world.set_object_joints(name, body.joints)

    def home(self) -> None:
        """Nothing: the arms are there."""


def rehearsed(
    chain: Sequence[Subtask],
    slots: Mapping[str, Slot],
    objects: Sequence[SceneObject],
    scene: Scene,
    rng: np.random.Generator,
) -> list[Subtask]:
    """Each sub-task as feasible in its turn, the grasp of its planned motions first.

    Args:
        chain: sub-tasks that are feasible at the start, in order.
        slots: the slot of each sub-task that has one, by the sub-task's id.
        objects: where they stand at the start.
        scene: its table and robot count.
        rng: of all choices.

    Raises:
        NoFeasibleTask: one of them is not feasible at the places left by earlier ones, or cannot be planned there;
            ``details["refused"]`` names it, without the measurements.
    """
    workplace, reason = Workplace.of(scene, objects, rng), None
    for keepers in product(*(_keepers(subtask, later=chain[number + 1 :]) for number, subtask in enumerate(chain))):
        stage = _Stage(chain, slots, workplace, scene)
        try:
            return [stage.play(subtask, keeper) for subtask, keeper in zip(chain, keepers, strict=True)]
        except NoFeasibleTask as error:
            reason = reason or error
    assert reason is not None
    raise reason


def _keepers(subtask: Subtask, later: Sequence[Subtask]) -> list[str | None]:
    """The arms that may hold something up while the others do what comes later; None for any arm."""
    if subtask.template != "hold_up" or not later:
        return [None]
    return [*dict.fromkeys(grasp.arm for grasp in subtask.grasps)]


class _Stage:
    """The world of a rehearsal: objects are where the sub-tasks so far have left them.

    Args: as of :func:`rehearsed`.
    """

    def __init__(self, chain: Sequence[Subtask], slots: Mapping[str, Slot], workplace: Workplace, scene: Scene):
        self._slots, self._workplace, self._objects = slots, workplace, workplace.by_id
        bodies = {o.id: Body(o.asset.model, o.pose, o.joints) for o in workplace.objects}
        self._world = World(scene.table, bodies, load_robot(scene.robot))
        self._holders = {o.id: (o.record.container, o.record.container_part) for o in workplace.objects}
        self._goes_to = {subtask.object: slots[subtask.id] for subtask in chain if subtask.id in slots}
        self._moved: set[str] = set()

    def play(self, subtask: Subtask, keeper: str | None) -> Subtask:
        """Rehearse a sub-task: examine it again where others changed its objects, then plan it.

        Args:
            subtask: the next one.
            keeper: the arm that must hold its object from then on; None for any free one.

        Raises:
            NoFeasibleTask: as :func:`rehearsed`.
        """
        touched = self._is_touched(subtask)
        if touched:
            subtask = self._examined(subtask)
        if subtask.id in self._slots:
            slot = self._goes_to[subtask.object] = self._slots[subtask.id]
            subtask = self._suiting(subtask, slot)
            self._holders[subtask.object] = _holder_of(slot, self._objects)
            self._moved.add(subtask.object)
        subtask = self._with_free_arms(subtask, keeper)
        task = Rehearsal(self._world, self._objects, self._goes_to)
        try:
            script_of(subtask).play(task)
        except TaskFailed as error:
            kind = _NotWithTheseSlots if touched or subtask.id in self._slots else NoFeasibleTask
            why = f"{subtask.id} cannot be planned"
            raise kind(f"{why}: {error.message}", hint=ANOTHER, details={"refused": why}) from error
        if subtask.template in TAKES:
            self._moved.add(subtask.object)
        if subtask.template == POURS:
            poured = [name for name, holder in self._holders.items() if holder == (subtask.object, None)]
            self._holders |= dict.fromkeys(poured, (subtask.goals[0].reference, None))
        grasps = sorted(subtask.grasps, key=lambda grasp: (grasp.contact, grasp.arm) != (task.contact, task.arm))
        return subtask.model_copy(update={"grasps": grasps})

    def _with_free_arms(self, subtask: Subtask, keeper: str | None) -> Subtask:
        """The sub-task with the grasps of arms that hold nothing up."""
        free = self._world.arms.keys() - self._world.keeping
        grasps = [grasp for grasp in subtask.grasps if grasp.arm in free and keeper in (None, grasp.arm)]
        if not grasps:
            why = f"{subtask.id} is not feasible with the arm that is free then"
            raise _NotWithTheseSlots(why, hint=ANOTHER, details={"refused": why})
        return subtask.model_copy(update={"grasps": grasps})

    def _suiting(self, subtask: Subtask, slot: Slot) -> Subtask:
        """The sub-task with the grasps first that suit its slot: it was found with its object at another place there.

        What changes hands or is pushed keeps its grasps.
        """
        if subtask.hand_to is not None or subtask.template == "push":
            return subtask
        now = {o.id: o for o in self._now()}
        thing, others = now[subtask.object], [o for o in now.values() if o.id != subtask.object]
        ways = transfers(thing, now.get(slot.receptacle), slot.point, slot.poses(now), others)
        workplace = self._workplace.with_objects([*now.values()]).with_arms(subtask.arm)
        findings = [*feasible(ways, workplace)]
        if not findings:
            return subtask
        grasps, checks = best_first(findings)
        known = {(grasp.contact, grasp.arm) for grasp in grasps}
        grasps += [grasp for grasp in subtask.grasps if (grasp.contact, grasp.arm) not in known]
        return subtask.model_copy(update={"grasps": preferred_first(grasps, subtask.prefers), "checks": checks})

    def _now(self) -> list[SceneObject]:
        """The objects as they are in the world."""
        return [_as_it_is(o, self._world, *self._holders[o.id]) for o in self._workplace.objects]

    def _is_touched(self, subtask: Subtask) -> bool:
        """True if a sub-task before has moved what this one handles, or put something into it."""
        handled = {subtask.object, subtask.tool, subtask.receptacle}
        return bool(self._moved & handled) or any(self._holders[name][0] == subtask.object for name in self._moved)

    def _examined(self, subtask: Subtask) -> Subtask:
        found = examined(subtask, self._workplace.with_objects(self._now()).without_arms(self._world.keeping))
        if found is None:
            why = f"{subtask.id} is not feasible after what comes before it"
            raise _NotWithTheseSlots(why, hint=ANOTHER, details={"refused": why})
        return found


def proven(
    chain: Sequence[Subtask],
    objects: Sequence[SceneObject],
    scene: Scene,
    rng: np.random.Generator,
    draws: int = LIMITS.slot_sets,
) -> tuple[list[Subtask], dict[str, Slot]]:
    """A chain with the grasps feasible in their turn, and the slots for them.

    Args:
        chain, objects, scene, rng: as :func:`rehearsed` takes them.
        draws: sets of slots that are tried; on receptacles the first follows from sizes, the others are drawn.

    Raises:
        NoFeasibleTask: with none of them each sub-task is feasible in its turn.
        InfeasibleScene: the contents of one receptacle do not fit together, or an object has no place on the table.
    """

    def propose(drawn: bool) -> tuple[list[Subtask], dict[str, Slot]]:
        slots = slots_for_chain(chain, Workplace.of(scene, objects, rng), drawn)
        return rehearsed(chain, slots, objects, scene, rng), slots

    proposals = [partial(propose, number > 0) for number in range(draws)]
    try:
        return first_accepted(proposals, (_NotWithTheseSlots, InfeasibleScene), LIMITS.same_slot_sets).value
    except GaveUp as error:
        raise error.refusals[-1] from None


def require_chain(scene: Scene, objects: Sequence[SceneObject], rng: np.random.Generator) -> None:
    """Require a chain for the scene's instruction that is feasible from its first step to its last.

    Args:
        scene: with its goals and robot.
        objects: of the scene, where they stand.
        rng: of all choices.

    Raises:
        NoFeasibleTask: there is none.
        InfeasibleScene: the contents of one receptacle do not fit together, or an object has no place on the table.
    """
    goals, arms = {asked.goal for asked in scene.goals}, asked_arms(scene.goals)
    found = find_subtasks(Workplace.of(scene, objects, rng), judging(False), goals, arms)
    kept = {subtask.id: subtask for subtask in found.kept}
    for names in compose(scene, objects, found.kept, found.refused):
        proven([kept[name] for name in names.subtasks], objects, scene, rng)


def _holder_of(slot: Slot, objects: Mapping[str, SceneObject]) -> tuple[str | None, str | None]:
    """The holder of an object brought to a slot, and its moving part."""
    if slot.point is None:
        return None, None
    return slot.receptacle, objects[slot.receptacle].asset.annotation.functional_point(slot.point).link


def _as_it_is(thing: SceneObject, world: World, container: str | None, part: str | None) -> SceneObject:
    """An object where it is in a world, lying in or on a container, or in a part of it."""
    body = world.body(thing.id)
    record = thing.record.model_copy(update={"container": container, "container_part": part})
    return replace(thing, record=record, pose=body.pose, joints=body.joints)
