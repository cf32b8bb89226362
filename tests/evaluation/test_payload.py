"""Observations in the words of policies."""

from __future__ import annotations

import numpy as np
import pytest

from vcage.base.errors import UsageError
from vcage.evaluation.payload import names_in, payload, require_possible

PICTURE = np.zeros((4, 6, 3), np.uint8)


def seen(size: int, *cameras: str) -> dict[str, object]:
    return {"agent_pos": np.zeros(size), "pixels": dict.fromkeys(cameras, PICTURE), "instruction": "Open the drawer."}


@pytest.mark.parametrize(
    ("numbers", "cameras", "complaint"),
    [
        (16, ["cam_high"], "a state of 16 numbers is not ALOHA's"),
        (14, ["front"], "needs pictures of cam_high; there are front"),
        (14, [], "there are none"),
    ],
)
def test_what_aloha_cannot_say_is_refused(numbers: int, cameras: list[str], complaint: str) -> None:
    with pytest.raises(UsageError, match=complaint) as caught:
        require_possible("aloha", numbers, cameras)
    assert "--payload generic" in caught.value.hint
    require_possible("generic", numbers, cameras)


def test_fields_are_named_with_the_cameras_in_them() -> None:
    sent = payload(seen(14, "cam_high", "cam_left_wrist"), "aloha")
    assert names_in(sent) == ["state", "images/cam_high", "images/cam_left_wrist", "prompt"]


def test_cameras_that_aloha_does_not_know_are_left_out() -> None:
    assert list(payload(seen(14, "cam_high", "front", "cam_left_wrist"), "aloha")["images"]) == [
        "cam_high",
        "cam_left_wrist",
    ]
