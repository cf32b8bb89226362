"""Stage 6: let the robot carry out the chain, verify every step, record what was accepted.

Episodes gather in ``episodes.collecting/`` and become ``episodes/`` when there are enough; after each one the
folder is complete as far as it goes, so a killed collection goes on with the next episode.
"""

from __future__ import annotations

import logging
import os
import platform
import shutil
from collections.abc import Iterator, Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from vcage import __version__
from vcage.assets.textures.tables import TABLES, table_texture
from vcage.dataset.hdf5 import write_episode
from vcage.episodes.assemble import episode_data
from vcage.episodes.loop import EpisodeRun, Setting, run_episode
from vcage.episodes.task import Asked
from vcage.episodes.variation import shifted_poses
from vcage.errors import DamagedFile, InputFileError, PartlyDone
from vcage.files import PARTIAL, RunFolder, atomic_folder, recover, write_text
from vcage.geometry import Pose
from vcage.pipeline.judging import TOP, background_name, critic_question
from vcage.pipeline.pictures import write_picture
from vcage.pipeline.progress import Progress, silent
from vcage.pipeline.settings import Settings
from vcage.pipeline.stage import Job, StageResult, stage_seed
from vcage.pipeline.workbench import Workbench
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
from vcage.subtasks.search import slots_for_chain
from vcage.subtasks.synthesis import Script, load_script

log = logging.getLogger(__name__)

RUNS_PER_EPISODE = 3
"""Episodes that are tried for each that is wanted, before the collection gives up."""


def job(run: RunFolder, settings: Settings, bench: Workbench) -> Job:
    """What the stage has to do; the number of episodes is left out, as more can be added later."""
    scripts = []
    if run.subtasks.exists():
        record = Subtasks.read(run.subtasks)
        scripts = [run.root / s.script for s in record.kept if s.id in record.chain]
    return Job(
        run=run,
        output=run.episodes,
        inputs=[run.layout, run.subtasks, *scripts],
        seed=stage_seed(run, settings.seed),
        options={"on_failure": settings.on_failure, "retries": settings.retries, "fps": settings.fps},
        providers=bench.models.providers("critic"),
    )


def summary(record: Episodes) -> dict[str, Any]:
    """A few facts for whoever ran the stage."""
    return {
        "accepted": sum(e.accepted for e in record.episodes),
        "rejected": sum(not e.accepted for e in record.episodes),
        "attempts": record.attempts,
        "critic": record.critic,
    }


def execute(run: RunFolder, settings: Settings, bench: Workbench, progress: Progress = silent) -> StageResult[Episodes]:
    """Write ``episodes/``: one HDF5 per accepted episode, the log of all attempts, the rejected ones as states.

    Raises:
        MissingStage, StaleStage: see :class:`vcage.pipeline.stage.Job`.
        PartlyDone: no episode was accepted.
    """
    stage = job(run, settings, bench)
    stage.provenance()
    done = stage.finished(Episodes, force=settings.force)
    if done is not None and _accepted(done.record.episodes) >= settings.episodes:
        return done
    gathering = _Gathering(stage, Path(f"{run.episodes.parent}.collecting"))
    gathering.begin(done)
    collection = _Collection(stage, settings, bench)
    limit = RUNS_PER_EPISODE * settings.episodes
    while (have := _accepted(gathering.episodes)) < settings.episodes and len(gathering.episodes) < limit:
        progress(f"episode {len(gathering.episodes)}", have, settings.episodes)
        gathering.add(*collection.one(len(gathering.episodes), gathering.folder))
    record = gathering.finish()
    accepted = _accepted(record.episodes)
    if accepted == 0:
        raise PartlyDone(
            f"none of {len(record.episodes)} episodes was verified: {record.episodes[-1].reason}",
            hint=f"see {run.episodes.parent / 'log.jsonl'}; another --seed gives another layout",
        )
    if accepted < settings.episodes:
        log.warning("only %d of %d episodes were verified in %d runs", accepted, settings.episodes, limit)
    return StageResult(record, run.episodes, fresh=True)


def _accepted(episodes: Sequence[Episode]) -> int:
    return sum(episode.accepted for episode in episodes)


# --- one episode after the other -----------------------------------------------------------------------


class _Collection:
    """What all episodes of a collection share."""

    def __init__(self, stage: Job, settings: Settings, bench: Workbench):
        run = stage.run
        self._stage, self._settings, self._bench = stage, settings, bench
        self._scene = Scene.read(run.layout)
        self._robot = load_robot(self._scene.robot)
        self._models = bench.physical_models(self._scene)
        subtasks = Subtasks.read(run.subtasks)
        kept = {s.id: s for s in subtasks.kept}
        self._chain: list[tuple[Subtask, Script]] = [
            (kept[i], load_script(run.root / kept[i].script)) for i in subtasks.chain
        ]

    def one(self, index: int, folder: Path) -> tuple[Episode, list[Attempt]]:
        """Run an episode and write its files."""
        rng = np.random.default_rng([self._stage.seed, index])
        objects = self._bench.objects(self._scene)
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
            judge=lambda *asked: self._judge(*asked, background),
            on_failure=self._settings.on_failure,
            retries=self._settings.retries,
            fps=self._settings.fps,
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
        picture = self._photograph(drawn, WorldState(away, state.joints))[TOP]
        drawn.set_state(state)
        return picture

    def _judge(
        self, asked: Asked, before: Mapping[str, np.ndarray], after: Mapping[str, np.ndarray], background: np.ndarray
    ) -> Verdict:
        question = critic_question(self._scene, self._bench, asked.text, asked.goals, before, after, background)
        return self._bench.models.critic.judge(question)

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
            fps=self._settings.fps,
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
            "providers": self._bench.models.providers("reasoner", "editor", "detector", "embedder", "critic"),
            "versions": versions(),
        }


