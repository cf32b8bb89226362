"""Check 2 finds what does not stand."""

from __future__ import annotations

import numpy as np

from tests.apps.proof.conftest import CUBE, TRAY
from vcage.apps.proof.rest import check_rest
from vcage.schema.scene import Table


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
