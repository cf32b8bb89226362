"""Matching of objects in target pictures with known truth, level by level, beside a greedy baseline.

Pictures are rendered scenes of the library's objects, moved and turned, then changed as image models change what they
redraw (docs/match-pictures.md). They are made once and kept in the user's cache; --pictures scores others instead.
"""

from __future__ import annotations

import argparse
import logging
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from benchmarks._match.cases import Case, case_folders, read_case, write_case
from benchmarks._match.levels import LEVELS
from benchmarks._match.scoring import Score, row
from benchmarks._match.stacks import BASELINE, OFFLINE, build, judge
from vcage.base.errors import UsageError

logger = logging.getLogger(__name__)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The benchmark's own options."""
    parser.add_argument(
        "--stack",
        action="append",
        metavar="DETECTOR+EMBEDDER",
        help=f"detector and embedder to measure; may be given several times (default: {OFFLINE})",
    )
    parser.add_argument("--pictures", type=Path, metavar="DIR", help="score the cases in this folder, made elsewhere")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="copy the generated cases of this run to a folder")


def run(
    quick: bool, stack: Sequence[str] | None = None, pictures: Path | None = None, keep: Path | None = None
) -> dict[str, Any]:
    """Rows of figures (:func:`benchmarks._match.scoring.row`), by level and stack; wrong matches go to the log.

    Args:
        quick: 30 pictures instead of 320.
        stack: measured stacks; the greedy baseline is always measured beside them.
        pictures: folder of cases to score instead of the generated ones.
        keep: folder that the generated cases are copied to.

    Raises:
        InputFileError: a case of ``pictures`` is damaged; names it.
        NoRenderer: pictures must be made, and nothing here can draw.
        UsageError: ``keep`` together with ``pictures``, or an unknown stack.
    """
    if keep is not None and pictures is not None:
        raise UsageError("--keep copies generated pictures, --pictures has none made", hint="give one of the two")
    matchers = {name: build(name) for name in [*(stack or [OFFLINE]), BASELINE]}
    root, folders = (pictures, case_folders(pictures)) if pictures is not None else _generated(quick)
    scores: dict[tuple[str, str], list[Score]] = {}
    for case in _read(root, folders, keep):
        for name, matcher in matchers.items():
            one = judge(matcher, case)
            _tell(case, name, one)
            scores.setdefault((case.truth.level, name), []).append(one)
    order = {level: place for place, level in enumerate(LEVELS)}
    levels = sorted({level for level, _ in scores}, key=lambda level: (order.get(level, len(order)), level))
    return {"rows": [row(level, name, scores[level, name]) for level in levels for name in matchers]}


def _generated(quick: bool) -> tuple[Path, list[Path]]:
    # Makes pictures, and so needs the library and the simulator: not loaded where cases come from a folder.
    from benchmarks._match.generated import ensure_cases

    return ensure_cases(quick)


def _read(root: Path, folders: Sequence[Path], keep: Path | None) -> Iterable[Case]:
    for folder in folders:
        case = read_case(folder, root)
        if keep is not None:
            write_case(keep, case)
        yield case


def _tell(case: Case, stack: str, one: Score) -> None:
    wrong = ", ".join(f"{match.object} ({match.why}, {match.confidence:.2f})" for match in one.wrong)
    found = f"{len(one.right)} of {one.present} right"
    logger.info("%s %s: %s in %.2f s%s", case.name, stack, found, one.seconds, f"; wrong: {wrong}" if wrong else "")
