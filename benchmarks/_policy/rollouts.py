"""Policies at work in the simulator, from the starts of held-out episodes; the simulator's own state judges."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks._policy.demonstrations import View, small
from benchmarks._policy.training import Policy
from vcage.base.files import RunFolder
from vcage.datasets.reader import EpisodeReader
from vcage.episodes.photographs import light_look
from vcage.episodes.recorded import Recorded
from vcage.runs.accepted import accepted_episodes
from vcage.runs.context import StageContext
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask, Subtasks
from vcage.sim.arms import ArmControl
from vcage.sim.cameras import robot_cameras, shoot
from vcage.sim.looks import look_world
from vcage.sim.world import PHYSICS_HZ, World
from vcage.tasks.state import Watch
from vcage.tasks.truth import goals_hold

logger = logging.getLogger(__name__)

EXECUTED = 5
"""Actions of a chunk that are carried out before the policy looks again (a receding horizon)."""

PATIENCE = 2.0
"""A rollout may take so many times as long as the demonstration from the same start."""

LIFTED = 0.03
"""Metres above where it stood: a thing that a hand holds there does not lean or slide."""

LIGHT_SEED = 11
"""Of the lights and table tops of rollouts, which no episode has."""


@dataclass(frozen=True)
class Outcome:
    """The progress of a rollout.

    Args:
        touched: a hand touched what it was to move.
        lifted: a hand held it above where it stood.
        done: all that was to be brought about is true.
    """

    touched: bool
    lifted: bool
    done: bool


class Rollouts:
    """Starts of the held-out episodes.

    Args:
        run: that they were collected in.
        episodes: how many of them.
        view: what policies see.
    """

    def __init__(self, run: RunFolder, episodes: int, view: View):
        self._view, self._context = view, StageContext("offline")
        found = Subtasks.read(run.subtasks)
        self._subtasks = [s for s in found.kept if s.id in found.chains[0].subtasks]
        self._starts = [self._start(run.root / str(e.file)) for e in accepted_episodes(run)[:episodes]]

    def __len__(self) -> int:
        return len(self._starts)

    def outcome(self, policy: Policy, number: int) -> Outcome:
        """Roll a policy out; the number gives the start, and the light."""
        start = self._starts[number % len(self._starts)]
        rng = np.random.default_rng([LIGHT_SEED, number])
        of = start.scene, start.models, start.robot
        world = look_world(*of, light_look(*of, rng))
        trial = _Trial(world, self._watch(world, start.scene), self._subtasks, start.episode.fps)
        for _ in range(int(PATIENCE * start.episode.frames) // EXECUTED):
            chunk = policy.act(self._seen(world)[None], _state(world)[None])[0]
            trial.carry_out(chunk[:EXECUTED])
            if trial.outcome.done:
                break
        return trial.outcome

    def replayed(self, number: int) -> bool:
        """True if the recorded actions of an episode do the task again, carried out as those of a policy are."""
        start = self._starts[number % len(self._starts)]
        world = start.world()
        trial = _Trial(world, self._watch(world, start.scene), self._subtasks, start.episode.fps)
        trial.carry_out(start.episode.action.astype(np.float32))
        return trial.outcome.done

    def _start(self, path: Path) -> Recorded:
        with EpisodeReader(path) as reader:
            return Recorded.of(reader.episode, path, self._context)

    def _watch(self, world: World, scene: Scene) -> Watch:
        world.settle()
        return Watch(world, {o.id: o for o in self._context.objects(scene)})

    def _seen(self, world: World) -> NDArray[np.uint8]:
        """(C, H, W, 3) pictures of now."""
        cameras = robot_cameras(world)
        return np.stack([small(shoot(world, cameras[name]), self._view) for name in self._view.cameras])


class _Trial:
    """One attempt at a task.

    Args:
        world: where it happens.
        watch: of it, since it began.
        subtasks: what is to be done.
        fps: actions per second.

    Attributes:
        outcome: until now.
    """

    def __init__(self, world: World, watch: Watch, subtasks: Sequence[Subtask], fps: float):
        self._world, self._watch, self._fps = world, watch, fps
        self._moved = [subtask.object for subtask in subtasks]
        self._goals = [goal for subtask in subtasks for goal in subtask.goals]
        self._now = _state(world)
        self.outcome = Outcome(touched=False, lifted=False, done=False)

    def carry_out(self, actions: NDArray[np.float32]) -> None:
        """Drive to each action in turn, in a straight line."""
        steps = round(PHYSICS_HZ / self._fps)
        for now, then in pairwise([self._now, *actions]):
            for step in range(1, steps + 1):
                command(self._world.arms, now + (then - now) * (step / steps), (then - now) * self._fps)
                self._world.step()
            self._now = then
            self._look()

    def _look(self) -> None:
        """True if all goals hold and no hand touches a moved object any more."""
        world, watch = self._world, self._watch
        touching = {name.partition("/")[0] for thing in self._moved for name in world.touching(thing)}
        touched = not touching.isdisjoint(world.arms)
        lifted = any(
            world.object_pose(thing).p[2] > watch.began[thing].pose.p[2] + LIFTED
            for thing in self._moved
            if any(world.holds(arm, thing) for arm in world.arms)
        )
        done = not touched and goals_hold(self._goals, watch).success
        self.outcome = Outcome(self.outcome.touched or touched, self.outcome.lifted or lifted, done)


def command(arms: Mapping[str, ArmControl], action: NDArray[np.float32], rate: NDArray[np.float32]) -> None:
    """Tell every arm its part of an action (D,), passing at a rate per second."""
    first = 0
    for arm in arms.values():
        last = first + len(arm.qpos)
        arm.command_joints(action[first : last - 1].astype(np.float64), rate[first : last - 1].astype(np.float64))
        arm.command_gripper(float(np.clip(action[last - 1], 0, 1)))
        first = last


def _state(world: World) -> NDArray[np.float32]:
    return np.concatenate([arm.qpos for arm in world.arms.values()]).astype(np.float32)
