"""Measure the offline reasoner's choice of objects: sixty sentences over the library's own kinds."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from vcage.base.errors import VcageError
from vcage.models.rules.reasoner import OfflineReasoner
from vcage.models.selection_check import validate_selection
from vcage.objects.library import Library
from vcage.schema.asset import CatalogueEntry
from vcage.schema.plan import SelectedAsset

logger = logging.getLogger(__name__)

INSTRUCTIONS = Path(__file__).with_name("select_instructions.yml")
SEED = 0


@dataclass(frozen=True)
class Slot:
    """One thing that an instruction needs; see the head of ``select_instructions.yml``."""

    role: str
    kinds: tuple[str, ...] | None
    least: int
    most: int | None
    colour: str | None

    @classmethod
    def read(cls, record: dict[str, Any]) -> Slot:
        """A slot from its record."""
        count = record.get("count", 1)
        kinds = None if record["kinds"] == "any" else tuple(record["kinds"])
        least, most = (2, None) if count == "several" else (count, count)
        return cls(record["role"], kinds, least, most, record.get("colour"))

    def answers(self, chosen: SelectedAsset, colour: str) -> bool:
        """True if a chosen object is one that the slot asks for."""
        return (
            self.role in ("any", chosen.role)
            and (self.kinds is None or chosen.asset in self.kinds)
            and (self.colour is None or self.colour in colour)
        )


@dataclass
class Tally:
    """Counts over instructions: slots that are needed and found, objects that were chosen and are needed."""

    needed: int = 0
    found: int = 0
    chosen: int = 0
    right: int = 0

    def add(self, other: Tally) -> None:
        """Add the counts of another tally."""
        self.needed += other.needed
        self.found += other.found
        self.chosen += other.chosen
        self.right += other.right

    @property
    def recall(self) -> float:
        """Share of the needed slots that were filled."""
        return self.found / self.needed

    @property
    def precision(self) -> float:
        """Share of the chosen objects that were needed; 0 when none was chosen."""
        return self.right / self.chosen if self.chosen else 0.0


def run(quick: bool) -> dict[str, float]:
    """Recall of needed slots and precision of the chosen objects; missed slots go to the log.

    Args:
        quick: every third instruction.
    """
    entries = own_kinds()
    total = Tally()
    cases = yaml.safe_load(INSTRUCTIONS.read_text(encoding="utf-8"))[:: 3 if quick else 1]
    for case in cases:
        total.add(_measure(case, entries))
    return {
        "recall": round(total.recall, 4),
        "precision": round(total.precision, 4),
        "instructions": len(cases),
    }


def own_kinds() -> list[CatalogueEntry]:
    """The kinds that need no package, so that the figures are the same on every machine."""
    library = Library.load()
    return [library.entry(name) for name in library.names if library.annotation(name).source == "parametric"]


def _measure(case: dict[str, Any], entries: Sequence[CatalogueEntry]) -> Tally:
    slots = [Slot.read(record) for record in case["slots"]]
    try:
        check = partial(validate_selection, entries=entries)
        selection = OfflineReasoner().select_assets(case["text"], entries, np.random.default_rng(SEED), check)
    except VcageError as error:
        logger.info("%s\n  refused: %s", case["text"], error.message)
        return Tally(needed=len(slots))
    return score(case["text"], slots, selection.objects, case.get("may", []), entries)


def score(
    text: str,
    slots: Sequence[Slot],
    chosen: Sequence[SelectedAsset],
    may: Sequence[str],
    entries: Sequence[CatalogueEntry],
) -> Tally:
    """Give every chosen object to the narrowest slot that still wants it, and count; context is never wrong."""
    colours = {(entry.name, variant.id): variant.colour for entry in entries for variant in entry.variants}
    filled = dict.fromkeys(slots, 0)
    wrong = []
    for thing in chosen:
        open_slots = [
            slot
            for slot, count in filled.items()
            if slot.answers(thing, colours[thing.asset, thing.variant]) and (slot.most is None or count < slot.most)
        ]
        if open_slots:
            filled[min(open_slots, key=_width)] += 1
        elif thing.role != "context" and thing.asset not in may:
            wrong.append(thing)
    missed = [slot for slot, count in filled.items() if count < slot.least]
    if missed or wrong:
        missing = "; ".join(f"{slot.role} {'/'.join(slot.kinds or ['any'])}" for slot in missed)
        needless = ", ".join(f"{thing.role} {thing.asset}/{thing.variant}" for thing in wrong)
        logger.info("%s\n  missed: %s\n  not needed: %s", text, missing or "nothing", needless or "nothing")
    right = sum(filled.values())
    return Tally(len(slots), len(slots) - len(missed), right + len(wrong), right)


def _width(slot: Slot) -> float:
    return float("inf") if slot.kinds is None else len(slot.kinds)
