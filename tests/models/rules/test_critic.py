from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.models.tabletop import (
    BLOCKS,
    BOX,
    BREADS,
    ERASER,
    MARKERS,
    PLATE,
    WHITE_BOX,
    Thing,
    critic_question,
)
from vcage.base.errors import InputFileError
from vcage.base.geometry import Pose
from vcage.models.rules.critic import OfflineCritic
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Statement

pytestmark = pytest.mark.slow

BREAD_BOX = BOX.moved(id="bread-box", colour=(150, 100, 60))
SCENES = {
    "box": [BOX, *MARKERS, ERASER],
    "white-box": [WHITE_BOX, *MARKERS, ERASER],
    "plate": [PLATE, *BLOCKS],
    "bread-box": [BREAD_BOX, *BREADS],
}
TWO = ("box", "plate")
"""Of the scenes, for what is rejected in all of them alike."""

PLACES = [(-0.05, 0.03), (0.05, -0.03), (0.0, 0.0), (0.02, 0.05)]


def judge(before: list[Thing], after: list[Thing], thing: Thing) -> Verdict:
    place = before[0]
    relation = "on" if place is PLATE else "inside"
    goal = Goal(subject=thing.id, relation=relation, reference=place.id)
    return OfflineCritic().judge(critic_question(before, after, goal))


def placed(thing: Thing, place: Thing, index: int) -> Thing:
    dx, dy = PLACES[index % len(PLACES)]
    base = place.size[2] if place is PLATE else 0.005
    return thing.moved(at=(place.at[0] + dx, place.at[1] + dy), yaw=thing.yaw + 0.5, base=base)


def swapped(things: list[Thing], old: Thing, new: Thing | None) -> list[Thing]:
    return [t if t is not old else new for t in things if t is not old or new is not None]


def earlier(name: str, index: int) -> tuple[list[Thing], Thing]:
    """The scene with all earlier contents already put away, and the next thing to move."""
    place, *things = SCENES[name]
    return [place, *[placed(t, place, i) if i < index else t for i, t in enumerate(things)]], things[index]


CASES = [(name, index) for name, scene in SCENES.items() for index in range(len(scene) - 1)]


@pytest.mark.parametrize(("name", "index"), CASES)
def test_a_thing_that_was_put_away_is_accepted_also_beside_earlier_ones(name: str, index: int) -> None:
    before, thing = earlier(name, index)
    verdict = judge(before, swapped(before, thing, placed(thing, before[0], index)), thing)
    assert verdict.accepted, verdict.reason


@pytest.mark.parametrize("box", [BOX.moved(yaw=yaw) for yaw in (0.0, 0.3, 1.57)], ids=lambda box: f"{box.yaw}")
@pytest.mark.parametrize("wall", [(0.1, 0.0), (-0.1, 0.0), (0.0, 0.068)], ids=["right", "left", "back"])
def test_a_thing_that_lies_along_a_wall_of_a_box_of_the_tables_colour_is_accepted(box: Thing, wall: tuple) -> None:
    turn = Pose.from_yaw((*box.at, 0), box.yaw)
    red, black = MARKERS[1], MARKERS[0]
    at = tuple(turn.apply(np.array([*wall, 0]))[:2])
    along = black.moved(at=at, yaw=box.yaw + (np.pi / 2 if wall[0] else 0), base=0.005)
    inside = red.moved(at=(box.at[0] - 0.02, box.at[1] - 0.02), yaw=box.yaw, base=0.005)
    before, after = [box, inside, black, ERASER], [box, inside, along, ERASER]
    goal = Goal(subject=black.id, relation="inside", reference=box.id)
    verdict = OfflineCritic().judge(critic_question(before, after, goal))
    assert verdict.accepted, verdict.reason


@pytest.mark.parametrize("name", SCENES)
def test_a_thing_that_was_left_where_it_was_is_rejected(name: str) -> None:
    before, thing = earlier(name, 1)
    verdict = judge(before, before, thing)
    assert not verdict.accepted and "still lies where it was" in verdict.reason


@pytest.mark.parametrize("name", TWO)
def test_a_thing_that_lies_beside_the_receptacle_is_rejected(name: str) -> None:
    before, thing = earlier(name, 1)
    beside = thing.moved(at=(before[0].at[0] - 0.22, before[0].at[1]))
    assert not judge(before, swapped(before, thing, beside), thing).accepted


@pytest.mark.parametrize("name", TWO)
def test_a_vanished_object_is_rejected(name: str) -> None:
    before, thing = earlier(name, 1)
    assert not judge(before, swapped(before, thing, None), thing).accepted


@pytest.mark.parametrize("name", TWO)
def test_another_thing_in_its_place_is_rejected(name: str) -> None:
    before, thing = earlier(name, 1)
    other = before[3]
    assert not judge(before, swapped(before, other, placed(other, before[0], 1)), thing).accepted


