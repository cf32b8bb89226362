"""A chain of sub-tasks in a scene, carried out again and again."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np

from benchmarks._laying_out import lay_out
from benchmarks._loop.planted import Planted, befallen
from vcage.base.errors import VcageError
from vcage.base.files import RunFolder
from vcage.episodes.photographs import Photographer, light_look
from vcage.episodes.question import Asking, verdict
from vcage.plans.actions import lasting
from vcage.runs.context import StageContext
from vcage.runs.stage import ModelOptions
from vcage.schema.episodes import Failure, Truth, Verdict
from vcage.schema.goals import in_steps
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask, Subtasks
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.stages import search_subtasks, select_place
from vcage.tasks.chain_slots import slots_for_chain
from vcage.tasks.ground import Ground
from vcage.tasks.loop import EpisodeRun, run_episode
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.setting import PicturesByCamera, Seen, Setting
from vcage.tasks.synthesis import Script, script_of
from vcage.tasks.task import Asked, Task
from vcage.tasks.truth import subtask_done, watch_of
from vcage.tasks.workplace import Workplace

Mode = Literal["resample", "blind", "abort", "open"]
"""Trying again as the critic's reason says, trying again knowing no more than that it is a no, beginning anew, and not
looking."""

Critic = Literal["pictures", "perfect"]

FPS = 10


class Chain:
    """A chain of sub-tasks in a scene, carried out again and again.

    Args:
        sentence: that asks for it.
        steps: how many there are to be.

    Raises:
        VcageError: there are others than that.
    """

    def __init__(self, sentence: str, steps: int):
        self._context = StageContext("offline")
        with tempfile.TemporaryDirectory() as folder:
            run = RunFolder(Path(folder) / "run")
            lay_out(run, select_place.Options(instruction=sentence, models="offline"), self._context)
            search_subtasks.execute(run, ModelOptions(models="offline"), self._context)
            self._scene, found = Scene.read(run.layout), Subtasks.read(run.subtasks)
            kept = {subtask.id: subtask for subtask in found.kept}
            self._chain = [(kept[n], script_of(kept[n])) for n in found.chains[0].subtasks]
        if len(self._chain) != steps:
            raise VcageError(f"{sentence!r} became {len(self._chain)} sub-tasks, not {steps}")
        self._objects = {o.id: o for o in self._context.objects(self._scene)}
        self._robot, self._models = load_robot(self._scene.robot), self._context.physical_models(self._scene)
        look = light_look(self._scene, self._models, self._robot, np.random.default_rng(0))
        objects = list(self._objects.values())
        self._photographer = Photographer(self._scene, self._models, self._robot, look, objects)
        self._empty = self._photographer.empty_table()

    def carried_out(self, mode: Mode, critic: Critic, planted: Planted, retries: int, seed: int) -> Played:
        """One episode, until every step is verified or one failed for good.

        Args:
            mode: what follows a failure.
            critic: who judges.
            planted: the failures.
            retries: further attempts of a step, where that is what follows.
            seed: of the episode: its slots, and where things are found that were lost.
        """
        rng = np.random.default_rng([7, seed])
        subtasks, ground = [subtask for subtask, _ in self._chain], Ground.of(self._scene)
        slots = slots_for_chain(subtasks, Workplace.of(self._scene, list(self._objects.values()), rng))
        looks = critic == "pictures" and mode != "open"
        judge = self._judge if looks else None
        looking = _Looking(self._objects, ground, planted, rng, mode, judge)
        setting = Setting(
            build=lambda: World.of_scene(self._scene, self._models, self._robot),
            objects=self._objects,
            slots=slots,
            photograph=self._photographer.shots if looks else _nothing,
            judge=looking.judge,
            accept="critic",
            on_failure="resample" if mode in ("resample", "blind") else "abort",
            retries=retries,
            fps=FPS,
        )
        chain = [
            (subtask, replace(script, play=partial(looking.play, subtask, script))) for subtask, script in self._chain
        ]
        done = run_episode(setting, chain, 0, lasting(in_steps(self._scene.goals)))
        return Played(done, looking.named)

    def _judge(self, asked: Asked, subtask: Subtask, seen: Seen) -> Verdict:
        told = (seen, self._empty, subtask.requires, subtask.grasped)
        return verdict(self._context, self._scene, Asking(asked.text, asked.goals, *told))


@dataclass(frozen=True)
class Played:
    """Outcome of an episode.

    Args:
        run: of the closed loop.
        named: of each planted failure that was refused: its true kind and the critic's.
    """

    run: EpisodeRun
    named: list[tuple[Failure, Failure | None]]


@dataclass
class _Looking:
    """Plants the failures of an episode, and judges it.

    Args:
        objects: by id.
        ground: of the table.
        planted: when which failure happens.
        rng: of where things are found then.
        mode: of the episode.
        look: the critic with eyes; None for the one that knows.
        known: the truth of the last attempt.
        befell: what was planted in it.
        named: see :class:`Played`.
    """

    objects: Mapping[str, SceneObject]
    ground: Ground
    planted: Planted
    rng: np.random.Generator
    mode: Mode
    look: Callable[[Asked, Subtask, Seen], Verdict] | None
    known: Truth = field(default_factory=lambda: Truth(success=False, reason="nothing was done yet"))
    befell: Failure | None = None
    named: list[tuple[Failure, Failure | None]] = field(default_factory=list)

    def play(self, subtask: Subtask, script: Script, task: Task) -> None:
        """Execute a script; then displace the objects set down, if a failure is planted."""
        world, was = task.world, task.world.object_pose(subtask.object)
        watch = watch_of(subtask, world, self.objects)
        try:
            script.play(task)
            self.befell = self.planted.failure(subtask, (task.contact, task.arm), task.slot)
            if self.befell is not None:
                now = {name: watch.thing(name) for name in self.objects}
                world.set_object_pose(subtask.object, befallen(self.befell, subtask, now, was, self.ground, self.rng))
                world.settle()
            self.known = subtask_done(subtask, subtask.goals, watch)
        finally:
            watch.stop()
        if self.befell is not None and self.known.success:
            raise VcageError(f"what was planted in {subtask.id} is no failure: {self.known.reason}")

    def judge(self, asked: Asked, subtask: Subtask, seen: Seen) -> Verdict:
        """The verdict; told to the blind without what went wrong."""
        if self.mode == "open":
            return Verdict(accepted=True, reason="nobody looks here", confidence=1.0, provider="benchmark")
        said = self._truth() if self.look is None else self.look(asked, subtask, seen)
        if self.befell is not None and not said.accepted:
            self.named.append((self.befell, said.failure))
        return said.model_copy(update={"failure": None}) if self.mode == "blind" else said

    def _truth(self) -> Verdict:
        known, failure = self.known, None if self.known.success else self.befell
        return Verdict(
            accepted=known.success, reason=known.reason, confidence=1.0, provider="benchmark", failure=failure
        )


def _nothing(*_: Any) -> PicturesByCamera:
    return {}
