"""A chain of sub-tasks gone through before anything moves: each must be feasible where those before it leave things."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from vcage.base.errors import NoFeasibleTask
from vcage.schema.plan import TABLE
from vcage.schema.scene import Scene
from vcage.schema.subtasks import PairAnswer, PairQuestion, Subtask
from vcage.sim.bodies import Body
from vcage.sim.kinematics import ArmKinematics, kinematics_of
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.tasks.asked_arms import asked_arms, bound_to, those_of
from vcage.tasks.choosing import as_chosen
from vcage.tasks.ground import Ground
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import compose, find_subtasks
from vcage.tasks.slots import Slot, slots_for_chain
from vcage.tasks.synthesis import script_of
from vcage.tasks.task import Task
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.workcell import TaskFailed

DRAWS = 4
"""Sets of slots that are tried for a chain in a layout, where another layout would do as well."""

ANOTHER = "another --seed gives another layout"


class _NotWithTheseSlots(NoFeasibleTask):
    """What cannot be done depends on where the chain puts things: elsewhere it may be possible."""


def examined(
    subtask: Subtask,
    objects: Sequence[SceneObject],
    kinematics: Mapping[str, ArmKinematics],
    ground: Ground,
    rng: np.random.Generator,
) -> Subtask | None:
    """The sub-task as it is feasible among these objects, changing hands on its way only where it did before.

    Args:
        subtask: as it was found among objects that stood elsewhere.
        objects: of the scene.
        kinematics: by arm.
        ground: of the table.
        rng: of all choices.
    """
    kinematics = those_of(kinematics, subtask.arm, subtask.hand_to)
    into = subtask.template == "hand_over" and subtask.functional_point is not None
    kind, asked = ("place" if into else subtask.template), [] if subtask.template == "place" else subtask.goals
    for proposal in TEMPLATES[kind].proposals(objects, asked)[0]:
        if proposal.thing.id == subtask.object and proposal.goal in subtask.goals:
            found, _ = proposal.examine(objects, kinematics, ground, rng)
            if found is not None and found.id == subtask.id:
                return as_chosen(bound_to(found, subtask.arm), subtask)
    return None


class Rehearsal(Task):
    """A task that plans its motions and carries none out: things are then where they would have been brought."""

    def pick(self, object_id: str, grasps: Sequence[tuple[int, str]], hand_to: str | None = None) -> None:
        """Plan it; also whether it can be handed over."""
        self._picked = self._choose(self._cell.object(object_id), grasps, hand_to)

    def hand_over(self, to: str) -> None:
        """Nothing: :meth:`pick` has looked."""

    def show(self, object_id: str, other_id: str, grasps: Sequence[tuple[int, str]]) -> None:
        """Plan it; the object is put back."""
        self._choose_showing(object_id, other_id, grasps)

    def wait(self, seconds: float) -> None:
        """Nothing."""

    def place(self, receptacle_id: str = TABLE, point: int | None = None) -> None:
        """Bring what was picked, with its contents, to its slot, at the heading that is nearest for its arm."""
        if self.slot is not None:
            plan, arm = self._picked, self._cell.planner(self._picked.arm).kinematics
            held = plan.target.pose.inverse() * plan.way.grasp
            poses = self.slot.poses(self._cell.objects())
            nearest = min(poses, key=lambda pose: arm.distance(plan.path.end, pose * held))
            way = nearest * plan.target.pose.inverse()
            for name in (plan.target.id, *self._cell.contents(plan.target.id)):
                self.world.set_object_pose(name, way * self.world.object_pose(name))

    def push(self, object_id: str, arms: Sequence[str] = ()) -> None:
        """Plan it; the object is where it is pushed to."""
        self.world.set_object_pose(object_id, self._choose_push(self._cell.object(object_id), arms).goal)

    def operate(self, object_id: str, contact_id: int, target: float, arms: Sequence[str] = ()) -> None:
        """Plan it; the part is at its target, unless it springs back, with what rides on it."""
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
    """Each sub-task as it is feasible in its turn, the grasp first with which its motions were planned.

    Args:
        chain: sub-tasks that are feasible at the start, in order.
        slots: where each puts its object, by its id.
        objects: where they stand at the start.
        scene: whose table and robot these are.
        rng: of all choices.

    Raises:
        NoFeasibleTask: one of them is not feasible where those before it leave things, or cannot be planned there;
            ``details["refused"]`` says which, without what was measured.
    """
    robot, ground = load_robot(scene.robot), Ground.of(scene)
    kinematics = {name: kinematics_of(arm) for name, arm in robot.arms.items()}
    world = World(scene.table, {o.id: Body(o.asset.model, o.pose, o.joints) for o in objects}, robot)
    by_id, found = {o.id: o for o in objects}, list[Subtask]()
    lies = {o.id: (o.record.container, o.record.container_part) for o in objects}
    goes = {subtask.object: slots[subtask.id] for subtask in chain if subtask.id in slots}
    moved = set[str]()
    for subtask in chain:
        contents = {name for name in moved if lies[name][0] == subtask.object}
        again = bool(contents or moved & {subtask.object, subtask.tool, subtask.receptacle})
        if again:
            now = [_as_it_is(o, world, *lies[o.id]) for o in objects]
            then = examined(subtask, now, kinematics, ground, rng)
            if then is None:
                why = f"{subtask.id} is not feasible after what comes before it"
                raise _NotWithTheseSlots(why, hint=ANOTHER, details={"refused": why})
            subtask = then
        if subtask.id in slots:
            slot = goes[subtask.object] = slots[subtask.id]
            lies[subtask.object] = _place_of(slot, by_id)
            moved.add(subtask.object)
        task = Rehearsal(world, by_id, goes)
        try:
            script_of(subtask).play(task)
        except TaskFailed as error:
            kind, why = _NotWithTheseSlots, f"{subtask.id} cannot be planned"
            if not again and subtask.id not in slots:
                kind = NoFeasibleTask
            raise kind(f"{why}: {error.message}", hint=ANOTHER, details={"refused": why}) from error
        taken = [grasp for grasp in subtask.grasps if (grasp.contact, grasp.arm) == (task.contact, task.arm)]
        others = [grasp for grasp in subtask.grasps if grasp not in taken]
        found.append(subtask.model_copy(update={"grasps": [*taken, *others]}))
    return found


def proven(
    chain: Sequence[Subtask],
    objects: Sequence[SceneObject],
    scene: Scene,
    rng: np.random.Generator,
    draws: int = DRAWS,
) -> tuple[list[Subtask], dict[str, Slot]]:
    """A chain with the grasps that are feasible when their turn comes, and the slots with which they are.

    Args:
        chain, objects, scene, rng: as :func:`rehearsed` takes them.
        draws: sets of slots that are tried.

    Raises:
        NoFeasibleTask: with none of them each sub-task is feasible in its turn.
        InfeasibleScene: what the chain puts into one receptacle does not fit together, or has no place on the table.
    """
    for _ in range(draws - 1):
        with contextlib.suppress(_NotWithTheseSlots):
            return _proven(chain, objects, scene, rng)
    return _proven(chain, objects, scene, rng)


def _proven(
    chain: Sequence[Subtask], objects: Sequence[SceneObject], scene: Scene, rng: np.random.Generator
) -> tuple[list[Subtask], dict[str, Slot]]:
    """:func:`proven` with the slots that are drawn first."""
    slots = slots_for_chain(chain, objects, load_robot(scene.robot), Ground.of(scene), rng)
    return rehearsed(chain, slots, objects, scene, rng), slots


def require_chain(
    scene: Scene, objects: Sequence[SceneObject], kinematics: Mapping[str, ArmKinematics], rng: np.random.Generator
) -> None:
    """Nothing, if there is a chain for the scene's instruction that is feasible from its first step to its last.

    Args:
        scene: with its goals.
        objects: of the scene, where they stand.
        kinematics: by arm.
        rng: of all choices.

    Raises:
        NoFeasibleTask: there is none.
        InfeasibleScene: what the chain puts into one receptacle does not fit together, or has no place on the table.
    """
    ground = Ground.of(scene)
    goals, arms = {asked.goal for asked in scene.goals}, asked_arms(scene.goals)
    found = find_subtasks(objects, kinematics, _nothing_else, ground, rng, goals, arms)
    kept = {subtask.id: subtask for subtask in found.kept}
    for names in compose(scene, objects, found.kept, found.refused):
        proven([kept[name] for name in names.subtasks], objects, scene, rng)


def _nothing_else(questions: Sequence[PairQuestion]) -> list[PairAnswer]:
    """A judge for whom only what is asked for makes sense."""
    return [PairAnswer(object=q.object, receptacle=q.receptacle, sensible=False, reason="not asked") for q in questions]


def _place_of(slot: Slot, objects: Mapping[str, SceneObject]) -> tuple[str | None, str | None]:
    """The holder of a thing that was brought to a slot, and the moving part of that."""
    if slot.point is None:
        return None, None
    return slot.receptacle, objects[slot.receptacle].asset.annotation.functional_point(slot.point).link


def _as_it_is(thing: SceneObject, world: World, container: str | None, part: str | None) -> SceneObject:
    """An object where it is in a world, lying in or on a container, or in a part of it."""
    body = world.body(thing.id)
    record = thing.record.model_copy(update={"container": container, "container_part": part})
    return replace(thing, record=record, pose=body.pose, joints=body.joints)