def test_a_receptacle_that_was_pushed_a_little_still_counts() -> None:
    before, thing = earlier("box", 0)
    pushed = BOX.moved(at=(BOX.at[0] + 0.02, BOX.at[1] + 0.01))
    after = [pushed, placed(thing, pushed, 0), *before[2:]]
    verdict = judge(before, after, thing)
    assert verdict.accepted, verdict.reason


def test_a_vanished_receptacle_is_rejected() -> None:
    before, thing = earlier("plate", 0)
    assert not judge(before, [t for t in before[1:] if t is not thing], thing).accepted


@pytest.mark.parametrize("name", TWO)
def test_another_thing_that_was_moved_on_the_way_is_seen(name: str) -> None:
    before, thing = earlier(name, 0)
    other = before[3]
    after = swapped(swapped(before, thing, placed(thing, before[0], 0)), other, other.moved(at=(0.1, -0.2)))
    verdict = judge(before, after, thing)
    assert not verdict.accepted and f"no longer where it stood: the {other.id}" in verdict.reason


@pytest.mark.parametrize("name", TWO)
def test_a_black_picture_is_never_a_yes(name: str) -> None:
    before, thing = earlier(name, 1)
    place = before[0]
    goal = Goal(subject=thing.id, relation="on" if place is PLATE else "inside", reference=place.id)
    asked = critic_question(before, swapped(before, thing, placed(thing, place, 1)), goal)
    black = {"top": replace(asked.after["top"], picture=np.zeros_like(asked.after["top"].picture))}
    assert not OfflineCritic().judge(replace(asked, after=black)).accepted
    assert not OfflineCritic().judge(replace(asked, before=black, after=black)).accepted


def test_a_vanished_box_of_the_tables_colour_is_rejected() -> None:
    before, thing = earlier("white-box", 0)
    fell = placed(thing, before[0], 0).moved(base=0.0)
    verdict = judge(before, [fell, *before[2:]], thing)
    assert not verdict.accepted and "moved away" in verdict.reason


def test_another_box_of_the_tables_colour_that_was_moved_on_the_way_is_seen() -> None:
    before, thing = earlier("plate", 0)
    other = WHITE_BOX.moved(at=(-0.35, 0.1))
    after = swapped(before, thing, placed(thing, before[0], 0))
    verdict = judge([*before, other], [*after, other.moved(at=(-0.35, -0.1))], thing)
    assert not verdict.accepted and f"no longer where it stood: the {other.id}" in verdict.reason


def test_a_white_thing_in_a_white_box_is_seen() -> None:
    thing = Thing("sponge", (226, 224, 218), (0.06, 0.04, 0.03), at=(0.1, -0.2))
    verdict = judge([WHITE_BOX, thing], [WHITE_BOX, placed(thing, WHITE_BOX, 0)], thing)
    assert verdict.accepted, verdict.reason


def test_a_thing_that_balances_on_the_edge_is_rejected() -> None:
    before, thing = earlier("plate", 0)
    across = thing.moved(at=(PLATE.at[0] + 0.71 * PLATE.size[0] / 2 - 0.002, PLATE.at[1]), base=PLATE.size[2])
    verdict = judge(before, swapped(before, thing, across), thing)
    assert not verdict.accepted and "across the edge" in verdict.reason


def test_a_missing_reference_is_named() -> None:
    before, thing = earlier("box", 0)
    goal = Goal(subject=thing.id, relation="inside", reference="box")
    with pytest.raises(InputFileError, match=thing.id):
        OfflineCritic().judge(replace(critic_question(before, before, goal), references={}))


def test_a_reference_that_must_have_stayed_is_named_when_it_was_moved() -> None:
    block, goal = BLOCKS[0], Goal(subject=BLOCKS[0].id, relation="left_of", reference="plate")
    beside = block.moved(at=(PLATE.at[0] - 0.17, PLATE.at[1]))
    for shift, accepted in ((0.0, True), (0.14, False)):
        moved = PLATE.moved(at=(PLATE.at[0] + shift, PLATE.at[1]))
        question = critic_question([PLATE, *BLOCKS], [moved, beside, *BLOCKS[1:]], goal)
        told = replace(question, statements=[Statement(subject="plate", word="unmoved")])
        verdict = OfflineCritic().judge(told)
        assert verdict.accepted is accepted
        assert accepted or verdict.reason == "no longer where it stood: the plate"


def test_nothing_is_claimed_about_objects_hidden_from_above() -> None:
    block, goal = BLOCKS[0], Goal(subject=BLOCKS[0].id, relation="left_of", reference="plate")
    beside = block.moved(at=(PLATE.at[0] - 0.17, PLATE.at[1]))
    question = critic_question([PLATE, *BLOCKS], [PLATE, beside, *BLOCKS[1:]], goal)
    inside = Statement(subject=BLOCKS[1].id, word="inside", reference="plate")
    assert OfflineCritic().judge(replace(question, statements=[inside])) == OfflineCritic().judge(question)
