"""Hit: a head came down on an object, which stayed where it was."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from vcage.base.geometry import Pose
from vcage.goals import KINDS
from vcage.goals.kind import State
from vcage.schema.goals import Goal

HIT = Goal(subject="block", relation="hit")


@dataclass
class Look:
    """A block, and whether the head of a tool is on it."""

    on: bool = False
    x: float = 0.0
    lean_deg: float = 0.0
    lasted: float = 0.0

    def thing(self, name: str) -> Any:
        half = np.radians(self.lean_deg) / 2
        return SimpleNamespace(pose=Pose([self.x, 0.0, 0.74], [np.cos(half), 0, np.sin(half), 0]))

    def is_hit(self, name: str) -> bool:
        return self.on

    def lasted_s(self, goal: Goal) -> float:
        return self.lasted


def happens(*looks: Look) -> bool:
    """True if the event goes on at the last of some looks."""
    notes: set[str] = set()
    ask = KINDS["hit"].happens
    assert ask is not None
    return [ask(HIT, cast(State, look), notes) for look in looks][-1]


@pytest.mark.parametrize(
    ("looks", "hit"),
    [
        ((Look(), Look()), False),
        ((Look(), Look(on=True)), True),
        ((Look(), Look(on=True), Look()), True),
        ((Look(on=True),), False),
        ((Look(), Look(on=True), Look(x=0.01)), True),
        ((Look(), Look(on=True), Look(x=0.03)), False),
        ((Look(), Look(on=True), Look(x=0.03, on=True), Look(x=0.03, on=True)), False),
        ((Look(), Look(on=True), Look(x=0.03, on=True), Look(x=0.03), Look(x=0.03, on=True)), True),
        ((Look(), Look(on=True), Look(lean_deg=40)), False),
        ((Look(), Look(x=0.3), Look(x=0.3, on=True)), True),
    ],
    ids=[
        "untouched",
        "touched",
        "left again",
        "not seen before",
        "nudged",
        "swept away",
        "pushed along under the head",
        "pushed and hit anew",
        "knocked over",
        "moved before",
    ],
)
def test_what_a_head_touched_is_hit_for_as_long_as_it_stays(looks: tuple[Look, ...], hit: bool) -> None:
    assert happens(*looks) is hit


@pytest.mark.parametrize(
    ("lasted", "complaint"),
    [
        (1.6, None),
        (0.2, "block did not stay where it was when it was hit"),
        (0.0, "no head of a tool in a hand touched"),
    ],
)
def test_a_hit_that_failed_says_how(lasted: float, complaint: str | None) -> None:
    told = KINDS["hit"].complaint(HIT, cast(State, Look(lasted=lasted)))
    assert told is None if complaint is None else (told or "").startswith(complaint)
