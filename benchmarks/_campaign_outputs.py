"""The output of a campaign without times, to compare campaigns that were killed with one that was not."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from vcage.base.files import sha256_file
from vcage.base.leftovers import PARTIAL

BY_PRODUCTS = ("timings.json", "options.json", "unfinished.json", "report.html", "in-use")
"""Files of a run that hold wall times, or what else does not change what is made."""

TIMES = ("seconds", "cpu_seconds", "memory_bytes", "tries", "ended")
"""Fields of a job's record that tell how long it took, and how often it was interrupted."""


def outputs(campaign: Path) -> dict[str, Any]:
    """Path below ``jobs/`` → SHA-256 of each file of the runs, and the records of the jobs without times."""
    made: dict[str, Any] = {}
    for path in sorted((campaign / "jobs").rglob("*")):
        name = path.relative_to(campaign / "jobs").as_posix()
        if path.is_dir() or path.name in BY_PRODUCTS or path.suffix in (".beat", ".pyc") or PARTIAL in name:
            continue
        made[name] = _record(path) if name.endswith(".job.json") else sha256_file(path)
    return made


def left_over(campaign: Path) -> list[str]:
    """Files of partial work that are still there."""
    names = (path.relative_to(campaign).as_posix() for path in campaign.rglob("*") if path.is_file())
    return sorted(name for name in names if PARTIAL in name)


def differing(one: Mapping[str, Any], other: Mapping[str, Any]) -> list[str]:
    """Files that are in one campaign only, or differ."""
    return sorted(name for name in one.keys() | other.keys() if one.get(name) != other.get(name))


def _record(path: Path) -> dict[str, Any]:
    record = {key: value for key, value in json.loads(path.read_text(encoding="utf-8")).items() if key not in TIMES}
    record["bytes"] = record["files"] = None  # of by-products with times, too
    return record
