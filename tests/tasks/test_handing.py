"""What a watch makes of who touches a thing: a hand-over is one in the air."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from tests.example_scenes import thing, world_of
from vcage.schema.goals import Goal
from vcage.tasks.state import Watch
from vcage.tasks.truth import goals_hold

GOAL = Goal(subject="hammer", relation="handed", reference="right")


def told_of(monkeypatch: pytest.MonkeyPatch, holders: Sequence[str]) -> tuple[bool, str]:
    """What the truth says when so many things in turn touch a hammer, each for half a second."""
    hammer = thing("hammer")
    world = world_of([hammer])
    watch = Watch(world, {"hammer": hammer}, [GOAL])
    for names in holders:
        touching = {f"{name}/finger" if name in world.arms else name for name in names.split()}
        monkeypatch.setattr(world, "touching", lambda _name, touching=touching: touching)
        monkeypatch.setattr(world, "holds", lambda arm, _name, names=names: arm in names.split())
        world.step(125)
    found = goals_hold([GOAL], watch)
    return found.success, found.reason


@pytest.mark.parametrize(
    ("holders", "handed"),
    [
        (["table", "left", "left right", "right", "table"], True),
        (["table", "left", "right"], True),
        (["table", "left", "table", "right"], False),
        (["table", "left", "", "right"], False),
        (["table", "left", "left right table", "right"], False),
        (["table", "right", "table"], False),
        (["table", "left", "left right", "left"], False),
        (["table", "right", "right left", "left"], False),
    ],
)
def test_a_thing_is_handed_over_when_hands_alone_hold_it(monkeypatch, holders: list[str], handed: bool):
    success, reason = told_of(monkeypatch, holders)
    assert success is handed
    assert handed or reason == "the right arm did not take hammer from the hand of another"
