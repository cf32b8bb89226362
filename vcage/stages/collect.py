"""Let the robot do the task, check every sub-task by looking, keep what is verified, record it.

Reads optimize/ and subtasks/. Writes episodes/*.hdf5, episodes/log.jsonl (every attempt) and episodes/rejected/.
Takes about 20 s per episode without a GPU; goes on where it stopped when run again.

examples:
  vcage collect --run runs/stationery --episodes 10
  vcage collect --run runs/stationery --episodes 10 --on-failure abort --force
"""

from __future__ import annotations

import logging
import platform
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np

from vcage.base.errors import PartlyDone
from vcage.base.files import RunFolder
from vcage.base.geometry import Pose
from vcage.base.options import NATURAL, POSITIVE, UNSAID
from vcage.base.pictures import write_picture
from vcage.base.progress import Progress, silent
from vcage.base.version import __version__
from vcage.datasets.hdf5 import write_episode
from vcage.objects.table_tops import TABLES, table_texture
from vcage.schema.base import PoseRecord
from vcage.schema.episodes import Attempt, Episode, Episodes, Verdict
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask, Subtasks
from vcage.sim.appearance import Appearance
from vcage.sim.cameras import shoot
from vcage.sim.replay import camera_paths, render_log
from vcage.sim.robots import load_robot
from vcage.sim.state import WorldState
from vcage.sim.world import World
from vcage.stages.context import TOP, StageContext
from vcage.stages.episode_store import EpisodeStore, background_name
from vcage.stages.stage import Job, ModelOptions, StageResult, stage_seed
from vcage.tasks.assemble import episode_data
from vcage.tasks.loop import EpisodeRun, Setting, run_episode
from vcage.tasks.slots import slots_for_chain
from vcage.tasks.synthesis import Script, load_script
from vcage.tasks.task import Asked
from vcage.tasks.variation import shifted_poses

logger = logging.getLogger(__name__)

OnFailure = Literal["resample", "abort"]

RUNS_PER_EPISODE = 3
"""Episodes that are tried for each that is wanted, before the collection gives up."""


@dataclass(frozen=True, kw_only=True)
class Options(ModelOptions):
    """How many episodes are collected, and how."""

    episodes: Annotated[int, POSITIVE] = 3
    """accepted episodes to collect"""
    on_failure: Annotated[OnFailure, UNSAID] = "resample"
    """after a failed sub-task: try it again from the verified state before it, or give the episode up"""
    retries: Annotated[int, NATURAL] = 3
    """further attempts per sub-task, when resampling"""
    fps: Literal[5, 10, 25, 50] = 10
    """frames per second of the recording"""


def job(run: RunFolder, options: Options, context: StageContext) -> Job:
    """What the stage has to do; the number of episodes is left out, as more can be added later."""
    scripts = []
    if run.subtasks.exists():
        record = Subtasks.read(run.subtasks)
        scripts = [run.root / s.script for s in record.kept if s.id in record.chain]
    return Job(
        run=run,
        output=run.episodes,
        inputs=[run.layout, run.subtasks, *scripts],
        seed=stage_seed(run, options.seed),
        options={"on_failure": options.on_failure, "retries": options.retries, "fps": options.fps},
        providers=context.models.providers("critic"),
    )


def summary(record: Episodes) -> dict[str, Any]:
    """A few facts for whoever ran the stage."""
    return {
        "accepted": sum(e.accepted for e in record.episodes),
        "rejected": sum(not e.accepted for e in record.episodes),
        "attempts": record.attempts,
        "critic": record.critic,
    }


def execute(
    run: RunFolder, options: Options, context: StageContext, progress: Progress = silent
) -> StageResult[Episodes]:
    """Write ``episodes/``: one HDF5 per accepted episode, the log of all attempts, the rejected ones as states.

    Raises:
        MissingStage, StaleStage: see :class:`vcage.stages.stage.Job`.
        PartlyDone: no episode was accepted.
    """
    stage = job(run, options, context)
    stage.provenance()
    done = stage.finished(Episodes, force=options.force)
    if done is not None and _accepted(done.record.episodes) >= options.episodes:
        return done
    store = EpisodeStore(stage, Path(f"{run.episodes.parent}.collecting"))
    store.begin(done)
    collection = _Collection(stage, options, context)
    limit = RUNS_PER_EPISODE * options.episodes
    while (have := _accepted(store.episodes)) < options.episodes and len(store.episodes) < limit:
        progress(f"episode {len(store.episodes)}", have, options.episodes)
        store.add(*collection.one(len(store.episodes), store.folder))
    record = store.finish()
    accepted = _accepted(record.episodes)
    if accepted == 0:
        raise PartlyDone(
            f"none of {len(record.episodes)} episodes was verified: {record.episodes[-1].reason}",
            hint=f"see {run.episodes.parent / 'log.jsonl'}; another --seed gives another layout",
        )
    if accepted < options.episodes:
        logger.warning("only %d of %d episodes were verified in %d runs", accepted, options.episodes, limit)
    return StageResult(record, run.episodes, fresh=True)


