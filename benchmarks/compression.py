"""Bytes and losses of compressed episodes: ours beside PNG, JPEG in HDF5, LeRobot's AV1, and AV1 and H.264 searched.

The clips are rendered episodes (``benchmarks/_compression_episodes.py``) at 25 frames per second and, apart, some of
them "sparse", with the 10 that a collection has unless more are asked for, and some "noisy", as a real camera would
have recorded them (``benchmarks/_compression_noise.py``). Formats named ``…-gN`` are searched for the fewest
bytes with which all keyframes, and the frames that the search checks besides, lose less than 0.1 JOD; ``N`` is the GOP,
250 the encoders' own default. ``vcage-g2-as-lerobot`` is searched, with LeRobot's GOP, for what LeRobot's default loses
on the same clip. Where AV1, which has no 4:4:4 here, cannot reach 0.1 JOD, it is searched for a little more than what
it loses at its best.

Episodes are rendered once (a quarter of an hour or more) and kept in the user's cache, and so are results, by clip and
format, until the code that makes them changes: an interrupted run goes on where it was.
"""

from __future__ import annotations

import argparse
import logging
import multiprocessing
import os
import sys
import time
from collections.abc import Collection, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from itertools import chain
from pathlib import Path
from typing import Any

from benchmarks._compression_clips import Clip, clips
from benchmarks._compression_curve import Point, curve, draw
from benchmarks._compression_episodes import episode_path
from benchmarks._compression_formats import formats
from benchmarks._compression_measures import Measured, measure_clip
from benchmarks._compression_rows import rows

logger = logging.getLogger(__name__)

WORKERS = 2
"""Clips at a time, each in a process of its own and with encoders of one thread."""

PLOT = Path("build/compression.png")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The benchmark's own options."""
    parser.add_argument("--plot", type=Path, help=f"draw the curves here (default: {PLOT}, and none with --quick)")


def run(quick: bool, plot: Path | None = None) -> dict[str, Any]:
    """Rows (see :func:`benchmarks._compression_rows.rows`), and the points of the curves of bytes against loss.

    Args:
        quick: the beginnings of two episodes, no noisy clips, and no other GOPs than the project's and LeRobot's; no
            curves unless ``plot`` is given.
        plot: picture of the curves, of the first clip and the last.
    """
    chosen = clips(quick)
    drawn = [] if quick and plot is None else [chosen[0], chosen[-1]]
    _render(chosen)
    measured: dict[str, list[Measured]] = {}
    points: dict[str, list[Point]] = {}
    with ProcessPoolExecutor(WORKERS, multiprocessing.get_context("spawn"), _begin) as pool:
        jobs: dict[Future, tuple[dict, str]] = {
            pool.submit(measure_clip, clip, formats(quick)): (measured, clip.name) for clip in chosen
        } | {pool.submit(curve, clip): (points, clip.name) for clip in drawn}
        for future in _watched(jobs):
            results, name = jobs[future]
            results[name] = future.result()
    figures: dict[str, Any] = {"rows": rows(chain.from_iterable(measured[clip.name] for clip in chosen))}
    if drawn:
        line = list(chain.from_iterable(points[clip.name] for clip in drawn))
        logger.info("curves: %s", draw(line, plot or PLOT))
        figures["curves"] = [vars(point) for point in line]
    return figures


def _render(chosen: Sequence[Clip]) -> None:
    """Make the episodes that the cache lacks; in this process, as the renderer takes all cores."""
    recipes = dict.fromkeys(clip.recipe for clip in chosen)
    for number, recipe in enumerate(recipes, start=1):
        logger.info("episode %d of %d: %s", number, len(recipes), episode_path(recipe))


def _begin() -> None:
    """What a new process needs: a log, and SVT-AV1 silent but for errors."""
    logging.basicConfig(level=logging.INFO, format="%(message)s", stream=sys.stderr)
    os.environ["SVT_LOG"] = "1"


def _watched(jobs: Collection[Future]) -> Iterator[Future]:
    """The jobs as they finish; the log says how much time the others will take."""
    started = time.perf_counter()
    for done, future in enumerate(as_completed(jobs), start=1):
        seconds = time.perf_counter() - started
        left = seconds * (len(jobs) / done - 1)
        logger.info("%d of %d done: %.0f s so far, about %.0f s left", done, len(jobs), seconds, left)
        yield future
