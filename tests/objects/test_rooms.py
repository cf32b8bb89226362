"""The room at functional points, as the catalogue has it."""

from __future__ import annotations

import pytest

from vcage.objects import rooms
from vcage.objects.catalogue import catalogue_line
from vcage.objects.library import Library


def test_an_entry_carries_the_opening_of_each_functional_point(library: Library) -> None:
    asset, entry = library.asset("packaging_box"), library.entry("packaging_box")
    (point,), (room,) = asset.annotation.functional_points, entry.rooms
    opening = asset.opening(point)
    assert room.point == point.id
    assert room.size == pytest.approx((*opening.size, opening.depth), abs=1e-4)


def test_the_catalogue_shows_inner_sizes_and_names_drawers(library: Library) -> None:
    line = catalogue_line(library.entry("cabinet_two_drawers"))
    assert "in drawer_top 21.2x12.2x6.1" in line and "on 26.0x19.3" in line


def test_a_room_is_measured_once(library: Library, monkeypatch: pytest.MonkeyPatch) -> None:
    known = library.entry("mug").rooms
    monkeypatch.setattr(rooms, "_measured", lambda _: pytest.fail("it was measured before"))
    assert Library.load().entry("mug").rooms == known


def test_a_room_is_measured_again_for_other_points(library: Library) -> None:
    asset = library.asset("mug")
    assert rooms._key(asset) != rooms._key(library.asset("bowl"))
