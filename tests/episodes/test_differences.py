"""The picture of the differences between two critics: its views, and the marked words."""

from __future__ import annotations

import numpy as np
import pytest

from vcage.base.drawing import CAPTION, EDGE, VIEW, WARNING
from vcage.episodes.differences import draw_difference
from vcage.schema.episodes import Difference, Truth, Verdict

RED, GREEN, BLUE, GREY = (200, 0, 0), (0, 200, 0), (0, 0, 200), (120, 120, 120)


def plain(colour: tuple[int, int, int], width: int = 320) -> np.ndarray:
    """A picture in one colour, as wide as four thirds of its height."""
    return np.full((width * 3 // 4, width, 3), colour, dtype=np.uint8)


def difference(*, before: bool, now: bool, truth: bool, reason: str = "it lies there") -> Difference:
    def said(accepted: bool) -> Verdict:
        return Verdict(accepted=accepted, reason=reason, confidence=0.9, provider="offline")

    return Difference(
        episode=0, step=1, attempt=2, subtask="block_red-onto-plate", text="put the red block on the plate",
        earlier_verdict=said(before), verdict=said(now), truth=Truth(success=truth, reason="it does"), picture="x.png",
    )  # fmt: skip


def in_view(picture: np.ndarray, row: int, column: int) -> tuple[int, ...]:
    """The colour in the middle of a view."""
    v = EDGE + CAPTION + VIEW * 3 // 8 + row * (CAPTION + VIEW * 3 // 4 + EDGE)
    return tuple(picture[v, EDGE + VIEW // 2 + column * (VIEW + EDGE)].tolist())


@pytest.mark.parametrize("width", [320, 1280])
def test_before_and_after_stand_side_by_side_at_one_width(width):
    seen = {"after": {"top": plain(GREEN, width)}, "before": {"top": plain(RED, width)}}
    picture = draw_difference(difference(before=True, now=False, truth=True), seen)
    assert (in_view(picture, 0, 0), in_view(picture, 0, 1)) == (RED, GREEN)
    assert picture.shape[1] == 2 * VIEW + 3 * EDGE


def test_other_cameras_and_moments_follow_below():
    seen = {
        "before": {"top": plain(RED), "customer": plain(GREY)},
        "after": {"top": plain(GREEN), "customer": plain(GREY)},
        "moment": {"left": plain(BLUE)},
    }
    picture = draw_difference(difference(before=True, now=False, truth=True), seen)
    assert [in_view(picture, *at) for at in ((0, 0), (0, 1), (1, 0), (1, 1), (2, 0))] == [RED, GREEN, GREY, GREY, BLUE]


@pytest.mark.parametrize(("truth", "wrong"), [(True, "again"), (False, "while collecting")])
def test_the_verdict_that_the_state_does_not_bear_out_is_red(truth, wrong):
    seen = {"before": {"top": plain(GREY)}, "after": {"top": plain(GREY)}}
    picture = draw_difference(difference(before=True, now=False, truth=truth), seen)
    red = np.flatnonzero(np.all(picture == WARNING, axis=2).any(axis=1))
    lines = len(picture) - EDGE - 4 * 28 + np.array([28, 56])  # of the first verdict, and of the second
    line = lines[0] if wrong == "while collecting" else lines[1]
    assert line <= red.min() and red.max() < line + 28


def test_a_long_reason_is_written_on_several_lines():
    seen = {"before": {"top": plain(GREY)}, "after": {"top": plain(GREY)}}
    short = draw_difference(difference(before=True, now=False, truth=True), seen)
    long = draw_difference(difference(before=True, now=False, truth=True, reason="it lies there " * 30), seen)
    assert len(long) > len(short)
