"""A place that an object has left, seen in pictures with it and without."""

from __future__ import annotations

import numpy as np

from vcage.models.rules.evidence.vacated import vacated
from vcage.vision.protocols import View

OUTLINE = np.zeros((40, 40), bool)
OUTLINE[10:30, 10:30] = True


def seen(colour: tuple[int, int, int]) -> View:
    picture = np.full((40, 40, 3), 128, np.uint8)
    picture[OUTLINE] = colour
    return View(picture, None)  # pyrefly: ignore[bad-argument-type]


THERE, GONE = seen((200, 30, 30)), seen((128, 128, 128))


def test_a_place_that_looks_as_without_the_object_was_left():
    assert vacated(THERE, GONE, GONE, OUTLINE) == 1
    assert vacated(THERE, THERE, GONE, OUTLINE) == 0


def test_pictures_that_do_not_differ_there_tell_nothing():
    assert vacated(GONE, THERE, GONE, OUTLINE) is None
