"""Rehearse a chain before anything moves: each sub-task must be feasible where those before it leave things."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from vcage.base.errors import NoFeasibleTask
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask
from vcage.sim.bodies import Body
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.tasks.asked_arms import bound_to
from vcage.tasks.choosing import as_chosen, preferred_first
from vcage.tasks.feasibility import feasible, transfers
from vcage.tasks.findings import best_first
from vcage.tasks.rehearsal import Rehearsal
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import POURS, TAKES
from vcage.tasks.slots import Slot, asks_for_heading
from vcage.tasks.synthesis import script_of
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.workcell import TaskFailed
from vcage.tasks.workplace import Workplace

_ANOTHER = "another --seed gives another layout"


class NotWithTheseSlots(NoFeasibleTask):
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
            kind = NotWithTheseSlots if touched or subtask.id in self._slots else NoFeasibleTask
            why = f"{subtask.id} cannot be planned"
            raise kind(f"{why}: {error.message}", hint=_ANOTHER, details={"refused": why}) from error
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
            raise NotWithTheseSlots(why, hint=_ANOTHER, details={"refused": why})
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
            raise NotWithTheseSlots(why, hint=_ANOTHER, details={"refused": why})
        return found


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
