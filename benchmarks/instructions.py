"""Count sentences read right, refused, or misread: those the grammar was written for, and others.

``libero`` and ``robotwin`` are sentences of these benchmarks, of tasks whose objects exist here; ``reasons`` says why
the others are refused (:mod:`benchmarks._instructions.tasks`).
"""

from __future__ import annotations

import argparse
import itertools
import logging
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from scipy.optimize import linear_sum_assignment

from benchmarks._instructions.tasks import counted, outcome, possible
from vcage.base.errors import VcageError
from vcage.models.rules.readings import read_goals
from vcage.objects.library import Library
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import AskedGoal

logger = logging.getLogger(__name__)

FOLDER = Path(__file__).with_name("_instructions")
TASKS = Path("../shared/tasks")
"""Folder of the sentences of others; they are no part of this project."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of this benchmark."""
    hint = "also name the untouched sentences that are misread or refused: not while the grammar is worked on"
    parser.add_argument("--name-untouched", action="store_true", help=hint)
    hint = f"folder with libero.json and robotwin.json (default: {TASKS})"
    parser.add_argument("--tasks", type=Path, default=TASKS, metavar="DIR", help=hint)


def run(quick: bool, name_untouched: bool = False, tasks: Path = TASKS) -> dict[str, Any]:
    """Counts and shares of both halves and of others' tasks; what is misread or refused goes to the log.

    Args:
        quick: every third sentence.
        name_untouched: True to name the untouched ones too.
        tasks: folder with foreign sentences; a missing file is reported instead.
    """
    scenes = load_scenes()
    named = {"seen": True, "untouched": name_untouched}
    halves = {half: _measure(half, scenes, quick, names) for half, names in named.items()}
    return halves | {name: _measure_tasks(tasks / f"{name}.json", quick) for name in ("libero", "robotwin")}


def _measure_tasks(path: Path, quick: bool) -> dict[str, Any] | str:
    if not path.is_file():
        return f"absent: {path.name}"
    library = Library.load()
    catalogue = [library.entry(name) for name in library.names]
    outcomes = []
    for task in possible(path)[:: 3 if quick else 1]:
        outcomes.append(outcome(task, catalogue))
        if outcomes[-1][0] != "right":
            logger.info("%s %s: %s\n  %s", path.stem, outcomes[-1][0], task["text"], outcomes[-1][1])
    return counted(outcomes)


def load_scenes() -> dict[str, dict[str, CatalogueEntry]]:
    """Scene → object id → the catalogue's entry with that look only."""
    library = Library.load()
    found: dict[str, dict[str, CatalogueEntry]] = {}
    for scene, objects in yaml.safe_load((FOLDER / "scenes.yml").read_text(encoding="utf-8")).items():
        found[scene] = {}
        for name, look in objects.items():
            asset, _, variant = look.partition("/")
            entry = library.entry(asset)
            shown = [v for v in entry.variants if v.id == variant]
            found[scene][name] = entry.model_copy(update={"variants": shown})
    return found


def _measure(
    half: str, scenes: Mapping[str, Mapping[str, CatalogueEntry]], quick: bool, names: bool
) -> dict[str, float]:
    cases = yaml.safe_load((FOLDER / f"{half}.yml").read_text(encoding="utf-8"))[:: 3 if quick else 1]
    counts = {"right": 0, "refused": 0, "misread": 0}
    for case in cases:
        outcome, told = read(case, scenes[case["scene"]])
        counts[outcome] += 1
        if outcome != "right" and names:
            logger.info("%s %s: %s\n  %s", half, outcome, case["say"], told)
    shares = {f"{name}_share": round(count / len(cases), 4) for name, count in counts.items()}
    return {"sentences": len(cases), **counts, **shares}


def read(case: Mapping[str, Any], things: Mapping[str, CatalogueEntry]) -> tuple[str, str]:
    """``right``, ``refused`` or ``misread``, and what was read or why it was refused."""
    try:
        found = read_goals(case["say"], things).goals
    except VcageError as error:
        return ("right" if "refuse" in case else "refused"), error.message
    told = "; ".join(f"{asked.step}: {asked.goal}" for asked in found)
    return ("right" if "steps" in case and agrees(found, case["steps"]) else "misread"), told


def agrees(found: Sequence[AskedGoal], steps: Sequence[Sequence[Sequence[str]]]) -> bool:
    """True if the goals match the record, each once, in an allowed order."""
    wanted = [(number, goal) for number, step in enumerate(steps) for goal in _spread(step, found)]
    if len(wanted) != len(found):
        return False
    fits = np.array([[_fits(asked, goal) for asked in found] for _, goal in wanted])
    rows, columns = linear_sum_assignment(~fits)
    if not fits[rows, columns].all():
        return False
    order = {row: found[column].step for row, column in zip(rows, columns, strict=True)}
    pairs = itertools.permutations(range(len(wanted)), 2)
    return all(order[a] < order[b] for a, b in pairs if wanted[a][0] < wanted[b][0])


def _spread(step: Sequence[Sequence[str]], found: Sequence[AskedGoal]) -> Iterator[Sequence[str]]:
    """The goals of a step; a tower may be built in any order."""
    for goal in step:
        if goal[0] == "tower":
            stacked = [a.goal for a in found if a.goal.relation == "on" and a.goal.subject in goal[1:]]
            bases = [g.reference for g in stacked]
            chained = len(set(bases)) == len(bases) == len(goal) - 2 and set(bases) <= set(goal[1:])
            yield from ([["on", g.subject, str(g.reference)] for g in stacked] if chained else [goal] * (len(goal) - 2))
        else:
            yield goal


def _fits(asked: AskedGoal, goal: Sequence[str]) -> bool:
    """True if a goal is one that a record allows: ``[inside, apple_red|apple_green, bowl]``."""
    word, *names = goal
    found = asked.goal
    subject = f"{found.subject}/{found.part}" if found.reference is None and found.part else found.subject
    place = f"{found.reference}/{found.part}" if found.part else found.reference
    told = [subject] if found.reference is None else [subject, place]
    return (
        found.relation == word
        and len(told) == len(names)
        and all(name in options.split("|") for name, options in zip(told, names, strict=True))
    )
