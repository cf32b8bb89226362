from __future__ import annotations

import numpy as np
import pytest

from vcage.sim.fingers import finger_drawings
from vcage.sim.robots import load_robot


@pytest.mark.parametrize("who", ["aloha_agilex", "dual_panda"])
def test_fingers_part_to_both_sides_of_the_picture_as_they_open(who: str) -> None:
    drawings = finger_drawings(load_robot(who), "left", "cam_left_wrist")
    middle = drawings[0].covered.shape[1] // 2
    closed, *_, wide = (drawing.covered for drawing in drawings)
    assert closed[:, middle - 1 : middle + 1].any() and not wide[:, middle - 1 : middle + 1].any()
    assert wide[:, :middle].any() and wide[:, middle:].any()
    gaps = [np.abs(np.argwhere(drawing.covered)[:, 1] + 0.5 - middle).min() for drawing in drawings]
    assert gaps == sorted(gaps)
