"""``vcage view``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from tyro.conf import Positional, arg

from vcage.base.options import FOLDER, NATURAL, UNSAID, between
from vcage.cli.arguments import Command
from vcage.cli.output import Result
from vcage.cli.progress import progress

PICTURES = (
    "those of the episode as JPEG; the videos of compress, which with --save a viewer from 0.25 on shows where there "
    "is ffmpeg; or none"
)


@dataclass(frozen=True, kw_only=True)
class ViewEpisode(Command):
    """Look at an episode in the viewer Rerun: pictures, 3D scene, joints, and what was verified, on one timeline.

    EPISODE is an HDF5 file of a run, a run folder, or a recording of others: RoboTwin, ACT, robomimic, LeRobot, a
    folder of pictures.
    Needs an extra: pip install 'vcage[view]'.

    examples:
      vcage view runs/stationery/episodes/episode_000000.hdf5
      vcage view runs/stationery --episode 1 --save look.rrd
      vcage view ~/data/some_lerobot_set --episode 12
    """

    path: Annotated[Path, FOLDER, Positional, arg(metavar="EPISODE")]
    """a file, or a folder that holds episodes"""
    episode: Annotated[int | None, NATURAL, UNSAID] = None
    """which one, where there are several (default: the first)"""
    save: Annotated[Path | None, arg(metavar="FILE.rrd"), UNSAID] = None
    """write a file for the viewer, and do not open it"""
    pictures: Annotated[Literal["stored", "compressed", "none"], arg(help=PICTURES)] = "stored"
    fps: Annotated[float | None, between(0.01, 10000), UNSAID] = None
    """frames per second of a recording that does not say; without, it is shown by frames"""

    def execute(self) -> Result:
        """Show it, or write the file."""
        from vcage.apps.viewer.show import view

        with progress("view") as show:
            shown = view(
                self.path, number=self.episode, save=self.save, footage=self.pictures, fps=self.fps, progress=show
            )
        contents = shown.contents
        summary = {
            "episode": shown.number,
            "of": shown.of,
            "frames": contents.frames,
            "cameras": list(contents.cameras),
            "subtasks": contents.segments,
        }
        return Result(output=self.save, summary=summary, next=f"rerun {self.save}" if self.save else "")
