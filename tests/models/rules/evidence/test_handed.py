"""Arms that reach out, seen from the customer's side."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from vcage.models.rules.evidence.handed import REACH, arms_out
from vcage.vision.protocols import View

WALL, LINK = (128, 128, 126), (190, 192, 196)
LEFT, RIGHT = (435, 190), (205, 190)
"""Bases of the robot's arms: its left is to the right in the customer's picture."""
HOME, MEETS, BY_THE_OTHER = "home", (320, 150), (250, 180)


def seen(left: str | tuple[int, int], right: str | tuple[int, int]) -> View:
    """A picture of grey arms before a grey wall, each at home over its base or out with its hand somewhere."""
    picture = np.full((480, 640, 3), WALL, dtype=np.uint8)
    for (u, v), hand in ((LEFT, left), (RIGHT, right)):
        if isinstance(hand, str):
            cv2.line(picture, (u, v), (u, v - 60), LINK, 45)
        else:
            cv2.line(picture, (u, v), (u, 60), LINK, 20)
            cv2.line(picture, (u, 60), hand, LINK, 30)
    return View(picture, None)  # pyrefly: ignore[bad-argument-type]


def test_two_narrow_grey_arms_before_a_grey_wall_both_reach_out():
    assert min(arms_out(seen(HOME, HOME), seen(MEETS, MEETS))) > REACH.reaches_share


@pytest.mark.parametrize(("left", "right", "idle"), [(MEETS, HOME, 1), (HOME, MEETS, 0)])
def test_an_arm_that_stays_at_home_does_not(left: str | tuple[int, int], right: str | tuple[int, int], idle: int):
    shares = arms_out(seen(HOME, HOME), seen(left, right))
    assert shares[idle] == 0 and shares[1 - idle] > REACH.reaches_share


def test_an_arm_that_crosses_to_the_other_side_is_not_taken_for_the_other_arm():
    left, right = arms_out(seen(HOME, HOME), seen(BY_THE_OTHER, HOME))
    assert left > REACH.reaches_share and right == 0
