"""Checks 2 and 4 find what does not stand; a probe stays where it can, and the check says where it went."""

from __future__ import annotations

import numpy as np

from tests.apps.proof.conftest import CUBE, TRAY, inside
from vcage.apps.proof.releasing import check_functional, check_rest, probe_cube
from vcage.schema.scene import Table


def test_a_probe_stays_in_a_tray(make) -> None:
    check = check_functional(make(TRAY, functional=[inside()]), inside(), Table(), tries=3, seed=0)
    assert (check.passed, check.succeeded) == (True, 3), check.reasons


def test_a_probe_stays_on_a_cube(make) -> None:
    top = inside(name="top", holds="on", position=(0, 0, 0.04))
    check = check_functional(make(CUBE, mass=0.2, functional=[top]), top, Table(), tries=3, seed=0)
    assert check.passed, check.reasons
    assert check.measured["probe_mm"] == 24


def test_a_light_board_on_a_narrow_foot_tips_under_the_probe(make) -> None:
    board = [[(-0.004, -0.004, 0), (0.004, 0.004, 0.03)], [(-0.08, -0.04, 0.03), (0.08, 0.04, 0.033)]]
    end = inside(name="end", holds="on", position=(0.06, 0, 0.033))
    check = check_functional(make(board, mass=0.01, functional=[end]), end, Table(), tries=3, seed=0)
    assert not check.passed and check.succeeded == 0


def test_a_point_inside_the_material_is_refused(make) -> None:
    check = check_functional(make(CUBE), inside(position=(0, 0, 0.02)), Table(), tries=3, seed=0)
    assert not check.passed and check.tries == 0


def test_a_probe_is_made_once() -> None:
    assert probe_cube(0.03) is probe_cube(0.03)
    assert probe_cube(0.03).size.round(4).tolist() == [0.03, 0.03, 0.03]


def test_a_cube_stands(make) -> None:
    check = check_rest(make(CUBE), Table(), yaw=0.3)
    assert check.passed and check.measured["seconds"] < 0.5


def test_a_tray_stands(make) -> None:
    assert check_rest(make(TRAY), Table(), yaw=1.0).passed


def test_a_thing_that_tips_over_fails(make) -> None:
    leaning = [[(-0.005, -0.01, 0), (0.005, 0.01, 0.05)], [(0.005, -0.01, 0.05), (0.08, 0.01, 0.06)]]
    check = check_rest(make(leaning), Table(), yaw=0.0)
    assert not check.passed
    assert check.measured["tilt_deg"] > np.degrees(0.1)
