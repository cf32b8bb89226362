"""The layouts that are tried until the instruction can be carried out."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.example_scenes import scene_of, thing
from vcage.base.errors import InfeasibleScene
from vcage.layout.optimize import LayoutOptions
from vcage.runs.context import StageContext
from vcage.scenes import feasible_layout
from vcage.scenes.feasible_layout import NearestFeasible
from vcage.scenes.layout_items import Targets
from vcage.schema.goals import AskedGoal, Description, goal_of


@pytest.mark.parametrize("relation", ["presented", "held_by_both"])
def test_what_must_be_at_some_heading_is_turned_by_a_quarter_more_in_each_further_layout(
    relation: str, monkeypatch: pytest.MonkeyPatch
):
    sign, block = thing("payment_sign", (0.0, 0.0), 0.2, "content"), thing("block", (0.2, 0.0), 0.3, "content")
    asked = [AskedGoal(goal=goal_of(("payment_sign", relation)), step=1, words="do it")]
    described = [Description(subject="block", relation="right_of", reference="table", words="the block on the right")]
    scene = scene_of([sign, block], "Do it").model_copy(update={"goals": asked, "descriptions": described})
    tried = list[dict[str, float]]()

    def no_layout(_scene: Any, targets: Targets, *_: Any) -> None:
        tried.append({name: pose.yaw for name, pose in targets.poses.items()})
        raise InfeasibleScene("there is none", hint="none")

    monkeypatch.setattr(feasible_layout, "nearest_layout", no_layout)
    targets = Targets({"payment_sign": sign.pose, "block": block.pose}, {})
    context = StageContext("offline")
    search = NearestFeasible(scene, targets, lambda: np.random.default_rng(0), LayoutOptions(), context)
    with pytest.raises(InfeasibleScene):
        search.layout()
    turns = np.diff([yaws["payment_sign"] for yaws in tried])
    assert np.allclose(np.cos(turns - np.pi / 2), 1) and len(turns) > 2
    assert {round(yaws["block"], 6) for yaws in tried} == {0.3}
