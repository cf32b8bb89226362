from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from vcage.models.protocols import CriticQuestion
from vcage.models.rules.evidence.fingers import closed_on_nothing
from vcage.sim.drawer import Drawing
from vcage.sim.robots import load_robot
from vcage.tasks.hand_views import finger_views

CAMERA, LIGHT = "cam_left_wrist", 0.8
TABLE, RED = (190, 150, 110), (200, 30, 30)

ROBOTS = pytest.mark.parametrize("who", ["aloha_agilex", "dual_panda"])


def drawn(who: str) -> Sequence[Drawing]:
    return finger_views(load_robot(who), CAMERA)


def picture(
    who: str,
    opening: int,
    between: tuple[int, int, int] | None = None,
    light: float = LIGHT,
    table: Sequence[int] = TABLE,
) -> np.ndarray:
    """The fingers at one of their openings before a table, with something of a colour between them."""
    fingers = drawn(who)[opening]
    seen = np.full(fingers.picture.shape, table, np.uint8)
    if between is not None:
        columns = np.flatnonzero(fingers.covered.any(axis=0))
        seen[fingers.covered.any(axis=1), columns.min() : columns.max()] = between
    seen[fingers.covered] = np.clip(light * fingers.picture[fingers.covered], 0, 255)
    return seen


def is_closed(who: str, seen: np.ndarray) -> bool:
    question = CriticQuestion("x", [], {}, {}, fingers=lambda camera: drawn(who))
    return closed_on_nothing(question, {CAMERA: seen})


@ROBOTS
@pytest.mark.parametrize("light", [0.7, 0.8, 1.1])
def test_fingers_that_touch_have_closed_on_nothing(who: str, light: float) -> None:
    assert is_closed(who, picture(who, 0, light=light))


@ROBOTS
@pytest.mark.parametrize("between", [TABLE, RED])
@pytest.mark.parametrize("opening", [1, 5, 10])
def test_fingers_that_are_apart_have_not_closed_on_nothing(
    who: str, opening: int, between: tuple[int, int, int]
) -> None:
    assert not is_closed(who, picture(who, opening, between))


@ROBOTS
def test_closed_fingers_are_not_detected_before_a_table_of_their_colour(who: str) -> None:
    closed = drawn(who)[0]
    grey = (LIGHT * np.median(closed.picture[closed.covered], axis=0)).astype(int).tolist()
    assert not is_closed(who, picture(who, 14, table=grey))
    assert not is_closed(who, picture(who, 0, table=grey))


def test_closed_fingers_are_not_detected_by_a_camera_that_hardly_sees_them() -> None:
    hidden = [replace(drawn("aloha_agilex")[0], covered=np.zeros((240, 320), bool)), *drawn("aloha_agilex")[1:]]
    question = CriticQuestion("x", [], {}, {}, fingers=lambda camera: hidden)
    assert not closed_on_nothing(question, {CAMERA: picture("aloha_agilex", 1)})


def test_closed_fingers_are_not_detected_without_drawings_of_them() -> None:
    for fingers in (None, lambda camera: ()):
        question = CriticQuestion("x", [], {}, {}, fingers=fingers)
        assert not closed_on_nothing(question, {CAMERA: picture("aloha_agilex", 0)})
