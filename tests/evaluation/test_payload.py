"""Observations in the words of policies."""

from __future__ import annotations

import numpy as np
import pytest

from vcage.base.errors import UsageError
from vcage.evaluation.payload import payload

PICTURE = np.zeros((4, 6, 3), np.uint8)


def seen(size: int, *cameras: str) -> dict[str, object]:
    return {"agent_pos": np.zeros(size), "pixels": dict.fromkeys(cameras, PICTURE), "instruction": "Open the drawer."}


@pytest.mark.parametrize(
    ("observation", "complaint"),
    [
        (seen(16, "cam_high"), "a state of 16 numbers is not ALOHA's"),
        (seen(14, "front"), "needs pictures of cam_high; there are front"),
        (seen(14), "there are none"),
    ],
)
def test_what_aloha_cannot_say_is_refused(observation: dict[str, object], complaint: str) -> None:
    with pytest.raises(UsageError, match=complaint) as caught:
        payload(observation, "aloha")
    assert "--payload generic" in caught.value.hint


def test_cameras_that_aloha_does_not_know_are_left_out() -> None:
    assert list(payload(seen(14, "cam_high", "front", "cam_left_wrist"), "aloha")["images"]) == [
        "cam_high",
        "cam_left_wrist",
    ]
