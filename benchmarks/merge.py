"""Seconds, CPU seconds and memory of a merge as the number of episodes grows, and of adding one run to all others."""

from __future__ import annotations

import argparse
import logging
import multiprocessing
import re
import statistics
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks._merge_runs import RunSpec, make_run
from vcage.base.workers import cores

logger = logging.getLogger(__name__)

PER_RUN = 5
"""Episodes of a run, as a campaign's jobs have."""

FRAMES, CAMERAS = 10, ("cam_high",)

ONE_MORE = 5
"""Runs that are added one by one to the data set of all others."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of this benchmark."""
    sizes = [500, 1000, 2000, 3000]
    parser.add_argument(
        "--episodes", type=int, nargs="+", default=sizes, help="sizes (default: %(default)s; quick: 50 100)"
    )
    parser.add_argument("--format", default="lerobot-v3.0", help="of the data set (default: %(default)s)")


def run(quick: bool, episodes: list[int], format: str) -> dict[str, Any]:
    """Merge runs of five episodes with one camera of 64 by 48 pixels and 10 frames, each size in a new process.

    Figures of each row:

    - ``seconds`` and ``cpu_seconds``, in all and per 1,000 episodes;
    - ``peak_mb``, the largest memory of the process, and ``start_mb`` before it reads anything;
    - ``mb`` of the data set without its videos, which are links;
    - ``again_s``, the same merge once more, which adds nothing; ``one_more_s``, the median of adding one run.

    Args:
        quick: two small sizes.
        episodes: the sizes.
        format: of the data set.
    """
    rows, sizes = [], [50, 100] if quick else sorted(episodes)
    with tempfile.TemporaryDirectory() as folder:
        runs, started = Path(folder) / "runs", time.perf_counter()
        _make(runs, range(-(-sizes[-1] // PER_RUN)))
        made_s = time.perf_counter() - started
        for size in sizes:
            rows.append(_row(Path(folder), runs, size, format))
            logger.info("%s", rows[-1])
    made = {"seconds": round(made_s, 1), "per_episode_ms": round(1e3 * made_s / sizes[-1], 1)}
    return {"rows": rows, "format": format, "cores": cores(), "made": made}


def _make(folder: Path, seeds: range) -> None:
    with ProcessPoolExecutor(cores(), multiprocessing.get_context("spawn")) as pool:
        list(pool.map(_make_one, [folder / f"{seed:05d}" for seed in seeds], seeds, chunksize=20))


def _make_one(folder: Path, seed: int) -> None:
    make_run(folder, RunSpec(seed=seed, episodes=PER_RUN, frames=FRAMES, cameras=CAMERAS))


@dataclass(frozen=True)
class _Spent:
    wall_s: float
    cpu_s: float
    start_mb: float
    peak_mb: float


def _row(folder: Path, runs: Path, size: int, version: str) -> dict[str, Any]:
    out, more = folder / f"data-{size}", folder / f"more-{size}"
    chosen = sorted(runs.iterdir())[: size // PER_RUN]
    whole, again = (_in_a_process(chosen, out, version) for _ in range(2))
    held = sum(file.stat().st_size for file in out.rglob("*") if file.is_file() and file.suffix != ".mp4")
    _make(more, range(10**6, 10**6 + ONE_MORE))
    added = [_in_a_process([run], out, version) for run in sorted(more.iterdir())]
    return {
        "episodes": size,
        "seconds": round(whole.wall_s, 1),
        "cpu_seconds": round(whole.cpu_s, 1),
        "seconds_per_1000": round(1e3 * whole.wall_s / size, 1),
        "cpu_seconds_per_1000": round(1e3 * whole.cpu_s / size, 1),
        "start_mb": round(whole.start_mb),
        "peak_mb": round(whole.peak_mb),
        "mb": round(held / 1e6, 1),
        "again_s": round(again.wall_s, 2),
        "one_more_s": round(statistics.median(one.wall_s for one in added), 2),
    }


def _in_a_process(folders: list[Path], out: Path, version: str) -> _Spent:
    """Merge in a process of its own, whose imports are not counted."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        return pool.submit(_merge, folders, out, version).result()


def _merge(folders: list[Path], out: Path, version: str) -> _Spent:
    from vcage.campaigns.merge import Order, merge

    start_mb, wall, cpu = _memory("VmRSS"), time.perf_counter(), time.process_time()
    merge(folders, out, Order(formats=(version,)))
    return _Spent(time.perf_counter() - wall, time.process_time() - cpu, start_mb, _memory("VmHWM"))


def _memory(name: str) -> float:
    """Memory of this process by its name in ``/proc``, MB."""
    found = re.search(rf"^{name}:\s+(\d+) kB$", Path("/proc/self/status").read_text(), re.MULTILINE)
    assert found is not None, f"/proc/self/status does not say {name}"
    return int(found[1]) * 1024 / 1e6
