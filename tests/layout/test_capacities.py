from __future__ import annotations

import pytest

from vcage.layout.capacities import opening_for, room_of
from vcage.objects.library import Library


@pytest.fixture(scope="module")
def library() -> Library:
    return Library.load()


def test_a_box_has_an_opening_smaller_than_itself(library):
    room = room_of(library.asset("packaging_box"))
    assert room.holds == "in" and room.ceiling is None
    assert all(a < b for a, b in zip(sorted(room.opening), sorted(room.size[:2]), strict=True))


def test_a_plate_takes_things_on_it_and_an_apple_takes_nothing(library):
    assert room_of(library.asset("plate")).holds == "on"
    assert room_of(library.asset("apple")).holds is None


def test_a_closed_drawer_takes_nothing(library):
    cabinet = library.asset("cabinet_one_drawer")
    assert cabinet.annotation.functional_points[0].link is not None
    assert room_of(cabinet).holds is None and opening_for(cabinet) is None
