"""From which cameras the critic looks at a sub-task."""

from __future__ import annotations

import pytest

from tests.models.tabletop import BLOCKS, ERASER, PLATE, Thing, scene_of
from vcage.episodes.question import CUSTOMER, TOP, _opened, cameras
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Statement

MAT = Thing("mat", (40, 40, 40), (0.05, 0.05, 0.004), (0.2, 0.1), role="receptacle")
CABINET = Thing("cabinet", (225, 225, 222), (0.28, 0.2, 0.29), (-0.1, 0.1), role="receptacle")


@pytest.mark.parametrize(
    ("reference", "names"),
    [("blue-block", {TOP, CUSTOMER}), ("plate", {TOP}), ("mat", {TOP}), ("cabinet", {TOP}), ("table", {TOP})],
)
def test_a_stack_is_looked_at_from_the_side_too(reference: str, names: set[str]) -> None:
    """From above the upper block hides the lower one; it hides no cabinet, and a mat is too thin to be seen."""
    scene = scene_of([*BLOCKS, ERASER, PLATE, MAT, CABINET])
    assert set(cameras(scene, [Goal(subject="red-block", relation="on", reference=reference)])) == names


def test_a_bowl_that_hides_the_one_it_is_in_is_looked_at_from_the_side_too() -> None:
    lower = Thing("low", (90, 90, 90), (0.15, 0.15, 0.06), (0.0, 0.0))
    upper, wide = lower.moved(id="up", at=(0.2, 0.0)), lower.moved(id="wide", size=(0.3, 0.3, 0.06), at=(-0.2, 0.1))
    scene = scene_of([lower, upper, wide])
    for holder, names in (("low", {TOP, CUSTOMER}), ("wide", {TOP})):
        assert set(cameras(scene, [Goal(subject="up", relation="inside", reference=holder)])) == names


def test_a_part_that_stays_open_is_drawn_open() -> None:
    goal = Goal(subject="cabinet", relation="closed", part="drawer_top")
    stays = Statement(subject="cabinet", word="open", part="drawer_bottom")
    assert _opened([goal], [], [stays]) == {"cabinet": ["drawer_bottom"]}
    assert _opened([goal], [], [Statement(subject="cabinet", word="closed", part="drawer_bottom")]) == {}
