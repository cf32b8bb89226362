"""The catalogue as text for a prompt, and in numbers."""

from __future__ import annotations

import pytest

from tests.models.catalogue import CATALOGUE, entry
from vcage.objects.catalogue import catalogue_line, catalogue_text, count_kinds, size_class
from vcage.objects.library import Library
from vcage.schema.asset import FunctionalPoint

MOST_TOKENS = 10_000
CHARACTERS_PER_TOKEN = 4


def test_each_kind_is_one_line_with_its_name() -> None:
    lines = catalogue_text(CATALOGUE).splitlines()
    assert [line.split(" = ")[0] for line in lines] == [f"- {kind.name}" for kind in CATALOGUE]


def test_the_line_lists_the_abilities_of_the_object() -> None:
    assert "; graspable, holds in; brown" in catalogue_line(entry("box", "box", "container", ("brown",), holds="in"))
    fixed = entry("shelf", "shelf", "furniture").model_copy(update={"contact_points": []})
    assert "; not graspable; white" in catalogue_line(fixed)


def test_several_places_are_counted() -> None:
    points = [
        FunctionalPoint(id=i, name="place", holds=holds, position=(0, 0, 0))
        for i, holds in enumerate(["in", "in", "on"])
    ]
    cabinet = entry("cabinet", "cabinet", "furniture").model_copy(update={"functional_points": points})
    assert "holds in (x2) and on" in catalogue_line(cabinet)


def test_a_name_that_repeats_another_is_left_out() -> None:
    line = catalogue_line(entry("drink_bottle", "drink bottle", "food", synonyms=("bottle", "flask")))
    assert line.startswith("- drink_bottle = flask: ")


def test_a_look_shows_its_colour_where_its_name_does_not() -> None:
    pear = entry("pear", "pear", "fruit", ("green", "yellow"))
    ripe = pear.variants[1].model_copy(update={"id": "ripe"})
    line = catalogue_line(pear.model_copy(update={"variants": [pear.variants[0], ripe]}))
    assert line.endswith("; green, ripe (yellow)")


@pytest.mark.parametrize(("edge", "word"), [(0.06, "tiny"), (0.12, "small"), (0.2, "medium"), (0.21, "large")])
def test_size_classes_follow_the_longest_edge(edge: float, word: str) -> None:
    assert size_class(entry("x", "x", "toy", size=(0.01, edge, 0.01))) == word


def test_kinds_are_counted_by_scene_and_source(library: Library) -> None:
    annotations = [library.annotation(name) for name in library.names]
    counted = count_kinds(annotations)
    assert counted["kinds"] == len(annotations) == sum(counted["sources"].values())
    assert counted["scenes"]["kitchen"] == sum("kitchen" in a.words.scene_tags for a in annotations)


def test_the_whole_library_fits_a_prompt(library: Library) -> None:
    assert len(catalogue_text(library.entries())) / CHARACTERS_PER_TOKEN < MOST_TOKENS
