"""``vcage render``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from tyro.conf import Positional, arg

from vcage.base.commands import vcage_command
from vcage.base.files import RunFolder
from vcage.base.options import FOLDER, NATURAL, POSITIVE, RANGES, UNSAID, natural, png, several, value
from vcage.cli.arguments import Command
from vcage.cli.output import Result
from vcage.cli.progress import progress


@dataclass(frozen=True, kw_only=True)
class RenderEpisodes(Command):
    """Draw the accepted episodes of a run again under other looks: light, surfaces, colours, cameras.

    Nothing is simulated: states, actions and verdicts stay as they are. Reads episodes/. Writes renders/*.hdf5, each
    an episode of its own, renders/renders.json and a page for people, renders/looks.png. What is drawn already is
    kept, so that an interrupted call goes on when started again, and more looks can be added; what was drawn of an
    episode that counts no more, or was recorded anew, is removed.

    examples:
      vcage render runs/stationery --looks 4
      vcage render runs/stationery --looks 20 --randomise full --episodes 0 --sheet looks.png
      vcage compress runs/stationery/renders --out small
    """

    run: Annotated[Path, FOLDER, Positional, arg(metavar="RUN")]
    """the run folder"""
    looks: Annotated[int, POSITIVE] = 1
    """of each episode, at most 1000"""
    randomise: Annotated[str, RANGES] = "full"
    """ranges to draw from: none, light, full, or a YAML file"""
    seed: Annotated[int, NATURAL] = 0
    """of the looks"""
    episodes: Annotated[tuple[int, ...], several("N ...", one=natural), UNSAID] = ()
    """numbers of the episodes (default: all that count)"""
    sheet: Annotated[Path | None, value(png, "PNG"), UNSAID] = None
    """where the page for people goes (default: renders/looks.png)"""
    workers: Annotated[int | None, POSITIVE, UNSAID] = None
    """processes that draw (default: one for each core)"""

    def execute(self) -> Result:
        """Draw."""
        from vcage.base.workers import cores
        from vcage.episodes.rendering import FOLDER as RENDERS
        from vcage.episodes.rendering import INDEX, Order, render_run, write_sheet
        from vcage.runs.running import at_work
        from vcage.sim.robots import load_randomisation

        run, ranges = RunFolder(self.run), load_randomisation(self.randomise)
        order = Order(self.looks, ranges, self.seed, self.episodes, self.workers or cores())
        folder = run.root / RENDERS
        with at_work(run), progress("render") as show:
            record = render_run(run, order, show)
            sheet = write_sheet(run, record, self.sheet or folder / "looks.png")
        summary = {
            "renders": len(record.renders),
            "episodes": len({render.episode for render in record.renders}),
            "frames": sum(render.frames for render in record.renders),
            "sheet": str(sheet),
        }
        goes_on = vcage_command("compress", str(folder), "--out", str(run.root / "renders-compressed"))
        return Result(output=folder / INDEX, schema=record.SCHEMA, summary=summary, next=goes_on)
