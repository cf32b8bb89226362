"""Bytes and losses of compressed episodes: ours beside PNG, JPEG in HDF5, LeRobot's AV1, and AV1 and H.264 searched.

The clips are rendered episodes (``benchmarks/_compression_episodes.py``) at 25 frames per second and, apart, some of
them "sparse", with the 10 that a collection has unless more are asked for, and some "noisy", as a real camera would
have recorded them (``benchmarks/_compression_noise.py``). Formats named ``…-gN`` are searched for the fewest
bytes with which all keyframes and the other checked frames lose less than 0.1 JOD; ``N`` is the GOP,
250 the encoders' own default. ``vcage-g2-as-lerobot`` is searched, with LeRobot's GOP, for what LeRobot's default loses
on the same clip. Where AV1, which has no 4:4:4 here, cannot reach 0.1 JOD, it is searched for a little more than what
it loses at its best.

Episodes are rendered once (a quarter of an hour or more) and kept in the user's cache, and so are results, by clip and
format, until the code that makes them changes: an interrupted run goes on where it was.
"""

from __future__ import annotations

import argparse
import logging
import os
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from benchmarks._compression_clips import Clip, clips
from benchmarks._compression_curve import Point, curve, draw
from benchmarks._compression_episodes import episode_path
from benchmarks._compression_formats import Format, formats
from benchmarks._compression_measures import Measured, measure_clip
from benchmarks._compression_rows import rows
from benchmarks._efforts import effort_formats, effort_rows
from vcage.base.workers import map_in_processes

logger = logging.getLogger(__name__)

T = TypeVar("T")

WORKERS = 2
"""Clips at a time, each in a process of its own and with encoders of one thread."""

PLOT = Path("build/compression.png")


@dataclass(frozen=True)
class Job:
    """A clip to be measured in formats, or, where they are None, to get its curve."""

    clip: Clip
    formats: Sequence[Format] | None = None


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The benchmark's own options."""
    parser.add_argument("--efforts", action="store_true", help="compare the efforts of each codec instead")
    parser.add_argument("--plot", type=Path, help=f"draw the curves here (default: {PLOT}, and none with --quick)")


def run(quick: bool, plot: Path | None = None, efforts: bool = False) -> dict[str, Any]:
    """Rows (see :func:`benchmarks._compression_rows.rows`), and the points of the curves of bytes against loss.

    Args:
        quick: the beginnings of two episodes, no noisy clips, and no other GOPs than the project's and LeRobot's; no
            curves unless ``plot`` is given.
        plot: picture of the curves, of the first clip and the last.
        efforts: rows of :func:`benchmarks._efforts.effort_rows` instead, of the rendered clips.
    """
    chosen = clips(quick)
    _render(chosen)
    if efforts:
        rendered = [clip for clip in chosen if clip.kind == "rendered"]
        return {"rows": effort_rows(_measured(rendered, effort_formats()))}
    drawn = [] if quick and plot is None else [chosen[0], chosen[-1]]
    figures: dict[str, Any] = {"rows": rows(_measured(chosen, formats(quick)))}
    if drawn:
        line = _points(drawn)
        logger.info("curves: %s", draw(line, plot or PLOT))
        figures["curves"] = [vars(point) for point in line]
    return figures


def _measured(chosen: Sequence[Clip], wanted: Sequence[Format]) -> list[Measured]:
    """Clips in formats, in the order of the clips."""
    found = _results([Job(clip, wanted) for clip in chosen])
    return [one for clip in chosen for one in found[clip.name] if isinstance(one, Measured)]


def _points(chosen: Sequence[Clip]) -> list[Point]:
    """The points of the curves of clips."""
    found = _results([Job(clip) for clip in chosen])
    return [one for clip in chosen for one in found[clip.name] if isinstance(one, Point)]


def _results(jobs: Sequence[Job]) -> dict[str, list[Measured] | list[Point]]:
    """The name of a clip → what its job measured."""
    return dict(_watched(map_in_processes(_do, jobs, WORKERS), len(jobs)))


def _render(chosen: Sequence[Clip]) -> None:
    """Make the episodes that the cache lacks; in this process, as the renderer takes all cores."""
    recipes = dict.fromkeys(clip.recipe for clip in chosen)
    for number, recipe in enumerate(recipes, start=1):
        logger.info("episode %d of %d: %s", number, len(recipes), episode_path(recipe))


def _do(job: Job) -> tuple[str, list[Measured] | list[Point]]:
    # The process may be a new one, which has no log yet, and in which SVT-AV1 is not silent.
    logging.basicConfig(level=logging.INFO, format="%(message)s", stream=sys.stderr)
    os.environ["SVT_LOG"] = "1"
    if job.formats is None:
        return job.clip.name, curve(job.clip)
    return job.clip.name, measure_clip(job.clip, job.formats)


def _watched(results: Iterable[T], count: int) -> Iterator[T]:
    """The results as they come; the log says how much time the others will take."""
    started = time.perf_counter()
    for done, result in enumerate(results, start=1):
        seconds = time.perf_counter() - started
        left = seconds * (count / done - 1)
        logger.info("%d of %d done: %.0f s so far, about %.0f s left", done, count, seconds, left)
        yield result
