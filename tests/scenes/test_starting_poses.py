"""Where the objects of a scene start."""

from __future__ import annotations

import numpy as np

from tests.example_scenes import template
from vcage.goals.thresholds import THRESHOLDS
from vcage.models.selection_check import NamedObject
from vcage.runs.context import StageContext
from vcage.scenes.starting_poses import StartingPoses
from vcage.schema.goals import AskedGoal, Goal


def test_a_thing_that_is_to_go_to_the_centre_starts_elsewhere():
    block = NamedObject("block", "block", "red", "red block", "content")
    asked = [AskedGoal(goal=Goal(subject="block", relation="centred"), step=1, words="put it in the middle")]
    starting = StartingPoses([block], template(), (), asked, StageContext("offline"))
    starts = [starting.draw(np.random.default_rng(seed))["block"] for seed in range(30)]
    assert all(np.linalg.norm(pose.p[:2]) > THRESHOLDS.centred_m for pose in starts)
