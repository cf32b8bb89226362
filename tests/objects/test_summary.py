"""The library in numbers, and as text that fits a prompt."""

from __future__ import annotations

from vcage.objects.catalogue import catalogue_text
from vcage.objects.summary import count_kinds

MOST_TOKENS = 10_000
CHARACTERS_PER_TOKEN = 4


def test_kinds_are_counted_by_scene_and_source(library) -> None:
    annotations = [library.annotation(name) for name in library.names]
    counted = count_kinds(annotations)
    assert counted["kinds"] == len(annotations) == sum(counted["sources"].values())
    assert counted["scenes"]["kitchen"] == sum("kitchen" in a.words.scene_tags for a in annotations)


def test_the_whole_library_fits_a_prompt(library) -> None:
    assert len(catalogue_text(library.entries())) / CHARACTERS_PER_TOKEN < MOST_TOKENS