def versions() -> dict[str, str]:
    """What made the data."""
    packages = ("sapien", "mani_skill", "mplib", "numpy")
    return {"vcage": __version__, "python": platform.python_version(), **{p: metadata.version(p) for p in packages}}


# --- the folder ----------------------------------------------------------------------------------------


class _Gathering:
    """The folder in which episodes gather; whole after every episode."""

    def __init__(self, stage: Job, folder: Path):
        self.folder = folder
        self.episodes: list[Episode] = []
        self._attempts: list[Attempt] = []
        self._stage = stage

    @property
    def _index(self) -> Path:
        return self.folder / self._stage.output.name

    def begin(self, done: StageResult[Episodes] | None) -> None:
        """Go on with a killed collection of the same provenance, or with a finished one, or start anew."""
        recover(self.folder)
        if self._go_on():
            log.info("collect: going on with the episodes of a run that was interrupted")
            return
        self._stage.run.make()
        shutil.rmtree(self.folder, ignore_errors=True)
        with atomic_folder(self.folder) as folder:
            if done is not None:
                shutil.copytree(done.path.parent, folder, copy_function=os.link, dirs_exist_ok=True)
        if done is not None:
            self._load()

    def _go_on(self) -> bool:
        """Take up what a killed collection left, if it is whole and was made in the same way."""
        if not self._index.exists():
            return False
        for part in sorted(self.folder.rglob(f"*{PARTIAL}*")):  # what was being written when it was killed
            part.unlink()
        try:
            if Episodes.read(self._index).provenance != self._stage.provenance():
                return False
            self._load()
        except InputFileError as error:
            log.warning("collect: starting anew, as an interrupted run left what cannot be read: %s", error)
            return False
        return True

    def _load(self) -> None:
        episodes, attempts = Episodes.read(self._index).episodes, read_log(self.folder)
        self.episodes = list(episodes)
        self._attempts = [a for a in attempts if a.episode < len(episodes)]

    def add(self, episode: Episode, attempts: Sequence[Attempt]) -> None:
        """Note an episode whose files are written; the index is written last, as it makes the episode count."""
        self.episodes.append(episode)
        self._attempts += attempts
        lines = [attempt.model_dump_json() + "\n" for attempt in self._attempts]
        write_text(self.folder / "log.jsonl", "".join(lines))
        self._record().write(self._index)

    def finish(self) -> Episodes:
        """Make the folder the stage's output."""
        final = self._stage.output.parent
        record = self._record()
        old = final.with_name(f"{final.name}.replaced-{os.getpid()}")
        if final.exists():
            os.replace(final, old)
        os.replace(self.folder, final)
        shutil.rmtree(old, ignore_errors=True)
        return record

    def _record(self) -> Episodes:
        scene = Scene.read(self._stage.run.layout)
        return Episodes(
            provenance=self._stage.provenance(),
            instruction=scene.instruction,
            chain=Subtasks.read(self._stage.run.subtasks).chain,
            episodes=self.episodes,
            attempts=len(self._attempts),
            acceptance=acceptance(self._attempts),
            critic=confusion(self._attempts),
        )


def read_log(folder: Path) -> list[Attempt]:
    """The attempts of ``log.jsonl``, in order; none when there is no log.

    Raises:
        DamagedFile: a line is not an attempt.
    """
    path = folder / "log.jsonl"
    try:
        lines = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
        return [Attempt.model_validate_json(line) for line in lines]
    except ValueError as error:
        raise DamagedFile(f"{path} is damaged: {error}", hint="run collect --force") from error


def acceptance(attempts: Sequence[Attempt]) -> dict[str, dict[str, int]]:
    """Asset/variant → how many attempts there were, and how many were accepted."""
    counts: dict[str, dict[str, int]] = {}
    for attempt in sorted(attempts, key=lambda a: (a.asset, a.variant)):
        entry = counts.setdefault(f"{attempt.asset}/{attempt.variant}", {"accepted": 0, "attempts": 0})
        entry["accepted"] += attempt.accepted
        entry["attempts"] += 1
    return counts


def confusion(attempts: Sequence[Attempt]) -> dict[str, int]:
    """The critic against the simulator's truth, over the attempts that were judged."""
    judged = [(a.verdict.accepted, a.truth.success) for a in attempts if a.verdict is not None and a.truth is not None]
    return {
        "judged": len(judged),
        "true_accepted": sum(said and is_so for said, is_so in judged),
        "false_accepted": sum(said and not is_so for said, is_so in judged),
        "false_refused": sum(not said and is_so for said, is_so in judged),
        "true_refused": sum(not said and not is_so for said, is_so in judged),
    }
