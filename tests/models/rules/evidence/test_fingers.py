from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from vcage.models.protocols import CriticQuestion
from vcage.models.rules.evidence.fingers import fingers_touch
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


def touch(who: str, *seen: np.ndarray) -> bool | None:
    question = CriticQuestion("x", [], {}, {}, fingers=lambda camera: drawn(who))
    return fingers_touch(question, {f"{CAMERA} {number}": one for number, one in enumerate(seen)})


@ROBOTS
@pytest.mark.parametrize("light", [0.7, 0.8, 1.1])
def test_closed_fingers_touch(who: str, light: float) -> None:
    assert touch(who, picture(who, 0, light=light)) is True


@ROBOTS
@pytest.mark.parametrize("between", [TABLE, RED])
def test_fingers_that_are_a_little_apart_do_not_touch(who: str, between: tuple[int, int, int]) -> None:
    assert touch(who, picture(who, 1, between)) is not True


@ROBOTS
@pytest.mark.parametrize("between", [TABLE, RED])
@pytest.mark.parametrize("opening", [5, 10])
def test_fingers_that_are_apart_are_told_whatever_is_between(
    who: str, opening: int, between: tuple[int, int, int]
) -> None:
    assert touch(who, picture(who, opening, between)) is False


@ROBOTS
@pytest.mark.parametrize("colour", [TABLE, RED])
def test_fingers_that_are_out_of_sight_are_not_apart(who: str, colour: tuple[int, int, int]) -> None:
    assert touch(who, np.full_like(drawn(who)[0].picture, colour)) is None


@ROBOTS
def test_a_thing_as_grey_as_the_fingers_between_them_is_not_taken_for_touching_ones(who: str) -> None:
    closed = drawn(who)[0]
    grey = (LIGHT * np.median(closed.picture[closed.covered], axis=0)).astype(int)
    assert touch(who, picture(who, 6, (int(grey[0]), int(grey[1]), int(grey[2])))) is not True


@ROBOTS
def test_nothing_false_is_told_before_a_table_of_the_colour_of_the_fingers(who: str) -> None:
    closed = drawn(who)[0]
    grey = (LIGHT * np.median(closed.picture[closed.covered], axis=0)).astype(int).tolist()
    assert touch(who, picture(who, 14, table=grey)) is None
    assert touch(who, picture(who, 0, table=grey)) is not False


@ROBOTS
def test_fingers_of_which_a_part_is_hidden_do_not_surely_touch(who: str) -> None:
    closed, seen = drawn(who)[0].covered, picture(who, 0)
    rows, columns = np.nonzero(closed)
    hidden = slice(0, len(rows) // 20)
    seen[rows[hidden], columns[hidden]] = RED
    assert touch(who, seen) is None


@ROBOTS
@pytest.mark.parametrize("shift", [(4, 0), (-8, 8), (0, -12)])
def test_closed_fingers_are_not_apart_for_a_camera_that_was_moved_a_little(who: str, shift: tuple[int, int]) -> None:
    # Four pixels of the picture are one reduced pixel.
    moved = np.roll(picture(who, 0), shift, axis=(0, 1))
    assert touch(who, moved) is not False


def test_of_two_hands_one_with_closed_fingers_is_enough() -> None:
    closed, apart = (picture("aloha_agilex", opening, RED) for opening in (0, 8))
    assert touch("aloha_agilex", apart, closed) is True
    assert touch("aloha_agilex", apart, apart) is False


def test_two_hands_are_not_both_apart_where_one_does_not_tell() -> None:
    closed = drawn("aloha_agilex")[0]
    grey = (LIGHT * np.median(closed.picture[closed.covered], axis=0)).astype(int).tolist()
    assert touch("aloha_agilex", picture("aloha_agilex", 8, RED), picture("aloha_agilex", 0, table=grey)) is None


def test_nothing_is_told_by_a_camera_that_hardly_sees_closed_fingers() -> None:
    hidden = [replace(drawn("aloha_agilex")[0], covered=np.zeros((240, 320), bool)), *drawn("aloha_agilex")[1:]]
    question = CriticQuestion("x", [], {}, {}, fingers=lambda camera: hidden)
    assert fingers_touch(question, {CAMERA: picture("aloha_agilex", 1)}) is None


def test_nothing_is_told_without_drawings_of_the_fingers_or_without_pictures() -> None:
    for fingers in (None, lambda camera: ()):
        question = CriticQuestion("x", [], {}, {}, fingers=fingers)
        assert fingers_touch(question, {CAMERA: picture("aloha_agilex", 0)}) is None
    assert touch("aloha_agilex") is None
