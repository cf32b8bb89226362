"""Poured: a vessel was tipped in a hand, and all that lay in it lies in the container."""

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

POURED = Goal(subject="cup", relation="poured", reference="bowl")
BALLS = ("ball", "ball_2", "ball_3")


@dataclass
class Look:
    """A cup that leans by some degrees in a hand, or on the table, and where each ball lies."""

    lean_deg: float = 0.0
    held: bool = True
    lies: tuple[str, ...] = ("cup", "cup", "cup")
    lasted: float = 0.0
    balls: tuple[str, ...] = BALLS
    arms: tuple[str, ...] = ("left", "right")
    table_height: float = 0.74

    def thing(self, name: str) -> Any:
        half = np.radians(self.lean_deg) / 2
        pose = Pose([0.0, 0.0, 0.9 if self.held else 0.74], [np.cos(half), np.sin(half), 0.0, 0.0])
        return SimpleNamespace(pose=pose, lowest=pose.p[2])

    def touching(self, name: str) -> set[str]:
        return {"left" if self.held else "table"} if name == "cup" else set()

    def contents(self, name: str) -> tuple[str, ...]:
        return self.balls

    def lies_in(self, name: str, other: str) -> bool:
        return self.lies[BALLS.index(name)] == other

    def lasted_s(self, goal: Goal) -> float:
        return self.lasted


IN_BOWL = ("bowl", "bowl", "bowl")


def happens(*looks: Look) -> bool:
    """True if the event goes on at the last of some looks."""
    notes: set[str] = set()
    ask = KINDS["poured"].happens
    assert ask is not None
    return [ask(POURED, cast(State, look), notes) for look in looks][-1]


@pytest.mark.parametrize(
    ("looks", "poured"),
    [
        ((Look(), Look(110), Look(110, lies=IN_BOWL), Look(lies=IN_BOWL)), True),
        ((Look(), Look(lies=IN_BOWL)), False),
        ((Look(), Look(50), Look(lies=IN_BOWL)), False),
        ((Look(), Look(110, held=False), Look(lies=IN_BOWL)), False),
        ((Look(), Look(110), Look(lies=("bowl", "bowl", "cup"))), False),
        ((Look(), Look(110), Look(lies=("bowl", "bowl", "table"))), False),
    ],
)
def test_it_is_poured_once_all_lies_in_the_container_after_the_vessel_was_tipped_in_a_hand(
    looks: tuple[Look, ...], poured: bool
) -> None:
    assert happens(*looks) is poured


@pytest.mark.parametrize(
    ("look", "complaint"),
    [
        (Look(held=False, lies=IN_BOWL, lasted=2.0), None),
        (Look(held=False, lies=("bowl", "table", "bowl"), lasted=0.2), "2 of 3 that lay in cup lie in bowl, without"),
        (Look(held=False, lies=("cup", "cup", "cup")), "0 of 3 that lay in cup lie in bowl"),
        (Look(held=False, lies=IN_BOWL, lasted=0.0), "cup was not tipped in a hand until all lay in bowl"),
        (Look(90, held=False, lies=IN_BOWL, lasted=2.0), "cup does not stand upright on the table"),
        (Look(held=True, lies=IN_BOWL, lasted=2.0), "cup does not stand upright on the table"),
        (Look(balls=()), "nothing lay in cup"),
    ],
)
def test_the_complaint_counts_what_lies_in_the_container(look: Look, complaint: str | None) -> None:
    said = KINDS["poured"].complaint(POURED, cast(State, look))
    assert said is None if complaint is None else complaint in str(said)
