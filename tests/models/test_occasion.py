"""Which kinds suit an occasion."""

from __future__ import annotations

import numpy as np

from tests.models.catalogue import CATALOGUE, entry
from vcage.models.occasion import Occasion, one_of_each

BOX = entry("box", "box", "container", size=(0.2, 0.15, 0.1), holds="in")
SMALL = entry("die", "die", "toy", tags=("playroom",))
BREAD = (("bagel", 0.07), ("roll", 0.06))
LARGE = entry("globe", "globe", "toy", size=(0.3, 0.3, 0.3))


def test_an_object_larger_than_the_inside_does_not_go_in() -> None:
    assert Occasion("table").goes_in(SMALL, BOX) and not Occasion("table").goes_in(LARGE, BOX)
    tight = entry("tight", "tight", "toy", size=(0.2, 0.14, 0.1))
    assert not Occasion("table").goes_in(tight, BOX)


def test_a_place_takes_as_many_things_as_have_room_for_fingers_between_them() -> None:
    bagels, rolls = ([entry(name, name, "bread", size=(side, side, 0.03))] * 5 for name, side in BREAD)
    assert Occasion("table").several(BOX, bagels) == 2
    assert Occasion("table").several(BOX, rolls) == 3
    assert Occasion("table").several(None, bagels) == 3


def test_fitting_objects_of_the_scene_are_preferred_while_there_are_any() -> None:
    other = entry("cube", "cube", "toy", tags=("office_desk",))
    assert Occasion("playroom").suiting([SMALL, other, LARGE], BOX, several=False, least=1) == [SMALL]
    assert Occasion("playroom").suiting([SMALL, other, LARGE], BOX, several=False, least=2) == [SMALL, other]
    assert Occasion("playroom").suiting([LARGE], BOX, several=False, least=1) == [LARGE]


def test_clutter_is_small_objects_of_the_scene_without_look_alikes() -> None:
    rng = np.random.default_rng(0)
    found = Occasion("kitchen").standing_by(CATALOGUE, lambda kind: kind.name == "apple", rng)
    tags = {kind.name: kind.words.scene_tags for kind in CATALOGUE}
    assert len(found) == 2 and all("kitchen" in tags[one.asset] and one.asset != "apple" for one in found)


def test_every_kind_has_a_look_before_one_has_a_second() -> None:
    kinds = [kind for kind in CATALOGUE if kind.name in ("apple", "block")]
    drawn = one_of_each([(kind, kind.variants) for kind in kinds], np.random.default_rng(0))
    assert len(drawn) == 6 and {kind.name for kind, _ in drawn[:2]} == {"apple", "block"}
