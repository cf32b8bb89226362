"""CPU seconds and memory of reading a campaign whose jobs are all settled; the records are made, and nothing is run."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import yaml

from benchmarks._process_times import timed
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.plan import Job, Plan
from vcage.campaigns.record import JobRecord
from vcage.schema.episodes import CriticCounts, Spread

CELLS = 200
"""At most; fewer where there are fewer jobs."""

PROGRAM = """
import sys
from vcage.base.memory import largest_memory
from vcage.cli.main import main
code = main(sys.argv[1:])
print(largest_memory(), file=sys.stderr)
sys.exit(code)
"""
"""The command line of vcage, which says at its end how much memory it took."""

OBJECTS = 4
"""Whose starts are in each record."""


def settled(folder: Path, jobs: int) -> dict[str, Any]:
    """Write a campaign of settled jobs, and read it by ``vcage status`` and by a driver, which finds nothing to do.

    Args:
        folder: new, for the campaign.
        jobs: about so many; the same number in each cell.

    Returns:
        ``jobs``, and for ``status`` and ``driver`` their ``cpu_s`` and the largest memory of their own process, ``mb``.
    """
    folder.mkdir()
    plan = folder / "PLAN.yml"
    cells = min(CELLS, jobs)
    keys = {"name": "settled", "tasks": [{"id": "blocks", "goals": ["block on plate"], "objects": "block, plate"}]}
    counts = {"seeds": cells, "episodes": jobs // cells, "episodes_per_job": 1, "options": {"models": "offline"}}
    plan.write_text(yaml.safe_dump(keys | counts), encoding="utf-8")
    campaign = CampaignFolder(folder / "campaign")
    made = _write_records(campaign, campaign.begin(Plan.load(plan)))
    return {
        "jobs": made,
        "status": _spent("status", str(campaign.root)),
        "driver": _spent("campaign", str(plan), "--out", str(campaign.root), "--workers", "1"),
    }


def _write_records(campaign: CampaignFolder, plan: Plan) -> int:
    jobs = plan.jobs()
    for job in jobs:
        path = campaign.record_file(job)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(_record(job).model_dump_json(), encoding="utf-8")
    return len(jobs)


def _record(job: Job) -> JobRecord:
    start = Spread(lower=(-0.2, -0.1), upper=(0.2, 0.1), deviation=(0.1, 0.05))
    return JobRecord(
        cell=job.cell.id,
        number=job.number,
        seed=job.seed,
        state="done",
        episodes=job.episodes,
        asked=job.episodes,
        verified=job.episodes,
        tried=job.episodes + 1,
        attempts=job.episodes + 1,
        rejected={"the block is beside the plate": 1},
        critic=CriticCounts.of([(True, True), (False, False)]),
        spread={f"object_{number}": start for number in range(OBJECTS)},
        seconds=16.0,
        cpu_seconds=16.0,
        bytes=7_000_000,
        files=49,
        memory_bytes=1_000_000_000,
        tries=1,
        host="host",
        ended="2026-01-01T00:00:00+00:00",
    )


def _spent(*words: str) -> dict[str, float]:
    """CPU seconds of a command with all its processes, and the largest memory of its own."""
    done = timed([sys.executable, "-c", PROGRAM, *words])
    if done.code:
        raise RuntimeError(f"vcage {words[0]} ended with {done.code}")
    return {"cpu_s": round(done.cpu_s, 1), "mb": round(int(done.marks[-1].line) / 1e6)}
