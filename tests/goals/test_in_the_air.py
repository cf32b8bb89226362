"""Lifted, shaken, held up: what one arm does with an object in the air."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from vcage.base.geometry import Pose
from vcage.goals import KINDS
from vcage.goals.kind import State
from vcage.schema.goals import Goal

UP = 0.1


@dataclass
class Held:
    """An object in a hand, or on the table, that leans about the y axis, or about one at an angle from it."""

    lean_deg: float = 0.0
    height: float = UP
    holders: set[str] = field(default_factory=lambda: {"left"})
    around: dict[str, set[str]] = field(default_factory=dict)
    arms: tuple[str, ...] = ("left", "right")
    table_height: float = 0.74
    axis_deg: float = 0.0

    def touching(self, name: str) -> set[str]:
        return self.around.get(name, self.holders)

    def thing(self, name: str) -> Any:
        half, axis = np.radians(self.lean_deg) / 2, np.radians(self.axis_deg)
        q = [np.cos(half), np.sin(half) * np.sin(axis), np.sin(half) * np.cos(axis), 0]
        return SimpleNamespace(lowest=0.74 + self.height, pose=Pose(q=q))

    def at_start(self, name: str) -> Any:
        return SimpleNamespace(pose=Pose())


def goal(word: str) -> Goal:
    return Goal(subject="bottle", relation=word)


def happens(word: str, *states: Held) -> bool:
    """True if the event goes on in the last of some states."""
    notes: set[str] = set()
    ask = KINDS[word].happens
    assert ask is not None
    return [ask(goal(word), cast(State, state), notes) for state in states][-1]


@pytest.mark.parametrize(
    ("state", "lifted"),
    [
        (Held(), True),
        (Held(height=0.01), False),
        (Held(holders={"left", "right"}), False),
        (Held(holders={"left", "table"}), False),
        (Held(holders=set()), False),
    ],
)
def test_one_arm_alone_lifts_what_is_in_the_air(state: Held, lifted: bool):
    assert happens("lifted", state) is lifted
    assert (KINDS["held_up"].complaint(goal("held_up"), cast(State, state)) is None) is lifted


@pytest.mark.parametrize(
    ("around", "held"),
    [
        ({"lemon": {"bottle"}}, True),
        ({"lemon": {"bottle", "table"}}, False),
        ({"lemon": {"bottle", "right"}}, False),
    ],
    ids=["in it", "on the table", "in the other hand"],
)
def test_what_lies_in_a_thing_is_held_up_with_it(around: dict[str, set[str]], held: bool):
    state = Held(holders={"left", *around}, around=around)
    assert (KINDS["held_up"].complaint(goal("held_up"), cast(State, state)) is None) is held


@pytest.mark.parametrize(
    ("state", "held"),
    [
        (Held(holders={"left", "right"}), True),
        (Held(holders={"left"}), False),
        (Held(holders={"left", "right"}, height=0.01), False),
        (Held(holders={"left", "right"}, lean_deg=20), False),
        (Held(holders={"left", "right", "table"}), False),
    ],
)
def test_two_arms_together_hold_what_is_level_in_the_air(state: Held, held: bool):
    assert (KINDS["held_by_both"].complaint(goal("held_by_both"), cast(State, state)) is None) is held


def test_what_leans_to_and_fro_in_the_air_is_shaken():
    assert happens("shaken", *(Held(lean) for lean in (0, 20, 0, -20, 0, 20)))


@pytest.mark.parametrize(
    "states",
    [
        [Held(lean) for lean in (0, 20, 0, -20, 0)],
        [Held(lean) for lean in (20, 0, 20, 0, 20, 0)],
        [Held(lean) for lean in (10, -10, 10, -10, 10)],
        [Held(20), Held(-20), Held(0, height=0.0), Held(20)],
    ],
    ids=["too few times", "to one side", "too little", "put down in between"],
)
def test_less_than_that_is_no_shaking(states: list[Held]):
    assert not happens("shaken", *states)


def test_a_lean_at_the_lift_does_not_hide_a_shake_that_leans_across_it():
    """A thing that drooped to the front when it was lifted leans to the left and right when it is shaken."""
    leans = [(24, 90), (20, 10), (-20, -10), (20, 10)]
    assert happens("shaken", *(Held(lean, axis_deg=axis) for lean, axis in leans))
