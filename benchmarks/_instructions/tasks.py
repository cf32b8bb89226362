"""Sentences of LIBERO and RoboTwin, read in scenes that are selected for them, against the goals that they mean.

The sentences and their goals are facts of others and lie in a folder beside this project: ``libero.json`` and
``robotwin.json``, lists of ``{text, goals: [{relation, subject, reference, part, …}], needs, objects}`` with kinds of
ours as names. Of a task whose ``needs`` name a kind or a colour that the library does not have, nothing is measured.
"""

from __future__ import annotations

import collections
import re
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import linear_sum_assignment

from vcage.base.errors import VcageError
from vcage.base.files import read_json
from vcage.models.rules.reasoner import OfflineReasoner
from vcage.models.selection_check import entries_of, instructed, name_objects, validate_selection
from vcage.objects.names import names_of
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import AskedGoal

ABSENT = ("kind:", "colour:")
"""Needs of a task that the library does not meet, whatever its sentence is."""

Things = Mapping[str, CatalogueEntry]


def possible(path: Path) -> list[dict[str, Any]]:
    """The tasks of a file whose objects exist."""
    return [task for task in read_json(path) if not any(need.startswith(ABSENT) for need in task["needs"])]


def outcome(task: Mapping[str, Any], catalogue: Sequence[CatalogueEntry]) -> tuple[str, str]:
    """``right``, ``refused`` or ``misread``, and what was read or why it was refused."""
    try:
        found, things = _read(task["text"], catalogue)
    except VcageError as error:
        return "refused", error.message
    told = "; ".join(str(asked.goal) for asked in found)
    return ("right" if _agree(found, things, task) else "misread"), told


def why(message: str) -> str:
    """The reason of a refusal, without the words that it is about."""
    return re.sub(r"'[^']*'", "…", message.rpartition("is not understood: ")[2])[:80]


def counted(outcomes: Iterable[tuple[str, str]]) -> dict[str, Any]:
    """Counts, the share that is right, and how often which reason was given."""
    outcomes = list(outcomes)
    counts = {name: sum(found == name for found, _ in outcomes) for name in ("right", "refused", "misread")}
    reasons = collections.Counter(why(told) for found, told in outcomes if found == "refused")
    share = round(counts["right"] / len(outcomes), 4) if outcomes else None
    return {"sentences": len(outcomes), **counts, "right_share": share, "reasons": dict(reasons.most_common())}


def _read(text: str, catalogue: Sequence[CatalogueEntry]) -> tuple[list[AskedGoal], Things]:
    reasoner = OfflineReasoner()
    check = partial(validate_selection, entries=catalogue)
    named = name_objects(reasoner.select_assets(text, catalogue, np.random.default_rng(0), check), catalogue)
    things = entries_of(named, catalogue)
    return reasoner.read_goals(instructed(text, named, things)).goals, things


def _agree(found: Sequence[AskedGoal], things: Things, task: Mapping[str, Any]) -> bool:
    """Check if the goals match the task, regardless of the instance of a kind.

    'Every bread' asks for as many goals as there are breads: then each goal that is read is one of the task's.
    """
    wanted = task["goals"]
    if all(goal["relation"] != "open" for goal in wanted):  # opening on the way may be a goal or not
        found = [asked for asked in found if asked.goal.relation != "open"]
    if not wanted or not task.get("goals_complete", True):
        return False
    fits = np.array([[_fits(asked, things, goal, task) for asked in found] for goal in wanted])
    if len(found) != len(wanted):
        return "reference:every" in task["needs"] and bool(fits.any(axis=0).all())
    rows, columns = linear_sum_assignment(~fits)
    return bool(fits[rows, columns].all())


def _fits(asked: AskedGoal, things: Things, wanted: Mapping[str, Any], task: Mapping[str, Any]) -> bool:
    goal = asked.goal
    if goal.relation != wanted["relation"] or (goal.part or None) != wanted["part"]:
        return False
    ends = (goal.subject, wanted["subject"], "subject"), (goal.reference, wanted["reference"], "reference")
    return all(
        (name is None) == (kind is None)
        and (name is None or _is(things[name], kind, wanted.get(f"{end}_colour"), task))
        for name, kind, end in ends
    )


def _is(entry: CatalogueEntry, kind: str, colour: str | None, task: Mapping[str, Any]) -> bool:
    """Check if an object is of the kind that the words of a task mean, or of one with the same head noun."""
    told = [other if isinstance(other, str) else other["kind"] for other in task["objects"]]
    said = {word for text in told if kind in re.findall(r"\w+", text) for word in re.findall(r"\w+", text)}
    alike = entry.name in {kind, *said} or names_of(entry).words[-1] == kind.replace("_", " ").split()[-1]
    alike = alike or {entry.words.category, kind.split("_")[0]} == {"furniture", "cabinet"} or _bread(entry, kind)
    return alike and colour in (None, entry.variants[0].colour, entry.variants[0].id)


def _bread(entry: CatalogueEntry, kind: str) -> bool:
    return "bread" in (entry.words.category, *entry.words.synonyms) and kind in ("bread_roll", "toast_slice")
