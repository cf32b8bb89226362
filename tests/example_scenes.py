"""Small scenes of real assets on the ``table`` template, physics only, and the parts of an episode on them."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from vcage.base.geometry import Pose, world_aabb
from vcage.objects.library import Library
from vcage.schema.base import PoseRecord, Provenance
from vcage.schema.episodes import Failure, Verdict
from vcage.schema.goals import Goal
from vcage.schema.robot import Robot
from vcage.schema.scene import ObjectRecord, Role, Scene, SceneTemplate
from vcage.schema.subtasks import Grasp, PairAnswer, PairQuestion, Subtask
from vcage.sim.bodies import Body
from vcage.sim.kinematics import ArmKinematics, kinematics_of
from vcage.sim.robots import load_robot, load_template
from vcage.sim.world import World
from vcage.tasks.ground import Ground
from vcage.tasks.loop import EpisodeRun, run_episode
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.setting import Seen, Setting
from vcage.tasks.slots import Slot
from vcage.tasks.synthesis import Script
from vcage.tasks.task import Asked, Task
from vcage.tasks.workplace import Workplace

TABLE_TOP = 0.74
GROUND = Ground(np.array([-0.45, -0.25]), np.array([0.45, 0.3]), TABLE_TOP)
"""Where things may be put down on the table."""

ON_PLATE = Slot("plate", 0, Pose([0.0, 0.0, 0.0066]))
"""The middle of the plate."""


@functools.cache
def library() -> Library:
    return Library.load()


@functools.cache
def template() -> SceneTemplate:
    return load_template("table", "dual_panda")


@functools.cache
def robot() -> Robot:
    return load_robot(template().robot)


def with_fingers(stiffness: float | None) -> Robot:
    """The same robot with fingers of a stiffness, N/m; as soft as the arm's joints where none is given."""
    change = {"stiffness": stiffness, "damping": stiffness and 300.0}
    arms = {
        name: arm.model_copy(update={"gripper": arm.gripper.model_copy(update=change)})
        for name, arm in robot().arms.items()
    }
    return robot().model_copy(update={"arms": arms})


@functools.cache
def kinematics() -> Mapping[str, ArmKinematics]:
    return {name: kinematics_of(arm) for name, arm in robot().arms.items()}


def workplace(objects: Sequence[SceneObject], rng: np.random.Generator | None = None) -> Workplace:
    """Objects on the ground of the examples, with both arms."""
    return Workplace(objects, kinematics(), GROUND, rng or np.random.default_rng(0))


def thing(
    asset: str,
    xy: tuple[float, float] = (0.0, 0.0),
    yaw: float = 0.0,
    role: Role = "context",
    id: str | None = None,
    height: float = TABLE_TOP,
    container: str | None = None,
    variant: str | None = None,
) -> SceneObject:
    """An object of the library standing at ``xy``; by default in its first look, its id its asset's name."""
    geometry = library().asset(asset, variant)
    pose = Pose.from_yaw([*xy, height], yaw)
    lower, upper = world_aabb(geometry.bounds, pose).tolist()
    record = ObjectRecord(
        id=id or asset,
        asset=asset,
        variant=geometry.variant.id,
        phrase=f"{geometry.variant.colour} {geometry.annotation.words.name}",
        role=role,
        pose=PoseRecord.of(pose),
        aabb=(tuple(lower), tuple(upper)),
        container=container,
    )
    return SceneObject(record, geometry, pose)


def block_and_plate() -> list[SceneObject]:
    """A block in reach of both arms, and a plate."""
    return [thing("block", (-0.2, -0.05), 0.3, "content"), thing("plate", (0.05, 0.05), 0.0, "receptacle")]


def world_of(objects: Sequence[SceneObject], who: Robot | None = None) -> World:
    """A fresh world, physics only, robot at home."""
    return World(template().table, {o.id: Body(o.asset.model, o.pose) for o in objects}, who or robot())


def scene_of(objects: Sequence[SceneObject], instruction: str = "Put the block on the plate") -> Scene:
    """The record of the objects on the table."""
    return Scene(
        provenance=Provenance(producer="test", seed=0),
        instruction=instruction,
        template=template().name,
        robot=template().robot,
        table=template().table,
        workspace=template().workspace,
        top_camera=template().top_camera,
        objects=[o.record for o in objects],
    )


def sensible(questions: Sequence[PairQuestion]) -> list[PairAnswer]:
    """A reasoner that finds every pair sensible."""
    return [PairAnswer(object=q.object, receptacle=q.receptacle, sensible=True, reason="it fits") for q in questions]


def subtask(target: str = "block", receptacle: str = "plate", relation: str = "on", **changes: object) -> Subtask:
    """A sub-task record with one grasp."""
    fields = {
        "id": f"{target}-{'onto' if relation == 'on' else 'into'}-{receptacle}",
        "template": "place",
        "text": f"Put the {target} {relation} the {receptacle}.",
        "object": target,
        "receptacle": receptacle,
        "functional_point": 0,
        "grasps": [Grasp(contact=0, arm="left", score=-1.0)],
        "goals": [Goal(subject=target, relation=relation, reference=receptacle)],
        "script": "subtasks/script.py",
        "checks": [],
    }
    return Subtask(**{**fields, **changes})


def script_of(step: Subtask, play: Callable[[Task], None] | None = None) -> Script:
    """What the generated script of a sub-task does; another ``play`` can take its place."""

    def pick_and_place(task: Task) -> None:
        task.pick(step.object, [(g.contact, g.arm) for g in step.grasps])
        task.place(step.receptacle, point=step.functional_point)
        task.home()

    def verify(task: Task) -> Asked:
        return task.ask(step.text, [(g.subject, g.relation, g.reference) for g in step.goals])

    return Script(Path("script.py"), play or pick_and_place, verify, {})


@dataclass
class Critic:
    """Answers in turn, then the last answer for ever: yes, no, or a failure; remembers its questions."""

    answers: Sequence[bool | Failure] = (True,)
    asked: list[Asked] = field(default_factory=list)

    def __call__(self, asked: Asked, subtask: Subtask, seen: Seen) -> Verdict:
        answer = self.answers[min(len(self.asked), len(self.answers) - 1)]
        self.asked.append(asked)
        accepted, failure = answer is True, None if isinstance(answer, bool) else answer
        reason = "it is there" if accepted else "it is not there"
        return Verdict(accepted=accepted, reason=reason, confidence=1.0, provider="test", failure=failure)


def setting(
    objects: Sequence[SceneObject],
    slots: Mapping[str, Slot],
    critic: Critic,
    on_failure: str = "resample",
    accept: str = "both",
    retries: int = 2,
) -> Setting:
    """An episode's setting with tiny pictures."""
    return Setting(
        build=lambda: world_of(objects),
        objects={o.id: o for o in objects},
        slots=slots,
        photograph=lambda *_: {"top": np.zeros((2, 3, 3), dtype=np.uint8)},
        judge=critic,
        accept=accept,
        on_failure=on_failure,
        retries=retries,
        fps=10,
    )


def play_once(
    critic: Critic,
    step: Subtask | None = None,
    play: Callable[[Task], None] | None = None,
    **options: object,
) -> EpisodeRun:
    """An episode with one sub-task: the block onto the middle of the plate."""
    objects = block_and_plate()
    step = step or subtask()
    slots = {step.id: ON_PLATE}
    return run_episode(setting(objects, slots, critic, **options), [(step, script_of(step, play))], 0)
