"""Shafts and the holes that they go into, measured on convex pieces."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import thing
from vcage.base.geometry import Pose
from vcage.objects.convex import Convex
from vcage.objects.holes import holes_of, shafts_of
from vcage.objects.openings import material_along

PEG, BLOCK = thing("peg").asset, thing("peg_block").asset


def test_a_peg_has_a_shaft_of_its_length_and_thickness() -> None:
    (shaft,) = shafts_of(PEG)
    assert 2 * shaft.half == pytest.approx(0.14) and np.abs(shaft.outline).max() == pytest.approx(0.012)
    assert shaft.ends(Pose([0.0, 0.0, 1.0])) == pytest.approx(np.array([[-0.07, 0, 1.012], [0.07, 0, 1.012]]))


def test_a_hole_is_measured_behind_its_bevels_and_open_at_both_ends() -> None:
    (hole,) = holes_of(BLOCK)
    assert hole.depth == pytest.approx(0.06) and hole.open == (True, True)
    assert hole.loop.narrowest == pytest.approx(0.015) and hole.loop.reaches.max() == pytest.approx(0.0212, abs=1e-4)


def test_mouths_look_into_the_hole_from_both_sides() -> None:
    (hole,) = holes_of(BLOCK)
    left, right = hole.mouths(Pose([0.1, 0.2, 0.0]))
    assert left.p == pytest.approx([0.07, 0.2, 0.055]) and left.rotation()[:, 2] == pytest.approx([1, 0, 0])
    assert right.p == pytest.approx([0.13, 0.2, 0.055]) and right.rotation()[:, 2] == pytest.approx([-1, 0, 0])
    assert all(mouth.rotation()[2, 1] == pytest.approx(1) for mouth in (left, right))


@pytest.mark.parametrize(("room_m", "passes"), [(0.002, True), (0.004, True), (0.005, False)])
def test_a_shaft_passes_with_its_corners_away_from_the_wall(room_m: float, passes: bool) -> None:
    (shaft,), (hole,) = shafts_of(PEG), holes_of(BLOCK)
    assert hole.passes(shaft, room_m) is passes


@pytest.mark.parametrize("name", ["block", "mug", "cup"])
def test_what_has_neither_has_none(name: str) -> None:
    assert shafts_of(thing(name).asset) == [] and holes_of(thing(name).asset) == []


def test_a_groove_is_no_hole(monkeypatch: pytest.MonkeyPatch) -> None:
    open_above = [piece for piece in BLOCK.pieces if piece.vertices[:, 2].mean() < 0.06]
    for module in ("pegs", "holes"):
        monkeypatch.setattr(
            f"vcage.objects.{module}.material_along", lambda _, *line: material_along(open_above, *line)
        )
    assert holes_of(BLOCK) == []


def test_a_hole_with_a_bottom_has_one_mouth(monkeypatch: pytest.MonkeyPatch) -> None:
    corners = [(x, y, z) for x in (0.028, 0.032) for y in (-0.03, 0.03) for z in (0.03, 0.08)]
    closed = [*BLOCK.pieces, Convex.of(corners)]
    monkeypatch.setattr("vcage.objects.holes.material_along", lambda _, *line: material_along(closed, *line))
    (hole,) = holes_of(BLOCK)
    assert hole.open == (True, False) and hole.depth == pytest.approx(0.058)
    assert len(hole.mouths(Pose())) == 1
