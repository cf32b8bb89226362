"""The folder of a running collection, which continues a killed one; and the counts of a collection."""

from __future__ import annotations

import logging
import os
import shutil
from collections.abc import Sequence
from pathlib import Path

from pydantic import ValidationError

from vcage.base.errors import DamagedFile, InputFileError, MissingStage
from vcage.base.files import atomic_folder, link_or_copy, write_text
from vcage.base.keeper import Keeper
from vcage.base.leftovers import PARTIAL, REPLACED, recover
from vcage.base.reading import Unreadable, text_of
from vcage.runs.edits import seal
from vcage.runs.stage import Job, StageResult
from vcage.schema.episodes import Attempt, CriticCounts, Episode, Episodes
from vcage.schema.scene import Scene
from vcage.tasks.templates import read_subtasks

logger = logging.getLogger(__name__)


class EpisodeStore:
    """The folder in which episodes gather; whole after every episode.

    Args:
        stage: the collection; the folder becomes its output.
        folder: beside the output.
    """

    def __init__(self, stage: Job, folder: Path):
        self.folder, self.run = folder, stage.run
        self.episodes: list[Episode] = []
        self._attempts: list[Attempt] = []
        self._edited: list[str] = []
        self._stage = stage

    @property
    def _index(self) -> Path:
        return self.folder / self._stage.output.name

    def begin(self, done: StageResult[Episodes] | None) -> None:
        """Continue a killed collection of the same provenance, or a finished one, or start an empty one."""
        recover(self.folder)
        if self._go_on():
            logger.info("collect: continuing an interrupted collection")
            return
        self.run.make()
        shutil.rmtree(self.folder, ignore_errors=True)
        with atomic_folder(self.folder) as folder:
            if done is not None:
                shutil.copytree(done.path.parent, folder, copy_function=link_or_copy, dirs_exist_ok=True)
        if done is not None:
            self._load()

    def _go_on(self) -> bool:
        """Load the leftovers of a killed collection; False if they are damaged or of another provenance."""
        keeper = Keeper(self._index, Episodes, self._stage.provenance())
        try:
            if not keeper.knows(keeper.found()):
                return False
            for part in sorted(self.folder.rglob(f"*{PARTIAL}*")):  # being written when it was killed
                part.unlink()
            self._load()
        except MissingStage:
            return False
        except InputFileError as error:
            logger.warning("collect: starting again, as the files of the interrupted run cannot be read: %s", error)
            return False
        return True

    def _load(self) -> None:
        record, attempts = Episodes.read(self._index), read_log(self.folder)
        self.episodes, self._edited = list(record.episodes), record.edited
        known = {episode.index for episode in self.episodes}
        self._attempts = [a for a in attempts if a.episode in known]

    def add(self, episode: Episode, attempts: Sequence[Attempt]) -> None:
        """Add an episode whose files are written; the index is written last, since it makes the episode count."""
        self.episodes = sorted([*self.episodes, episode], key=lambda one: one.index)
        self._attempts = sorted([*self._attempts, *attempts], key=lambda one: one.episode)
        lines = [attempt.model_dump_json() + "\n" for attempt in self._attempts]
        write_text(log_path(self.folder), "".join(lines))
        self._record().write(self._index)

    def finish(self) -> Episodes:
        """Make the folder the stage's output."""
        final = self._stage.output.parent
        record = seal(self._record(), self._index)
        old = final.with_name(f"{final.name}{REPLACED}{os.getpid()}")
        if final.exists():
            os.replace(final, old)
        os.replace(self.folder, final)
        shutil.rmtree(old, ignore_errors=True)
        return record

    def _record(self) -> Episodes:
        scene = Scene.read(self.run.layout)
        return Episodes(
            provenance=self._stage.provenance(),
            edited=self._edited,
            instruction=scene.instruction,
            chains=read_subtasks(self.run.subtasks).chains,
            episodes=self.episodes,
            accept=self._stage.options["accept"],
            attempts=len(self._attempts),
            acceptance=acceptance(self._attempts),
            critic=confusion(self._attempts),
        )


def background_name(episode: int) -> str:
    """Return the name of an episode's picture of the empty table, from the folder of the episodes."""
    return f"critic/e{episode:06d}-background-top.png"


def log_path(folder: Path) -> Path:
    """Return the path of the log of all attempts in a folder of episodes."""
    return folder / "log.jsonl"


def read_log(folder: Path) -> list[Attempt]:
    """Read the attempts of ``log.jsonl``, in order; none if there is no log.

    Raises:
        DamagedFile: a line is not an attempt.
    """
    path = log_path(folder)
    try:
        text = text_of(path.read_bytes()) if path.is_file() else ""
    except Unreadable as error:
        raise DamagedFile(f"{path} is no text: {error}", maker="collect") from error
    lines = enumerate(text.split("\n"), start=1)  # an attempt's words may hold other line ends of Unicode
    return [_attempt(line, f"{path}, line {number}") for number, line in lines if line.strip()]


def _attempt(line: str, where: str) -> Attempt:
    try:
        return Attempt.model_validate_json(line)
    except ValidationError as error:
        first = error.errors()[0]
        field = ".".join(map(str, first["loc"])) or "(whole line)"
        raise DamagedFile(f"{where}: field {field}: {first['msg']}", hint="fix it", maker="collect") from error


def acceptance(attempts: Sequence[Attempt]) -> dict[str, dict[str, int]]:
    """Count attempts and accepted ones by asset/variant."""
    counts: dict[str, dict[str, int]] = {}
    for attempt in sorted(attempts, key=lambda a: (a.asset, a.variant)):
        entry = counts.setdefault(f"{attempt.asset}/{attempt.variant}", {"accepted": 0, "attempts": 0})
        entry["accepted"] += attempt.accepted
        entry["attempts"] += 1
    return counts


def confusion(attempts: Sequence[Attempt]) -> CriticCounts:
    """Count the critic's verdicts against the simulator's truth, over the judged attempts."""
    judged = [a for a in attempts if a.verdict is not None and a.truth is not None]
    return CriticCounts.of((a.verdict.accepted, a.truth.success) for a in judged)  # pyrefly: ignore
