"""The expert: the scripts that collected the run's data, without a critic or another attempt."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from vcage.episodes.beginnings import Beginnings
from vcage.episodes.starts import Start
from vcage.evaluation.episode_start import EpisodeStart
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Subtask
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.tasks.loop import EpisodeRun, run_episode
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.setting import Seen, Setting
from vcage.tasks.slots import Slot
from vcage.tasks.synthesis import Script, script_of
from vcage.tasks.task import Asked


def expert_episode(start: EpisodeStart, beginnings: Beginnings, fps: int) -> EpisodeRun:
    """Let the expert do the task from a drawn start; the simulator's state alone judges.

    Args:
        start: with the grasps and slots that were found for it.
        beginnings: of the task.
        fps: frames per second of the recording.
    """
    chain = [(subtask, script_of(subtask)) for subtask in beginnings.subtasks]
    return play(start, chain, beginnings.goals, fps, offsets=start.drawn.world.start)


def play(
    start: EpisodeStart | Start,
    chain: Sequence[tuple[Subtask, Script]],
    goals: Sequence[Goal],
    fps: int,
    *,
    seed: int = 0,
    offsets: Mapping[str, Sequence[float]] | None = None,
) -> EpisodeRun:
    """Run one episode of a chain, which ends at its first failed step by the simulator's state.

    Args:
        start: with the grasps and slots that were found for it.
        chain: sub-tasks with their scripts.
        goals: what must be true at the end.
        fps: frames per second of the recording.
        seed: of the choices that are left.
        offsets: arm → offset of each joint from home at the start, radians; at home where not given.
    """
    for subtask, script in chain:
        script.try_grasps(start.grasps[subtask.id])
    robot = load_robot(start.scene.robot)
    build = partial(World.of_scene, start.scene, start.models, robot)
    setting = unwatched(build, start.objects, start.slots, fps, offsets)
    return run_episode(setting, chain, seed, goals)


def unwatched(
    build: Callable[[], World],
    objects: Mapping[str, SceneObject],
    slots: Mapping[str, Slot],
    fps: int,
    offsets: Mapping[str, Sequence[float]] | None = None,
) -> Setting:
    """The setting of an episode that no critic looks at: the simulator's state alone judges, and nothing is retried.

    Args:
        build, objects, slots, fps, offsets: see :class:`~vcage.tasks.setting.Setting`; the last is its ``start``.
    """
    return Setting(
        build=build,
        objects=objects,
        slots=slots,
        photograph=lambda *_: {},
        judge=_unseen,
        accept="state",
        on_failure="abort",
        retries=0,
        fps=fps,
        start=offsets or {},
    )


def _unseen(_asked: Asked, _subtask: Subtask, _seen: Seen) -> Verdict:
    return Verdict(accepted=True, reason="no critic looks on", confidence=0.0, provider="none")