def _accepted(episodes: Sequence[Episode]) -> int:
    return sum(episode.accepted for episode in episodes)


# --- one episode after the other -----------------------------------------------------------------------


class _Collection:
    """What all episodes of a collection share."""

    def __init__(self, stage: Job, options: Options, context: StageContext):
        run = stage.run
        self._stage, self._options, self._context = stage, options, context
        self._scene = Scene.read(run.layout)
        self._robot = load_robot(self._scene.robot)
        self._models = context.physical_models(self._scene)
        subtasks = Subtasks.read(run.subtasks)
        kept = {s.id: s for s in subtasks.kept}
        self._chain: list[tuple[Subtask, Script]] = [
            (kept[i], load_script(run.root / kept[i].script)) for i in subtasks.chain
        ]

    def one(self, index: int, folder: Path) -> tuple[Episode, list[Attempt]]:
        """Run an episode and write its files."""
        rng = np.random.default_rng([self._stage.seed, index])
        objects = self._context.objects(self._scene)
        objects = [o.moved(pose) for o, pose in zip(objects, shifted_poses(objects, rng).values(), strict=True)]
        look = Appearance.random(rng, [table_texture(name) for name in TABLES])
        scene = self._scene.model_copy(
            update={"objects": [o.record.model_copy(update={"pose": PoseRecord.of(o.pose)}) for o in objects]}
        )
        drawn = World.of_scene(scene, self._models, self._robot, look, render=True)
        background = self._empty_table(drawn)
        write_picture(folder / background_name(index), background)
        setting = Setting(
            build=lambda: World.of_scene(scene, self._models, self._robot),
            objects={o.id: o for o in objects},
            slots=slots_for_chain([subtask for subtask, _ in self._chain], objects, rng),
            photograph=lambda state: self._photograph(drawn, state),
            judge=lambda asked, before, after: self._judge(asked, before, after, background),
            on_failure=self._options.on_failure,
            retries=self._options.retries,
            fps=self._options.fps,
        )
        done = run_episode(setting, self._chain, index)
        for name, picture in done.pictures.items():
            write_picture(folder / name, picture)
        return self._write(done, index, drawn, folder), done.attempts

    def _photograph(self, drawn: World, state: WorldState) -> dict[str, np.ndarray]:
        drawn.set_state(state)
        return {TOP: shoot(drawn, self._scene.top_camera)}

    def _empty_table(self, drawn: World) -> np.ndarray:
        """The table in the episode's light with nothing on it, the robot at home."""
        state = drawn.state()
        away = {key: Pose([0.0, 0.0, -9.0 - number]) for number, key in enumerate(state.objects)}
        picture = self._photograph(drawn, WorldState(away, state.joints, state.object_joints))[TOP]
        drawn.set_state(state)
        return picture

    def _judge(
        self, asked: Asked, before: Mapping[str, np.ndarray], after: Mapping[str, np.ndarray], background: np.ndarray
    ) -> Verdict:
        question = self._context.critic_question(
            self._scene, asked.text, asked.goals, before[TOP], after[TOP], background
        )
        return self._context.models.critic.judge(question)

    def _write(self, done: EpisodeRun, index: int, drawn: World, folder: Path) -> Episode:
        """Write the HDF5: with pictures when accepted, states alone when not."""
        name = f"episode_{index:06d}.hdf5" if done.accepted else f"rejected/episode_{index:06d}.hdf5"
        frames = len(done.log)
        if frames:
            cameras = camera_paths(drawn, done.log) if done.accepted else {}
            data = episode_data(done.log, done.segments, cameras, self._facts(index, done))
            pictures: Iterator[Mapping[str, np.ndarray]] = iter([{}] * frames)
            if done.accepted:
                pictures = (frame.pictures for frame in render_log(drawn, done.log))
            write_episode(folder / name, data, pictures)
        return Episode(
            index=index,
            seed=self._stage.seed,
            accepted=done.accepted,
            reason=done.reason,
            file=self._stage.inside(name) if frames else None,
            frames=frames,
            fps=self._options.fps,
            subtasks=[segment.subtask for segment in done.segments],
            verdicts=[segment.verdict for segment in done.segments],
            attempts=len(done.attempts),
        )

    def _facts(self, index: int, done: EpisodeRun) -> dict[str, Any]:
        """What travels inside the episode."""
        return {
            "instruction": self._scene.instruction,
            "seed": self._stage.seed,
            "episode": index,
            "accepted": done.accepted,
            "reason": done.reason,
            "robot": self._scene.robot,
            "scene": self._scene.model_dump(mode="json", by_alias=True),
            "providers": self._context.models.providers("reasoner", "editor", "detector", "embedder", "critic"),
            "versions": versions(),
        }


def versions() -> dict[str, str]:
    """What made the data."""
    packages = ("sapien", "mani_skill", "mplib", "numpy")
    return {"vcage": __version__, "python": platform.python_version(), **{p: metadata.version(p) for p in packages}}
