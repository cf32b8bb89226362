"""Wiped: a pad passed over the flat top of an object, which stayed where it was."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, cast

import pytest

from vcage.base.geometry import Pose
from vcage.goals import KINDS
from vcage.goals.kind import State
from vcage.schema.goals import Goal

WIPED = Goal(subject="tray", relation="wiped")


@dataclass
class Look:
    """A tray with ten cells, and those that a pad wipes now."""

    cells: tuple[int, ...] = ()
    x: float = 0.0
    yaw: float = 0.0
    lasted: float = 0.0
    total: int = 10

    def thing(self, name: str) -> Any:
        return SimpleNamespace(pose=Pose.from_yaw([self.x, 0.0, 0.74], self.yaw))

    def wiping(self, name: str) -> tuple[set[int], int]:
        return {*self.cells}, self.total

    def lasted_s(self, goal: Goal) -> float:
        return self.lasted


def happens(*looks: Look) -> bool:
    """True if the event goes on at the last of some looks."""
    notes: set[str] = set()
    ask = KINDS["wiped"].happens
    assert ask is not None
    return [ask(WIPED, cast(State, look), notes) for look in looks][-1]


@pytest.mark.parametrize(
    ("looks", "wiped"),
    [
        ((Look(), Look()), False),
        ((Look(), Look((0, 1, 2)), Look((3, 4, 5))), True),
        ((Look(), Look((0, 1, 2)), Look((3, 4, 5)), Look()), True),
        ((Look(), Look((0, 1, 2)), Look((0, 1, 2)), Look((0, 1, 2))), False),
        ((Look(), Look((0, 1, 2)), Look((3, 4, 5), x=0.005)), True),
        ((Look(), Look((0, 1, 2)), Look((3, 4, 5), x=0.02)), False),
        ((Look(), Look((0, 1, 2)), Look((3, 4, 5), yaw=0.3)), False),
        ((Look(), Look((0, 1, 2)), Look((3, 4, 5)), Look(x=0.02)), False),
        ((Look(), Look(x=0.3), Look((0, 1, 2), x=0.3), Look((3, 4, 5), x=0.3)), True),
        ((Look(total=0),), False),
    ],
    ids=[
        "untouched",
        "passed over",
        "left again",
        "one spot alone",
        "nudged",
        "pushed along",
        "turned",
        "pushed away afterwards",
        "moved before",
        "no flat top",
    ],
)
def test_what_a_pad_passed_over_is_wiped_for_as_long_as_it_stays(looks: tuple[Look, ...], wiped: bool) -> None:
    assert happens(*looks) is wiped


@pytest.mark.parametrize(
    ("lasted", "complaint"),
    [
        (1.6, None),
        (0.2, "tray did not stay where it was when it was wiped"),
        (0.0, "the pad of a tool in a hand did not pass over 60 %"),
    ],
)
def test_wiping_that_failed_says_how(lasted: float, complaint: str | None) -> None:
    told = KINDS["wiped"].complaint(WIPED, cast(State, Look(lasted=lasted)))
    assert told is None if complaint is None else (told or "").startswith(complaint)
