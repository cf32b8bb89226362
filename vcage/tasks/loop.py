"""The closed loop around the sub-tasks of one episode (paper, section III-C).

After every sub-task the critic looks. What it accepts is kept: its end state becomes the snapshot from which the
next sub-task starts. What fails is tried again from that snapshot in a freshly built world, or ends the episode.
The episode is accepted if and only if every sub-task was.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from vcage.base.geometry import Pose
from vcage.datasets.episode import Segment
from vcage.schema.episodes import Attempt, AttemptStage, Truth, Verdict
from vcage.schema.subtasks import Subtask
from vcage.sim.recording import StateLog
from vcage.sim.state import WorldState
from vcage.sim.world import World
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.synthesis import Script
from vcage.tasks.task import Asked, Task, TaskFailed
from vcage.tasks.truth import goals_hold

log = logging.getLogger(__name__)

Pictures = Mapping[str, np.ndarray]
"""Camera name → (H, W, 3) uint8."""


@dataclass(frozen=True)
class Setting:
    """Where an episode happens, and who looks at it.

    Args:
        build: makes the world of the episode's start, robot at home, physics only.
        objects: by id, with their geometry.
        slots: object id → where the chain puts it, in its receptacle's frame.
        photograph: pictures of a state.
        judge: the critic's verdict on text, goals, pictures before and after.
        on_failure: what follows a failed sub-task.
        retries: further attempts per sub-task, when resampling.
        fps: frames per second of the recording.
    """

    build: Callable[[], World]
    objects: Mapping[str, SceneObject]
    slots: Mapping[str, Pose]
    photograph: Callable[[WorldState], Pictures]
    judge: Callable[[Asked, Pictures, Pictures], Verdict]
    on_failure: Literal["resample", "abort"]
    retries: int
    fps: int


@dataclass
class EpisodeRun:
    """What came of an episode: the recording of what was verified, and every attempt with its pictures.

    Args:
        log: states of the accepted sub-tasks, gapless; when one failed for good, its last attempt follows.
        segments: the accepted sub-tasks.
        attempts: all tries, in order.
        pictures: file name → picture that a verdict looked at.
    """

    log: StateLog
    segments: list[Segment] = field(default_factory=list)
    attempts: list[Attempt] = field(default_factory=list)
    pictures: dict[str, np.ndarray] = field(default_factory=dict)
    accepted: bool = False

    @property
    def reason(self) -> str:
        """Why it was accepted or not."""
        if self.accepted:
            return f"all {len(self.segments)} sub-tasks were verified"
        last = self.attempts[-1]
        return f"{last.subtask} failed at {last.stage}: {last.reason}"


def run_episode(setting: Setting, chain: Sequence[tuple[Subtask, Script]], index: int) -> EpisodeRun:
    """Carry out a chain of sub-tasks, verifying each."""
    run = EpisodeRun(StateLog(setting.fps))
    world = setting.build()
    world.settle()
    run.log.record(world)
    for step, (subtask, script) in enumerate(chain):
        after = _StepRun(setting, run, index, step, subtask, script).until_verified(world)
        if after is None:
            return run
        world = after
    run.accepted = True
    return run


class _StepRun:
    """The attempts at one sub-task."""

    def __init__(self, setting: Setting, run: EpisodeRun, index: int, step: int, subtask: Subtask, script: Script):
        self._setting, self._run = setting, run
        self._index, self._step = index, step
        self._subtask, self._script = subtask, script

    def until_verified(self, world: World) -> World | None:
        """The world after the first attempt that the critic accepts, or None when none is."""
        snapshot, start = world.snapshot(), world.steps
        before = self._setting.photograph(world.state())
        tries = 1 + (self._setting.retries if self._setting.on_failure == "resample" else 0)
        for attempt in range(tries):
            if attempt > 0:
                world = self._setting.build()
                world.restore(snapshot)
                self._run.log.record(world)
            if self._attempt(world, attempt, start, before):
                return world
        return None

    def _attempt(self, world: World, attempt: int, start: int, before: Pictures) -> bool:
        task = Task(world, self._setting.objects, self._setting.slots, attempt)
        try:
            self._script.play(task)
            asked = self._script.verify(task)
        except TaskFailed as error:
            self._note(task, attempt, error.stage, error.message, world.steps - start)
            return False
        after = self._setting.photograph(world.state())
        verdict = self._setting.judge(asked, before, after)
        verdict = verdict.model_copy(update={"pictures": self._keep(attempt, before, after)})
        truth = self._truth(asked, world)
        stage: AttemptStage = "done" if verdict.accepted else "verify"
        self._note(task, attempt, stage, verdict.reason, world.steps - start, verdict, truth)
        if verdict.accepted:
            self._commit(task, attempt, start, world.steps, verdict, truth)
        return verdict.accepted

    def _truth(self, asked: Asked, world: World) -> Truth:
        poses = world.object_poses()
        objects = {key: o.moved(poses[key]) for key, o in self._setting.objects.items()}
        return goals_hold(asked.goals, objects, {self._subtask.receptacle: self._subtask.functional_point})

    def _keep(self, attempt: int, before: Pictures, after: Pictures) -> list[str]:
        """Remember the pictures of a verdict under names that say what they show."""
        names = []
        for moment, pictures in (("before", before), ("after", after)):
            for camera, picture in pictures.items():
                name = f"critic/e{self._index:06d}-s{self._step}-a{attempt}-{moment}-{camera}.png"
                self._run.pictures[name] = picture
                names.append(name)
        return names

    def _commit(self, task: Task, attempt: int, start: int, end: int, verdict: Verdict, truth: Truth) -> None:
        frames = self._run.log
        segment = Segment(
            subtask=self._subtask.id,
            text=self._subtask.text,
            start=frames.frame_at(start),
            end=frames.frame_at(end),
            arm=task.arm or "",
            contact=-1 if task.contact is None else task.contact,
            attempts=attempt + 1,
            verdict=verdict,
            truth=truth,
        )
        self._run.segments.append(segment)

    def _note(
        self,
        task: Task,
        attempt: int,
        stage: AttemptStage,
        reason: str,
        steps: int,
        verdict: Verdict | None = None,
        truth: Truth | None = None,
    ) -> None:
        record = self._setting.objects[self._subtask.object].record
        accepted = verdict is not None and verdict.accepted
        if not accepted:
            log.info("episode %d, %s, attempt %d: %s: %s", self._index, self._subtask.id, attempt + 1, stage, reason)
        self._run.attempts.append(
            Attempt(
                episode=self._index,
                step=self._step,
                attempt=attempt,
                subtask=self._subtask.id,
                object=self._subtask.object,
                asset=record.asset,
                variant=record.variant,
                arm=task.arm,
                contact=task.contact,
                stage=stage,
                reason=reason,
                accepted=accepted,
                verdict=verdict,
                truth=truth,
                steps=steps,
            )
        )
