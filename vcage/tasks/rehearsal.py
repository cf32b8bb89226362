"""A chain of sub-tasks gone through before anything moves: each must be feasible where those before it leave things."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from vcage.base.errors import NoFeasibleTask
from vcage.schema.plan import TABLE
from vcage.schema.robot import Robot
from vcage.schema.scene import Scene
from vcage.schema.subtasks import PairAnswer, PairQuestion, Subtask
from vcage.sim.joints import joint_index, joint_positions
from vcage.sim.kinematics import ArmKinematics, kinematics_of
from vcage.sim.robots import load_robot
from vcage.tasks.ground import Ground
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import compose, find_subtasks
from vcage.tasks.slots import Slot, slots_for_chain
from vcage.tasks.templates import TEMPLATES

DRAWS = 4
"""Sets of slots that are tried for a chain."""

STAYING = ("open", "closed", "turned")
"""What is true of a part after a sub-task and stays so: what is pressed springs back."""


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
    into = subtask.template == "hand_over" and subtask.functional_point is not None
    kind, asked = ("place" if into else subtask.template), [] if subtask.template == "place" else subtask.goals
    for proposal in TEMPLATES[kind].proposals(objects, asked)[0]:
        if proposal.thing.id == subtask.object and proposal.goal in subtask.goals:
            found, _ = proposal.examine(objects, kinematics, ground, rng)
            if found is not None and found.id == subtask.id:
                return found
    return None


def rehearsed(
    chain: Sequence[Subtask],
    slots: Mapping[str, Slot],
    objects: Sequence[SceneObject],
    kinematics: Mapping[str, ArmKinematics],
    ground: Ground,
    rng: np.random.Generator,
) -> list[Subtask | None]:
    """Each sub-task as it is feasible in its turn; None where it is not.

    Those about things that nothing has moved before are taken to be feasible as they are.

    Args:
        chain: sub-tasks that are feasible at the start, in order.
        slots: where each puts its object, by its id.
        objects, kinematics, ground, rng: as :func:`examined` takes them.
    """
    now, moved = {o.id: o for o in objects}, set[str]()
    found: list[Subtask | None] = []
    for subtask in chain:
        if moved & {subtask.object, subtask.tool, subtask.receptacle}:
            found.append(examined(subtask, list(now.values()), kinematics, ground, rng))
        else:
            found.append(subtask)
        if subtask.id in slots:
            now[subtask.object] = _put(now[subtask.object], slots[subtask.id], now)
            moved.add(subtask.object)
        now[subtask.object] = _operated(now[subtask.object], subtask)
    return found


def proven(
    chain: Sequence[Subtask],
    objects: Sequence[SceneObject],
    robot: Robot,
    ground: Ground,
    rng: np.random.Generator,
) -> tuple[list[Subtask], dict[str, Slot]]:
    """A chain with the grasps that are feasible when their turn comes, and the slots with which they are.

    Args:
        chain: sub-tasks that are feasible at the start, in order.
        objects, ground, rng: as :func:`examined` takes them.
        robot: whose hands bring things to their slots.

    Raises:
        NoFeasibleTask: with none of :data:`DRAWS` drawn sets of slots each sub-task is feasible in its turn.
        InfeasibleScene: what the chain puts into one receptacle does not fit together.
    """
    kinematics = {name: kinematics_of(arm) for name, arm in robot.arms.items()}
    lost: list[str] = []
    for _ in range(DRAWS):
        slots = slots_for_chain(chain, objects, robot, ground, rng)
        then = rehearsed(chain, slots, objects, kinematics, ground, rng)
        lost = [subtask.id for subtask, found in zip(chain, then, strict=True) if found is None]
        if not lost:
            return [found for found in then if found is not None], slots
    raise NoFeasibleTask(
        f"{lost[0]} is not feasible after what comes before it", hint="another --seed gives another layout"
    )


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
        InfeasibleScene: what the chain puts into one receptacle does not fit together.
    """
    ground = Ground.of(scene)
    found = find_subtasks(objects, kinematics, _nothing_else, ground, rng, {asked.goal for asked in scene.goals})
    kept = {subtask.id: subtask for subtask in found.kept}
    for names in compose(scene, objects, found.kept, found.refused):
        proven([kept[name] for name in names.subtasks], objects, load_robot(scene.robot), ground, rng)


def _nothing_else(questions: Sequence[PairQuestion]) -> list[PairAnswer]:
    """A judge for whom only what is asked for makes sense."""
    return [PairAnswer(object=q.object, receptacle=q.receptacle, sensible=False, reason="not asked") for q in questions]


def _put(thing: SceneObject, slot: Slot, objects: Mapping[str, SceneObject]) -> SceneObject:
    """An object in its slot, and lying in or on what that is of."""
    holder = None if slot.receptacle == TABLE else slot.receptacle
    record = thing.record.model_copy(update={"container": holder})
    return replace(thing, record=record).moved(slot.poses(objects)[0])


def _operated(thing: SceneObject, subtask: Subtask) -> SceneObject:
    """An object with its part where a sub-task leaves it."""
    part = next((goal.part for goal in subtask.goals if goal.relation in STAYING), None)
    if part is None or subtask.target is None:
        return thing
    joints = joint_positions(thing.asset.model, thing.joints)
    joints[joint_index(thing.asset.model, part)] = subtask.target
    return thing.moved(thing.pose, tuple(joints.tolist()))
