from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vcage.vision.networks.grounding_dino import clipped, corners, distinct, phrase, prompt_of
from vcage.vision.protocols import Detection

SHAPE = (480, 640, 3)


def found(*box: float) -> Detection:
    return Detection(box, None, 0.5)


def test_of_two_boxes_of_one_thing_the_better_stays() -> None:
    boxes = [found(0, 0, 10, 10), found(1, 0, 11, 10), found(30, 0, 40, 10)]
    assert distinct(boxes, 0.6) == [boxes[0], boxes[2]]


@pytest.mark.parametrize("box", [(5, 5, 5, 9), (700, 0, 900, 9), (np.nan, 0, 9, 9), (9, 9, 2, 2), (0, 0, 640, 480)])
def test_an_empty_box_or_one_as_large_as_the_table_is_refused(box: tuple) -> None:
    assert clipped(box, SHAPE, largest=0.5) is None


@given(st.lists(st.tuples(*[st.floats(0, 100)] * 4), max_size=40))
def test_no_two_remaining_boxes_overlap_much(raw: list[tuple]) -> None:
    left = distinct([found(min(a, c), min(b, d), max(a, c), max(b, d)) for a, b, c, d in raw], 0.5)
    for (a, b, c, d), (u0, v0, u1, v1) in combinations([one.box for one in left], 2):
        shared = max(min(c, u1) - max(a, u0), 0) * max(min(d, v1) - max(b, v0), 0)
        assert shared <= 0.5 * ((c - a) * (d - b) + (u1 - u0) * (v1 - v0) - shared) + 1e-6


def test_centres_and_sizes_become_corners_in_pixels() -> None:
    assert np.allclose(corners(np.array([[0.5, 0.5, 0.5, 0.25]]), SHAPE), [[160, 180, 480, 300]])


def test_a_prompt_ends_every_name_with_a_full_stop_and_knows_where_each_stands() -> None:
    text, spans = prompt_of(["Red Block", "mug no. 2"])
    assert text == "red block. mug no 2."
    assert [text[a:b] for a, b in spans] == ["red block", "mug no 2"]
    assert phrase(" ? . ") == ""
