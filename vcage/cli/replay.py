"""``vcage replay``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from vcage.base.options import FOLDER
from vcage.cli.arguments import Command
from vcage.cli.output import Result
from vcage.cli.progress import progress


@dataclass(frozen=True, kw_only=True)
class Replay(Command):
    """Simulate a recorded episode again from its file alone, and compare: states and pictures, bit for bit.

    EPISODE is an HDF5 file of a run, a rejected one too, or a run folder, of which all accepted episodes are replayed.
    Says the first frame that differs, what and by how much, and which versions differ; then the exit code is 9.

    examples:
      vcage replay runs/stationery/episodes/episode_000000.hdf5
      vcage replay runs/stationery
    """

    path: Annotated[Path, FOLDER, Positional, arg(metavar="EPISODE")]
    """a file, or a run folder"""

    @property
    def run(self) -> Path | None:
        """The run folder, if it is one."""
        return self.path if self.path.is_dir() else None

    def execute(self) -> Result:
        """Replay.

        Raises:
            InputFileError: there is no episode, it is damaged, or it was recorded without what a replay needs.
        """
        from vcage.apps.replay import episodes_at, replay_episode
        from vcage.runs.context import StageContext

        paths, context = episodes_at(self.path), StageContext("offline")
        replayed = {}
        with progress("replay") as show:
            for number, path in enumerate(paths):
                show(path.name, number, len(paths))
                replayed[path] = replay_episode(path, context)
        records = {path.name: one.as_record() for path, one in replayed.items()}
        summary = {"equal": sum(one.equal for one in replayed.values()), "of": len(paths), "episodes": records}
        for path, one in replayed.items():
            if not one.equal:
                return Result(error=one.error(path, summary))
        return Result(summary=summary)
