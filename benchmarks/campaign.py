"""Verified episodes an hour and CPU seconds for each by drivers of campaigns, and the memory of a worker over many."""

from __future__ import annotations

import argparse
import contextlib
import importlib.util
import logging
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from statistics import mean
from typing import Any

import psutil
import yaml

from benchmarks import _campaign_settled
from benchmarks._campaign_memory import growth
from benchmarks._process_times import Timed, timed
from vcage.base.workers import cores
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.record import JobRecord
from vcage.runs.by_products import read_timings
from vcage.schema.compression import Compression
from vcage.schema.robot import DEFAULT_ROBOT

logger = logging.getLogger(__name__)

INSTRUCTION = "Put two blocks on the plate"

DRIVERS = ("processes", "shards", "ray")
"""Processes of one command, commands of one process each, or actors of one cluster: as many as there are workers."""

SHORT = "Put a block on the plate"
"""Of the worker whose memory is measured."""

CHEAP = {"fps": 5, "crf": 20, "effort": "fast", "keyframes": 2}
"""Options with fewer pictures and no search of a CRF."""

SIZES, QUICK = (12, 5, 300), (2, 1, 6)
"""Jobs, episodes of each, and episodes of the worker whose memory is measured."""

WORKERS = (1, 2)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of this benchmark."""
    parser.add_argument("--robot", default=DEFAULT_ROBOT, help="which one (default: %(default)s)")
    parser.add_argument("--jobs", type=int, help=f"of a campaign; 0: none (default: {SIZES[0]}; quick: {QUICK[0]})")
    parser.add_argument(
        "--episodes", type=int, help=f"episodes of a job (default: {SIZES[1]}; quick: {QUICK[1]})", metavar="N"
    )
    parser.add_argument(
        "--drivers", nargs="+", choices=DRIVERS, default=DRIVERS, help="which (default: all that are installed)"
    )
    parser.add_argument(
        "--workers", type=int, nargs="+", default=WORKERS, help="of each driver (default: %(default)s)", metavar="N"
    )
    parser.add_argument(
        "--memory-episodes",
        type=int,
        help=f"episodes of the worker whose memory is measured; 0: none (default: {SIZES[2]}; quick: {QUICK[2]})",
        metavar="N",
    )
    parser.add_argument(
        "--settled", type=int, default=0, help="jobs of a campaign that is only read; 0: none", metavar="N"
    )


def run(
    quick: bool,
    jobs: int | None,
    episodes: int | None,
    drivers: Sequence[str],
    workers: Sequence[int],
    memory_episodes: int | None,
    settled: int,
    robot: str = DEFAULT_ROBOT,
) -> dict[str, Any]:
    """Run the same campaign, from its start to its end, by each driver with each number of workers.

    Figures of each row:

    - ``verified`` episodes; ``per_hour``, their number in an hour;
    - ``seconds`` of the whole command; ``cpu_seconds`` of all its processes, those of Ray included, and
      ``cpu_s_per_episode``; ``job_cpu_s``, the part of the jobs by their records, and ``other_cpu_s``, the rest;
    - ``first_compress_s``, wall time of compression in the job that searches CRFs; ``later_compress_s``, its mean in
      those that take them over; both None where that job verified no episode, so that each of the others searched;
    - ``crfs_taken``, by cameras of these jobs, and ``crfs_passed`` of them;
    - ``mb_per_episode`` and ``files_per_episode`` of the run folders;
    - ``worker_mb``, the largest memory of a process that ran jobs.

    ``ray_overhead_s`` is ``other_cpu_s`` with Ray less that with processes, for each number of workers, and
    ``ray_overhead`` its share of all CPU seconds with processes. The jobs' own are left out: they are the same, but
    differ by up to a tenth on a busy machine.

    ``memory`` is that of one process over ``memory_episodes`` of :data:`SHORT`, with fewer pictures and a fixed CRF:
    see :func:`benchmarks._campaign_memory.growth`.

    Args:
        quick: :data:`QUICK` in place of :data:`SIZES`, with fewer frames and a fixed CRF.
        jobs: of a campaign, 0 for memory alone; None, here and below, for that of these sizes.
        episodes: of a job.
        drivers: which of :data:`DRIVERS`.
        workers: numbers of them.
        memory_episodes: of the worker whose memory is measured; 0 for none.
        settled: jobs of a campaign that is only read, see :func:`benchmarks._campaign_settled.settled`; 0 for none.
        robot: by name.
    """
    given = zip((jobs, episodes, memory_episodes), QUICK if quick else SIZES, strict=True)
    jobs, episodes, memory_episodes = (usual if size is None else size for size, usual in given)
    options = {"models": "offline"} | (CHEAP if quick else {})
    left_out = [] if importlib.util.find_spec("ray") else ["ray"]
    rows: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as work:
        plan = _plan(Path(work), INSTRUCTION, robot, jobs, episodes, options)
        for count in workers if jobs else ():
            for driver in drivers:
                if driver not in left_out:
                    rows.append(_row(plan, Path(work) / f"{driver}-{count}", driver, count))
                    logger.info("%s", rows[-1])
        read = _campaign_settled.settled(Path(work) / "settled", settled) if settled else None
        memory = _memory(Path(work) / "memory", robot, memory_episodes, episodes) if memory_episodes else None
    overheads = ray_overheads(rows)
    return {
        "rows": rows,
        "ray_overhead": {str(count): share for count, (_, share) in overheads.items()},
        "ray_overhead_s": {str(count): seconds for count, (seconds, _) in overheads.items()},
        "memory": memory,
        "settled": read,
        "instruction": INSTRUCTION,
        "robot": robot,
        "jobs": jobs,
        "episodes_per_job": episodes,
        "quick": quick,
        "cores": cores(),
        "left_out": left_out,
    }


def ray_overheads(rows: Sequence[Mapping[str, Any]]) -> dict[int, tuple[float, float]]:
    """Number of workers → CPU seconds that Ray takes beside the jobs, and their share of all with processes."""
    found = {(row["driver"], row["workers"]): row for row in rows}
    overheads = {}
    for (driver, count), row in found.items():
        if driver == "ray" and (beside := found.get(("processes", count))):
            seconds = row["other_cpu_s"] - beside["other_cpu_s"]
            overheads[count] = round(seconds, 1), round(seconds / beside["cpu_seconds"], 3)
    return overheads


def _plan(folder: Path, instruction: str, robot: str, jobs: int, episodes: int, options: dict[str, Any]) -> Path:
    path = folder / "PLAN.yml"
    keys = {"name": "benchmark", "tasks": [{"id": "blocks", "instruction": instruction}], "robots": [robot]}
    counts = {"episodes": jobs * episodes, "episodes_per_job": episodes, "options": options}
    path.write_text(yaml.safe_dump(keys | counts), encoding="utf-8")
    return path


def _memory(folder: Path, robot: str, episodes: int, per_job: int) -> dict[str, Any]:
    folder.mkdir()
    per_job = max(1, min(per_job, episodes // 6))
    jobs = max(6, -(-episodes // per_job))
    plan = _plan(folder, SHORT, robot, jobs, per_job, {"models": "offline"} | CHEAP)
    _, records = _finished(plan, folder / "campaign", "processes", 1)
    return growth(records)


def _finished(plan: Path, out: Path, driver: str, workers: int) -> tuple[Timed, list[JobRecord]]:
    """Run a campaign to its end; the times of its command, and the records of its jobs."""
    done = _measured(_command(plan, out, driver, workers))
    records = list(CampaignFolder(out).records())
    if done.code not in (0, 7) or not records:
        raise RuntimeError(f"{driver} with {workers} workers ended with {done.code}: {done.stdout[-500:]}")
    return done, records


def _row(plan: Path, out: Path, driver: str, workers: int) -> dict[str, Any]:
    done, records = _finished(plan, out, driver, workers)
    folder = CampaignFolder(out)
    verified = sum(record.verified for record in records)
    in_jobs = sum(record.cpu_seconds for record in records)
    return {
        "driver": driver,
        "workers": workers,
        "verified": verified,
        "jobs": len(records),
        "seconds": round(done.wall_s, 1),
        "cpu_seconds": round(done.cpu_s, 1),
        "per_hour": round(3600 * verified / done.wall_s, 1),
        "cpu_s_per_episode": round(done.cpu_s / max(verified, 1), 2),
        **_compression(folder),
        "job_cpu_s": round(in_jobs, 1),
        "other_cpu_s": round(done.cpu_s - in_jobs, 1),
        "mb_per_episode": round(sum(record.bytes for record in records) / 1e6 / max(verified, 1), 3),
        "files_per_episode": round(sum(record.files for record in records) / max(verified, 1), 1),
        "worker_mb": round(max(record.memory_bytes for record in records) / 1e6),
    }


def _compression(folder: CampaignFolder) -> dict[str, Any]:
    """Seconds of compression in the first job, and the mean in those that begin at its CRFs; how many of these pass.

    A job without a verified episode compresses nothing.
    """
    jobs = [folder.run(job) for job in folder.plan.jobs()]
    compressed = [run for run in jobs if run.compression.exists()]
    seconds = {run: read_timings(run)["compress"] for run in compressed}
    first, later = seconds.get(jobs[0]), [seconds[run] for run in compressed if run is not jobs[0]]
    taken = [one for run in compressed for one in Compression.read(run.compression).taken_crfs]
    return {
        "first_compress_s": first,
        "later_compress_s": round(mean(later), 2) if first is not None and later else None,
        "crfs_taken": len(taken),
        "crfs_passed": sum(one.passed for one in taken),
    }


def _measured(command: list[str], every_s: float = 0.2) -> Timed:
    """:func:`timed`, with the CPU seconds of processes that no parent waits for, as those below Ray's.

    They are read every ``every_s`` seconds until they end, so that much of each may be missed, with any driver.
    """
    seen: dict[tuple[int, float], float] = {}
    with ThreadPoolExecutor(1) as pool:
        running = pool.submit(timed, command)
        while not running.done():
            for process in psutil.Process().children(recursive=True):
                with contextlib.suppress(psutil.NoSuchProcess):
                    used = process.cpu_times()
                    seen[process.pid, process.create_time()] = used.user + used.system
            time.sleep(every_s)
    return replace(running.result(), cpu_s=sum(seen.values()))


def _command(plan: Path, out: Path, driver: str, workers: int) -> list[str]:
    """The command of a driver; shards are two commands, which a shell runs side by side."""
    command = [sys.executable, "-m", "vcage.cli.main", "campaign", str(plan), "--out", str(out)]
    if driver == "ray":
        return [*command, "--ray", "auto", "--workers", str(workers)]
    if driver == "processes":
        return [*command, "--workers", str(workers)]
    script = """
index=0
while [ $index -lt $SHARDS ]; do "$@" --workers 1 --shard $index/$SHARDS & index=$((index + 1)); done
wait
"""
    return ["env", f"SHARDS={workers}", "sh", "-c", script, "sh", *command]
