"""The generated cases, made once and kept in the user's cache: a second run only scores."""

from __future__ import annotations

import hashlib
import json
import logging
from pathlib import Path

from benchmarks._match.cases import write_case
from benchmarks._match.levels import LEVELS
from benchmarks._match.making import make_case
from vcage import __version__
from vcage.base.files import cache_dir
from vcage.objects.library import Library

logger = logging.getLogger(__name__)

GENERATOR = ("truth", "levels", "scenes", "views", "drawing", "changes", "targets", "making")
"""Modules whose text decides what the pictures look like."""

PICTURES = {"hardest": 80}
EACH = 30
"""Pictures of each level, and those of levels that have another number."""

QUICK = {"hardest": 6}
QUICK_EACH = 3
"""The same with ``--quick``; the first of the whole set."""


def wanted(levels: list[str], quick: bool) -> list[tuple[str, int]]:
    """(level, number) of the cases of a run, by level."""
    counts, each = (QUICK, QUICK_EACH) if quick else (PICTURES, EACH)
    return [(level, index) for level in levels for index in range(counts.get(level, each))]


def cases_folder() -> Path:
    """Folder of the cases of this generator, this version and this library; made on demand."""
    return cache_dir("benchmarks", "match", _key())


def _key() -> str:
    """Changes with the generator's text and constants, the version of vcage and the looks of the library."""
    texts = [Path(__file__).with_name(f"{name}.py").read_text(encoding="utf-8") for name in GENERATOR]
    looks = Library.load().variants()
    return hashlib.sha256(json.dumps([texts, __version__, looks]).encode()).hexdigest()[:16]


def ensure_cases(quick: bool) -> tuple[Path, list[Path]]:
    """Make the cases that are not there yet.

    Returns:
        (root, folders): the folder of all cases, and those of this run.

    Raises:
        NoRenderer: some are missing, and nothing here can draw.
    """
    root = cases_folder()
    cases = wanted(list(LEVELS), quick)
    missing = [(level, index) for level, index in cases if not (root / _name(level, index)).is_dir()]
    for done, (level, index) in enumerate(missing):
        if done % 10 == 0:
            logger.info("making pictures: %d of %d", done, len(missing))
        write_case(root, make_case(level, index))
    return root, [root / _name(level, index) for level, index in cases]


def _name(level: str, index: int) -> str:
    return f"{level}/{index:03d}"
