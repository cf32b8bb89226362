"""Objects that a target picture does not show keep their place from the plan."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from vcage.base.errors import UnknownName
from vcage.schema.plan import LayoutPlan, Relation
from vcage.vision.match import stored_matches


def test_an_unknown_robot_is_an_error_if_the_plan_gives_a_place(things, make_scene):
    scene = make_scene(things).model_copy(update={"robot": "dual_panado"})
    relation = Relation(subject="marker_red", relation="right_of", reference="box")
    plan = LayoutPlan(text="The red marker goes to the right of the box.", relations=[relation])
    with pytest.raises(UnknownName, match="dual_panado"):
        observation = SimpleNamespace(scene=scene, shown={"marker_red"})
        stored_matches(observation, plan, {}, {"marker_red": "not found"})
