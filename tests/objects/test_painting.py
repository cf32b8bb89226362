"""Colours of objects on demand: what is seen is what was asked for, and nothing else changes."""

from __future__ import annotations

import pytest

from vcage.apps.proof.prove import shape_hash
from vcage.base.errors import UnknownName
from vcage.base.words import COLOURS, colour_of
from vcage.objects.library import Library
from vcage.objects.painting import PAINTS, in_colour, looks_of
from vcage.schema.randomisation import Tint
from vcage.sim.tints import colours_of, truthful


@pytest.fixture(scope="module")
def library() -> Library:
    return Library.load()


@pytest.mark.slow
@pytest.mark.parametrize("colour", ["black", "pink", "yellow", "blue", "white"])
@pytest.mark.parametrize("name", ["block", "basket", "small_bowl", "mug", "coloured_mat"])
def test_a_painted_object_is_seen_in_the_colour(library: Library, name: str, colour: str) -> None:
    assert colours_of(library.asset(name, colour).model).words()[1] == colour


@pytest.mark.parametrize("name", ["small_bowl", "microwave"])
def test_a_colour_changes_neither_shape_nor_mass(library: Library, name: str) -> None:
    base = library.annotation(name).any_colour
    assert shape_hash(library.asset(name, "purple")) == shape_hash(library.asset(name, base))


def test_every_colour_that_people_name_can_be_painted() -> None:
    assert {colour_of(word) for word in COLOURS} == {*PAINTS}


def test_a_random_tint_keeps_the_painted_colour(library: Library) -> None:
    shown = colours_of(library.asset("block", "pink").model)
    kept = truthful(shown, Tint(hue_deg=60.0, saturation=1.0, lightness=1.0))
    assert kept is None or shown.words(kept) == shown.words()


def test_an_own_look_is_preferred_to_paint(library: Library) -> None:
    assert library.asset("block", "red").variant.painted is None
    assert in_colour(library.annotation("block"), "red") is None


def test_what_has_no_one_main_colour_comes_in_no_other(library: Library) -> None:
    assert looks_of(library.annotation("apple")) == ["red", "green"]
    with pytest.raises(UnknownName, match=r"unknown variant of apple 'black'; available: green, red$"):
        library.asset("apple", "black")


def test_a_colour_that_is_none_is_refused(library: Library) -> None:
    with pytest.raises(UnknownName, match="unknown variant of block 'mauve'"):
        library.asset("block", "mauve")
