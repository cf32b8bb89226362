"""Sentences read in scenes that are selected for them."""

from __future__ import annotations

import functools

import numpy as np

from vcage.models.rules.reasoner import OfflineReasoner
from vcage.models.selection_check import entries_of, instructed, name_objects
from vcage.objects.library import Library
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import Reading
from vcage.schema.plan import Selection


@functools.lru_cache(maxsize=1)
def kinds() -> list[CatalogueEntry]:
    """The library as set-up leaves it."""
    library = Library.load()
    return [library.entry(name) for name in library.names]


def selected(instruction: str, seed: int = 0, scene: str = "table") -> Selection:
    """Choose objects for a sentence."""
    rng = np.random.default_rng(seed)
    return OfflineReasoner().select_assets(instruction, kinds(), rng, lambda _: [], scene)


def read(instruction: str, seed: int = 0) -> tuple[Selection, Reading]:
    """Choose objects for a sentence and read it among them."""
    chosen = selected(instruction, seed)
    named = name_objects(chosen, kinds())
    things = entries_of(named, kinds())
    return chosen, OfflineReasoner().read_goals(instructed(instruction, named, things))


def goals(instruction: str, seed: int = 0) -> list[str]:
    """The goals that are read, in plain words with their steps."""
    return [f"{asked.step}: {asked.goal}" for asked in read(instruction, seed)[1].goals]
