"""Pegs and loops, measured on convex pieces."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import thing
from vcage.base.geometry import Pose
from vcage.objects.openings import material_along
from vcage.objects.pegs import depth_through, loops_of, pegs_of

MUG, RACK = thing("mug").asset, thing("mug_rack").asset
LEFT, RIGHT = pegs_of(RACK)


def test_pegs_reach_from_the_tip_to_the_post_and_rise() -> None:
    for peg in (LEFT, RIGHT):
        assert peg.length == pytest.approx(0.09, abs=0.008) and peg.radius == pytest.approx(0.004, abs=2e-4)
        assert peg.axis[2] == pytest.approx(0.5, abs=1e-3)


def test_the_handle_of_a_mug_is_closed_all_around_for_physics_too() -> None:
    (loop,) = loops_of(MUG)
    assert 0.008 <= loop.narrowest <= 0.012 and 0.015 <= loop.up <= 0.02


@pytest.mark.parametrize("name", ["cup", "pot", "block"])
def test_what_has_no_closed_handle_has_no_loop(name: str) -> None:
    assert loops_of(thing(name).asset) == []


def test_a_loop_that_is_open_on_one_side_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    open_outside = [piece for piece in MUG.pieces if piece.vertices[:, 0].max() < 0.03]
    monkeypatch.setattr("vcage.objects.pegs.material_along", lambda _, *line: material_along(open_outside, *line))
    assert loops_of(MUG) == []


def _across(peg, depth: float, aside: float = 0.0) -> Pose:
    """A pose of the mug with its loop across a peg, its middle beside that."""
    (loop,) = loops_of(MUG)
    turned = Pose.from_yaw([0, 0, 0], -np.pi / 2 * np.sign(peg.axis[0]))
    return Pose(peg.at(depth) + [0.0, aside, 0.0] - turned.apply(loop.frame.p), turned.q)


@pytest.mark.parametrize("peg", [LEFT, RIGHT])
@pytest.mark.parametrize(
    ("depth", "aside", "through"),
    [(0.05, 0.0, True), (0.02, 0.007, True), (-0.02, 0.0, False), (0.05, 0.02, False), (0.12, 0.0, False)],
)
def test_a_peg_passes_through_a_loop_between_its_tip_and_the_post(peg, depth: float, aside: float, through: bool):
    (loop,) = loops_of(MUG)
    found = depth_through(peg, loop, _across(peg, depth, aside))
    assert (found is not None) == through
    assert not through or found == pytest.approx(depth, abs=1e-6)


@pytest.mark.parametrize("peg", [LEFT, RIGHT])
def test_no_peg_passes_through_the_handle_of_a_mug_beside_the_rack(peg) -> None:
    (loop,) = loops_of(MUG)
    assert depth_through(peg, loop, Pose([-0.1, 0.0, 0.0])) is None
