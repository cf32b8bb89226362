"""The closed loop around the sub-tasks of one episode (paper, section III-C).

After every sub-task the critic looks at pictures, and the simulator's state is asked. By default a sub-task is accepted
only where both say yes; the paper asks the critic alone. The end state of an accepted sub-task is the
snapshot for the start of the next. A failed one is retried from that snapshot in a freshly built world, or
ends the episode. An episode is accepted if every sub-task was and, where the state is asked, all goals hold at its end.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from vcage.base.errors import DamagedFile
from vcage.datasets.episode import Segment
from vcage.schema.episodes import Attempt, AttemptStage, Truth, Verdict, accepts
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Subtask
from vcage.sim.recording import StateLog
from vcage.sim.state import WorldState
from vcage.sim.world import World
from vcage.tasks.retries import Failed, Retry, blamed
from vcage.tasks.setting import PicturesByCamera, Seen, Setting, begin
from vcage.tasks.slots import Slot
from vcage.tasks.state import Watch
from vcage.tasks.synthesis import Script
from vcage.tasks.task import Asked, Task, TaskFailed
from vcage.tasks.truth import goals_hold, subtask_done, watch_of

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class EpisodeRun:
    """An episode that was played: the recording of its verified sub-tasks, and every attempt with its pictures.

    Args:
        log: states of the accepted sub-tasks, gapless; when one failed for good, its last attempt follows.
        segments: the accepted sub-tasks.
        attempts: all tries, in order.
        pictures: file name → picture behind a verdict.
        accepted: True if every sub-task was and, where the state is asked, all goals hold at the end.
        goals_hold: whether all goals of the instruction are true at the end, by the simulator's state; None where a
            sub-task failed before.
    """

    log: StateLog
    segments: list[Segment]
    attempts: list[Attempt]
    pictures: dict[str, np.ndarray]
    accepted: bool
    goals_hold: Truth | None = None

    @property
    def reason(self) -> str:
        """Why it was accepted or not."""
        if self.accepted:
            return f"all {len(self.segments)} sub-tasks were verified"
        if self.goals_hold is not None:
            return f"every sub-task was verified, but at the end {self.goals_hold.reason}"
        last = self.attempts[-1]
        return f"{last.subtask} failed at {last.stage}: {last.reason}"


def run_episode(
    setting: Setting, chain: Sequence[tuple[Subtask, Script]], index: int, goals: Sequence[Goal] = ()
) -> EpisodeRun:
    """Carry out a chain of sub-tasks, verifying each.

    Args:
        setting: where, and who looks at it.
        chain: the sub-tasks with their scripts, in order.
        index: number of the episode, for names and messages.
        goals: what must be true at the end, as the simulator's state is to tell.
    """
    world, recording = setting.build(), StateLog(setting.fps)
    start = begin(world, setting.start)  # the critic's first pictures are taken before the arms leave home
    recording.record(world)
    trials: list[_Trial] = []
    verified = True
    for number, (subtask, script) in enumerate(chain):
        slots = _slots_during(subtask, chain, setting.slots)
        step = _Step(setting, recording, index, number, subtask, script, slots, start)
        world, tried = step.until_verified(world)
        trials += tried
        verified = tried[-1].attempt.accepted
        if not verified:
            break
    holds = goals_hold(goals, Watch(world, setting.objects)) if verified else None
    return EpisodeRun(
        log=recording,
        segments=[trial.segment for trial in trials if trial.segment is not None],
        attempts=[trial.attempt for trial in trials],
        pictures={name: picture for trial in trials for name, picture in trial.pictures.items()},
        accepted=holds is not None and (holds.success or setting.accept == "critic"),
        goals_hold=holds,
    )


def _slots_during(
    subtask: Subtask, chain: Sequence[tuple[Subtask, Script]], slots: Mapping[str, Slot]
) -> dict[str, Slot]:
    """Slots by object: where each goes in the chain at last, and where the object of this sub-task goes now."""
    return {s.object: slots[s.id] for s in (*(s for s, _ in chain), subtask) if s.id in slots}


@dataclass(frozen=True)
class _Trial:
    """One attempt at a sub-task.

    Args:
        attempt: its record.
        pictures: file name → picture behind the verdict.
        segment: of the recording, if it was accepted.
        slot: that it took.
        exhausted: another attempt would fail in the same way.
    """

    attempt: Attempt
    pictures: Mapping[str, np.ndarray] = field(default_factory=dict)
    segment: Segment | None = None
    slot: Slot | None = None
    exhausted: bool = False

    @property
    def failed(self) -> Failed:
        """The attempt as further ones see it."""
        record = self.attempt
        failure = None if record.verdict is None else record.verdict.failure
        return Failed(record.contact, record.arm, self.slot, blamed(record.stage, failure))


@dataclass(frozen=True)
class _Step:
    """One sub-task of an episode.

    Args:
        setting: of the episode.
        recording: of the episode.
        episode: its number.
        number: of the sub-task in the chain.
        subtask, script: the sub-task and its program.
        slots: object id → its target, now or later.
        start: of the episode.
    """

    setting: Setting
    recording: StateLog
    episode: int
    number: int
    subtask: Subtask
    script: Script
    slots: Mapping[str, Slot]
    start: WorldState

    def until_verified(self, world: World) -> tuple[World, list[_Trial]]:
        """The attempts up to the first accepted one, or to the limit; and the world after the last."""
        snapshot, start = world.snapshot(), world.steps
        standing = world.state() if self.number else self.start
        before = self.setting.photograph(standing, self.subtask.goals, None)
        trials: list[_Trial] = []
        for attempt in range(1 + (self.setting.retries if self.setting.on_failure == "resample" else 0)):
            if attempt > 0:
                world = self.setting.build()
                world.restore(snapshot)
                self.recording.record(world)
            trials.append(self._try(world, Retry(tuple(trial.failed for trial in trials)), start, before))
            if trials[-1].attempt.accepted or trials[-1].exhausted:
                break
        return world, trials

    def _try(self, world: World, retry: Retry, start: int, before: PicturesByCamera) -> _Trial:
        task, attempt = Task(world, self.setting.objects, self.slots, retry), len(retry.failed)
        watch = watch_of(self.subtask, world, self.setting.objects)
        try:
            self.script.play(task)
            asked = self.script.verify(task)
            if not isinstance(asked, Asked):
                message = f"{self.script.path}: verify(task) gives {asked!r}, not what task.ask(…) does"
                raise DamagedFile(message, hint="fix it", maker="search_subtasks")
        except TaskFailed as error:
            record = self._attempt(task, attempt, world.steps - start, error.stage, error.message)
            return _Trial(record, slot=task.slot, exhausted=error.exhausted)
        finally:
            watch.stop()
        seen = self._critic_pictures(before, world, task)
        pictures = self._named(attempt, seen)
        verdict = self.setting.judge(asked, self.subtask, seen)
        verdict = verdict.model_copy(update={"pictures": list(pictures)})
        truth = subtask_done(self.subtask, asked.goals, watch)
        accepted = accepts(self.setting.accept, verdict, truth)
        stage: AttemptStage = "done" if accepted else "verify"
        judged: dict[str, Any] = {"verdict": verdict, "truth": truth}
        reason = _reason(verdict, truth, accepted)
        record = self._attempt(task, attempt, world.steps - start, stage, reason, **judged)
        if not accepted:
            return _Trial(record, pictures, slot=task.slot)
        segment = Segment(
            subtask=self.subtask.id,
            text=self.subtask.text,
            start=self.recording.frame_at(start),
            end=self.recording.frame_at(world.steps),
            arm=task.arm or "",
            contact=-1 if task.contact is None else task.contact,
            attempts=attempt + 1,
            **judged,
        )
        return _Trial(record, pictures, segment)

    def _critic_pictures(self, before: PicturesByCamera, world: World, task: Task) -> Seen:
        """The pictures for the critic."""
        goals, photograph = self.subtask.goals, self.setting.photograph
        seen = {"before": before, "after": photograph(world.state(), goals, None)}
        if task.moment is not None:
            seen["moment"] = photograph(task.moment, goals, task.arm)
        if task.later is not None:
            seen["later"] = photograph(task.later, goals, task.arm)
        if any(goal.kind.shown.start for goal in goals):
            seen["start"] = photograph(self.start, goals, None)
        return seen

    def _named(self, attempt: int, seen: Seen) -> dict[str, np.ndarray]:
        """The pictures of a verdict under descriptive names."""
        prefix = f"critic/e{self.episode:06d}-s{self.number}-a{attempt}"
        return {
            f"{prefix}-{when}-{camera}.png": picture
            for when, pictures in seen.items()
            for camera, picture in pictures.items()
        }

    def _attempt(
        self, task: Task, attempt: int, steps: int, stage: AttemptStage, reason: str, **judged: Any
    ) -> Attempt:
        record = self.setting.objects[self.subtask.object].record
        if stage != "done":
            where = f"episode {self.episode}, {self.subtask.id}, attempt {attempt + 1}"
            logger.info("%s: %s: %s", where, stage, reason)
        return Attempt(
            episode=self.episode,
            step=self.number,
            attempt=attempt,
            subtask=self.subtask.id,
            object=self.subtask.object,
            asset=record.asset,
            variant=record.variant,
            arm=task.arm,
            contact=task.contact,
            changes=task.changes,
            stage=stage,
            reason=reason,
            accepted=stage == "done",
            steps=steps,
            **judged,
        )


def _reason(verdict: Verdict, truth: Truth, accepted: bool) -> str:
    """Why a sub-task was accepted or not: what the critic says, and what the simulator's state says if it disagrees."""
    if verdict.accepted == truth.success:
        return verdict.reason
    judges = [("critic", verdict.accepted, verdict.reason), ("simulator's state", truth.success, truth.reason)]
    decided, other = sorted(judges, key=lambda judge: judge[1] != accepted)
    said = ("yes" if decided[1] else "no", "yes" if other[1] else "no")
    return f"the {decided[0]} says {said[0]}: {decided[2]}; the {other[0]} says {said[1]}: {other[2]}"
