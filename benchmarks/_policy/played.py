"""States of episodes that the scripts of a run play, without pictures: the fastest demonstrations.

An episode of a number is the same whether it is kept for its success or not: data without a critic is
all of them, verified data those that the simulator's state accepts. An attempt that its script ends by itself
(no way, nothing between the fingers) ends its episode.
"""

from __future__ import annotations

import gc
import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks._policy.demonstrations import Demonstrations
from vcage.base.errors import InfeasibleScene, TooFewVerified
from vcage.base.files import RunFolder, atomic_path
from vcage.base.memory import forget
from vcage.base.workers import map_in_processes
from vcage.datasets.environment_state import StateLayout
from vcage.datasets.episode import state_names
from vcage.episodes.beginnings import Beginnings
from vcage.evaluation.expert import unwatched
from vcage.runs.context import StageContext
from vcage.runs.inputs import state_layout
from vcage.runs.stage import stage_seed
from vcage.sim.robots import load_randomisation
from vcage.sim.world import World
from vcage.tasks.assemble import episode_data
from vcage.tasks.loop import EpisodeRun, run_episode
from vcage.tasks.synthesis import script_of

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class PlayedSettings:
    """Settings of played episodes.

    Args:
        fps: frames per second, as collecting records them.
        most_played: episodes that are played, at most, for each that is wanted.
    """

    fps: int = 10
    most_played: int = 6


SETTINGS = PlayedSettings()


@dataclass(frozen=True)
class Played:
    """An episode: T frames.

    Args:
        states, objects, actions, steps: as of :class:`Demonstrations`.
        success: every sub-task was done, and all goals hold at the end, by the simulator's state.
    """

    states: NDArray[np.float64]
    objects: NDArray[np.float64]
    actions: NDArray[np.float64]
    steps: NDArray[np.int64]
    success: bool


def played(run: RunFolder, numbers: Sequence[int], folder: Path, workers: int = 1) -> list[Played]:
    """The episodes of these numbers that have a start; those that the folder holds are not played again.

    Args:
        run: with a layout and sub-tasks.
        numbers: of episodes, as collecting numbers them.
        folder: where they are kept.
        workers: processes.
    """
    missing = [number for number in numbers if not _file(folder, number).exists()]
    for number in map_in_processes(partial(_play, run.root, folder), missing, workers):
        logger.info("episode %d is played", number)
    read = (_read(_file(folder, number)) for number in numbers)
    return [episode for episode in read if len(episode.states)]


def demonstrations(run: RunFolder, episodes: int, verified: bool, folder: Path, workers: int = 1) -> Demonstrations:
    """So many played episodes, one after the other.

    Args:
        run: with a layout and sub-tasks.
        episodes: their number.
        verified: only those that succeed.
        folder: where they are kept.
        workers: processes.

    Raises:
        TooFewVerified: fewer than one in :attr:`PlayedSettings.most_played` succeeds.
    """
    found, numbers = list[Played](), range(0)
    while len(found) < episodes:
        if numbers.stop > SETTINGS.most_played * episodes:
            raise TooFewVerified(f"of {numbers.stop} episodes that were played, {len(found)} can be used")
        numbers = range(numbers.stop, numbers.stop + episodes - len(found))
        found += [one for one in played(run, numbers, folder, workers) if one.success or not verified]
    return joined(run, found, StageContext("offline"))


def longest_success(run: RunFolder, episodes: int, folder: Path, workers: int = 1) -> int:
    """Frames of the longest of the first so many episodes that succeeds; see :func:`demonstrations`.

    Raises:
        TooFewVerified: none succeeds.
    """
    lengths = [len(one.states) for one in played(run, range(episodes), folder, workers) if one.success]
    if not lengths:
        raise TooFewVerified(f"of {episodes} episodes that were played, none succeeds")
    return max(lengths)


def joined(run: RunFolder, episodes: Sequence[Played], context: StageContext) -> Demonstrations:
    """Episodes one after the other."""
    beginnings = _beginnings(run.root, context)
    arms = {name: len(arm.home) for name, arm in beginnings.robot.arms.items()}
    return Demonstrations(
        states=np.concatenate([episode.states for episode in episodes]),
        objects=np.concatenate([episode.objects for episode in episodes]),
        actions=np.concatenate([episode.actions for episode in episodes]),
        steps=np.concatenate([episode.steps for episode in episodes]),
        ends=np.cumsum([len(episode.states) for episode in episodes]),
        names=tuple(state_names(arms)),
        object_names=tuple(state_layout(run, context).names),
    )


def _file(folder: Path, number: int) -> Path:
    return folder / f"{number:06d}.npz"


def _read(path: Path) -> Played:
    with np.load(path) as kept:
        return Played(kept["states"], kept["objects"], kept["actions"], kept["steps"], bool(kept["success"]))


def _play(root: Path, folder: Path, number: int) -> int:
    """Play an episode and write it; one without a start has no frames."""
    beginnings, layout = _shared(root)
    seed = stage_seed(RunFolder(root), None)
    try:
        done = _episode(beginnings, number, seed)
        data = episode_data(done.log, done.segments, {}, {})
        steps = np.searchsorted([segment.end for segment in data.segments], np.arange(data.frames), side="right")
        rows = {"states": data.qpos, "objects": layout.of_episode(data), "actions": data.action, "steps": steps}
        success = done.accepted and all(a.truth is not None and a.truth.success for a in done.attempts)
        success = success and done.goals_hold is not None and done.goals_hold.success
        if not success:
            logger.info("episode %d fails: %s", number, done.reason)
    except InfeasibleScene as error:
        logger.info("episode %d: %s", number, error.message)
        rows, success = dict.fromkeys(("states", "objects", "actions", "steps"), np.empty(0)), False
    finally:
        forget()
        gc.collect()  # worlds contain reference cycles
    with atomic_path(_file(folder, number)) as part:
        np.savez(part, success=success, **rows)
    return number


def _episode(beginnings: Beginnings, number: int, seed: int) -> EpisodeRun:
    """Play the scripts from the start of a number; a failure that no script notices ends nothing."""
    start = beginnings.draw(np.random.default_rng([seed, number])).start
    chain = [(subtask, script_of(subtask)) for subtask in beginnings.subtasks]
    for subtask, script in chain:
        script.try_grasps(start.grasps[subtask.id])
    build = partial(World.of_scene, start.scene, start.models, beginnings.robot)
    setting = unwatched(build, start.objects, start.slots, SETTINGS.fps, start.world.start)
    return run_episode(replace(setting, accept="critic"), chain, number, beginnings.goals)


@lru_cache(maxsize=1)
def _shared(root: Path) -> tuple[Beginnings, StateLayout]:
    context = StageContext("offline")
    return _beginnings(root, context), state_layout(RunFolder(root), context)


def _beginnings(root: Path, context: StageContext) -> Beginnings:
    return Beginnings.of_run(RunFolder(root), load_randomisation("light"), context)[0]
