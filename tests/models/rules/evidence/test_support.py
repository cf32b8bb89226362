"""Stacks, tall supports and white things on white ones: what hides or resembles what."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.models.tabletop import BLOCKS, ERASER, HEIGHT, Thing, critic_question, draw
from vcage.base.geometry import Camera, Pose, box_corners, look_at
from vcage.models.protocols import CriticQuestion
from vcage.models.rules.critic import OfflineCritic
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.vision.protocols import View

pytestmark = pytest.mark.slow

SIDE = Camera(640, 480, 0.75, look_at(np.array([0.0, 1.1, HEIGHT + 0.5]), [0, 0, HEIGHT], up=(0, 0, 1)))
RED, BLUE = BLOCKS[0], BLOCKS[2]
ANOTHER = RED.moved(id="other", at=BLUE.at, yaw=BLUE.yaw)
TALL = Thing("cabinet", (225, 225, 222), (0.28, 0.2, 0.29), (0.05, 0.08))
BOWL = Thing("white-bowl", (228, 228, 224), (0.14, 0.14, 0.06), (-0.25, 0.0), round=True, hollow=True)


def question(
    before: list[Thing], after: list[Thing], thing: Thing, place: Thing, *, side: bool = True
) -> CriticQuestion:
    """Ask the critic for ``thing`` on ``place``, with a view from the side or without."""
    asked = critic_question(before, after, Goal(subject=thing.id, relation="on", reference=place.id))
    if not side:
        return asked
    seen = [View(draw(things, SIDE)[0], SIDE) for things in (before, after)]
    return replace(asked, before={**asked.before, "customer": seen[0]}, after={**asked.after, "customer": seen[1]})


GREEN = Thing("green-bowl", (70, 130, 90), (0.14, 0.14, 0.06), (0.1, 0.05), round=True, hollow=True)
NESTED_M = 0.03
"""Height at which the white bowl comes to rest in the green one."""


def judge_nested(after: list[Thing]) -> Verdict:
    """Ask for the white bowl in the green one, of which it hides all from above."""
    goal = Goal(subject=BOWL.id, relation="inside", reference=GREEN.id)
    asked = critic_question([GREEN, BOWL], after, goal)
    seen = [View(draw(things, SIDE)[0], SIDE) for things in ([GREEN, BOWL], after)]
    room = box_corners([-0.07, -0.07, NESTED_M], [0.07, 0.07, NESTED_M + BOWL.size[2]])[None]
    views = ({**asked.before, "customer": seen[0]}, {**asked.after, "customer": seen[1]})
    return OfflineCritic().judge(replace(asked, before=views[0], after=views[1], rooms={goal: room}))


def judge(before: list[Thing], after: list[Thing], thing: Thing, place: Thing, *, side: bool = True) -> Verdict:
    return OfflineCritic().judge(question(before, after, thing, place, side=side))


def upon(thing: Thing, place: Thing, dx: float = 0.0, dy: float = 0.0) -> Thing:
    return thing.moved(at=(place.at[0] + dx, place.at[1] + dy), yaw=place.yaw + 0.1, base=place.base + place.size[2])


@pytest.mark.parametrize("lower", [BLUE, ANOTHER], ids=["blue", "same colour"])
def test_a_block_that_hides_the_one_below_is_on_it(lower: Thing) -> None:
    verdict = judge([lower, RED, ERASER], [lower, upon(RED, lower), ERASER], RED, lower)
    assert verdict.accepted, verdict.reason


def test_a_view_from_above_does_not_tell_a_block_on_a_hidden_one() -> None:
    hidden = RED.moved(at=BLUE.at, yaw=BLUE.yaw)
    assert not judge([BLUE, RED, ERASER], [hidden, ERASER], RED, BLUE, side=False).accepted


def test_a_third_block_is_on_a_block_stacked_before() -> None:
    second, third = upon(RED, BLUE), BLOCKS[1]
    asked = question([BLUE, second, third], [BLUE, second, upon(third, second)], third, second)
    laid_out = {**asked.planned, RED.id: Pose.from_yaw((*RED.at, HEIGHT), RED.yaw)}
    verdict = OfflineCritic().judge(replace(asked, planned=laid_out, tops=[HEIGHT + BLUE.size[2]]))
    assert verdict.accepted, verdict.reason


@pytest.mark.parametrize("lower", [BLUE, ANOTHER], ids=["blue", "same colour"])
@pytest.mark.parametrize("away", [(0.05, 0.0), (-0.12, 0.05), None], ids=["near", "far", "gone"])
def test_a_block_in_place_of_the_lower_one_is_not_on_it(lower: Thing, away: tuple | None) -> None:
    pushed = [] if away is None else [lower.moved(at=(lower.at[0] + away[0], lower.at[1] + away[1]))]
    after = [RED.moved(at=lower.at, yaw=lower.yaw), *pushed, ERASER]
    assert not judge([lower, RED, ERASER], after, RED, lower).accepted


def test_a_block_beside_the_one_below_is_not_on_it() -> None:
    after = [BLUE, RED.moved(at=(BLUE.at[0] + 0.045, BLUE.at[1]), yaw=BLUE.yaw), ERASER]
    assert not judge([BLUE, RED, ERASER], after, RED, BLUE).accepted


def test_nudged_blocks_are_still_a_stack() -> None:
    nudged = BLUE.moved(at=(BLUE.at[0] + 0.015, BLUE.at[1] - 0.01))
    verdict = judge([BLUE, RED, ERASER], [nudged, upon(RED, nudged), ERASER], RED, BLUE)
    assert verdict.accepted, verdict.reason


def test_a_white_bowl_on_a_tall_white_top_is_on_it() -> None:
    verdict = judge([TALL, BOWL], [TALL, upon(BOWL, TALL, 0.03, 0.0)], BOWL, TALL)
    assert verdict.accepted, verdict.reason


@pytest.mark.parametrize(("push", "side"), [(0.04, True), (0.14, False)], ids=["two views", "from above alone"])
def test_a_white_bowl_beside_a_tall_white_top_that_it_pushed_is_not_on_it(push: float, side: bool) -> None:
    pushed = TALL.moved(at=(TALL.at[0] + push, TALL.at[1]), yaw=0.3)
    beside = BOWL.moved(at=(TALL.at[0] + push - 0.14 - 0.1, TALL.at[1]))
    assert not judge([TALL, BOWL], [pushed, beside], BOWL, TALL, side=side).accepted


def test_a_black_bowl_is_seen_to_leave_a_black_stove() -> None:
    stove, plate = (
        Thing("hob", (30, 30, 32), (0.28, 0.2, 0.04), (0.2, 0.0)),
        Thing("plate", (60, 90, 170), (0.2, 0.2, 0.02), (-0.2, 0.0), round=True),
    )
    bowl = Thing("black-bowl", (50, 50, 53), (0.12, 0.12, 0.05), (0.0, 0.0), round=True, hollow=True)
    there = bowl.moved(at=stove.at, base=stove.size[2])
    verdict = judge([stove, plate, there], [stove, plate, upon(bowl, plate)], there, plate, side=False)
    assert verdict.accepted, verdict.reason
    assert not judge([stove, plate, there], [stove, plate, there], there, plate, side=False).accepted


def test_a_bowl_that_hides_the_one_it_nests_in_is_in_it() -> None:
    verdict = judge_nested([GREEN, BOWL.moved(at=GREEN.at, base=NESTED_M)])
    assert verdict.accepted, verdict.reason


def test_a_bowl_in_place_of_the_one_it_should_nest_in_is_not_in_it() -> None:
    pushed = GREEN.moved(at=(GREEN.at[0] - 0.02, GREEN.at[1] + 0.2))
    assert not judge_nested([BOWL.moved(at=GREEN.at), pushed]).accepted
