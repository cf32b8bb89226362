"""Where the objects of a scene start."""

from __future__ import annotations

import re

import numpy as np
import pytest

from tests.example_scenes import library, template
from vcage.base.errors import InfeasibleScene
from vcage.goals.thresholds import THRESHOLDS
from vcage.models.selection_check import NamedObject
from vcage.objects.lying import LIES, standing_in_lying
from vcage.runs.context import StageContext
from vcage.scenes.starting_poses import StartingPoses, started
from vcage.schema.goals import AskedGoal, Description, Goal, Reading


def test_a_thing_that_is_to_go_to_the_centre_starts_elsewhere():
    block = NamedObject("block", "block", "red", "red block", "content")
    asked = [AskedGoal(goal=Goal(subject="block", relation="centred"), step=1, words="put it in the middle")]
    starting = StartingPoses([block], template(), (), asked, StageContext("offline"))
    starts = [starting.draw(np.random.default_rng(seed))["block"] for seed in range(30)]
    assert all(np.linalg.norm(pose.p[:2]) > THRESHOLDS.centred_m for pose in starts)


CAN = NamedObject("can", "can", "corn", "green can", "content")
PLATE = NamedObject("plate", "plate", "white", "white plate", "context")
STAND_UP = [AskedGoal(goal=Goal(subject="can", relation="upright"), step=1, words="stand the can up")]


def test_what_is_to_be_stood_up_starts_on_its_side_and_nothing_else_does():
    found = started([CAN, PLATE], Reading(goals=STAND_UP), library())
    assert [o.variant for o in found] == ["corn_lying", "white"]
    again = started(found, Reading(goals=STAND_UP), library())
    assert again == found


def test_without_that_goal_it_stands():
    asked = [AskedGoal(goal=Goal(subject="can", relation="on", reference="plate"), step=1, words="put it there")]
    assert started([CAN, PLATE], Reading(goals=asked), library()) == [CAN, PLATE]


def test_it_does_not_lie_on_another_thing():
    lies = Description(subject="can", relation="on", reference="plate", words="the can on the plate")
    with pytest.raises(InfeasibleScene, match="can cannot lie on its side in or on plate"):
        started([CAN, PLATE], Reading(goals=STAND_UP, descriptions=[lies]), library())


def test_what_cannot_lie_is_not_stood_up():
    asked = [AskedGoal(goal=Goal(subject="plate", relation="upright"), step=1, words="stand the plate up")]
    with pytest.raises(InfeasibleScene, match="plate is not tall, or would not lie still") as caught:
        started([CAN, PLATE], Reading(goals=asked), library())
    assert f"such as {LIES}" in caught.value.hint


def test_what_hints_say_lies_on_its_side_does():
    names = [name.removeprefix("a ").replace(" ", "_") for name in re.split(", | or ", LIES)]
    assert len(names) == 4 and all(standing_in_lying(library().asset(name)) is not None for name in names)


def test_what_stands_on_another_thing_is_not_hung():
    mug = NamedObject("mug", "mug", "red", "red mug", "content")
    rack = NamedObject("rack", "mug_rack", "wood", "light brown mug rack", "receptacle")
    asked = [AskedGoal(goal=Goal(subject="mug", relation="hung_on", reference="rack"), step=1, words="hang it up")]
    there = Description(subject="mug", relation="on", reference="plate", words="the mug on the plate")
    with pytest.raises(InfeasibleScene, match="mug cannot be hung from in or on plate") as caught:
        started([mug, rack, PLATE], Reading(goals=asked, descriptions=[there]), library())
    assert "it stands on the table" in caught.value.hint
