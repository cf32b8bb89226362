"""Arms that reach out, seen from above."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from vcage.models.rules.evidence.handed import REACH, arms_out
from vcage.vision.protocols import View

TABLE, LINK = (128, 128, 126), (190, 192, 196)
LEFT, RIGHT = ((170, 479), (290, 250)), ((520, 479), (430, 250))


def seen(*arms: tuple[tuple[int, int], tuple[int, int]], width: int = 45) -> View:
    """A picture of a table with arms that are grey as it is, from their bases to their hands."""
    picture = np.full((480, 640, 3), TABLE, dtype=np.uint8)
    for base, hand in arms:
        cv2.line(picture, base, hand, LINK, width)
    return View(picture, None)  # pyrefly: ignore[bad-argument-type]


def test_two_narrow_grey_arms_over_a_grey_table_both_reach_out():
    assert min(arms_out(seen(), seen(LEFT, RIGHT))) > REACH.reaches_share


@pytest.mark.parametrize(("arm", "idle"), [(LEFT, 1), (RIGHT, 0)])
def test_an_arm_that_stays_at_home_does_not(arm: tuple[tuple[int, int], tuple[int, int]], idle: int):
    assert arms_out(seen(), seen(arm))[idle] == 0


def test_an_arm_that_crosses_to_the_other_side_is_not_taken_for_the_other_arm():
    left, right = arms_out(seen(), seen(((500, 479), (230, 330)), width=60))
    assert left == 0 and right > REACH.reaches_share
