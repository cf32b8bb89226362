"""Upright: an object stands on its bottom with its head up."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from vcage.base.geometry import Pose
from vcage.goals import KINDS
from vcage.goals.kind import State
from vcage.schema.goals import Goal

GOAL = Goal(subject="bottle", relation="upright")


@pytest.mark.parametrize(("lean_deg", "stands"), [(0, True), (3, True), (8, False), (90, False), (180, False)])
def test_it_leans_by_a_few_degrees_at_most_and_does_not_stand_on_its_head(lean_deg: float, stands: bool) -> None:
    half = np.radians(lean_deg) / 2
    pose = Pose([0.0, 0.0, 0.74], [np.cos(half), np.sin(half), 0.0, 0.0])
    state = cast(State, SimpleNamespace(thing=lambda name: SimpleNamespace(pose=pose)))
    complaint = KINDS["upright"].complaint(GOAL, state)
    assert complaint == (None if stands else f"bottle leans by {lean_deg}°")
