"""What a target picture does not show keeps its place from the plan."""

from __future__ import annotations

import pytest

from vcage.base.errors import UnknownName
from vcage.schema.plan import LayoutPlan, Relation
from vcage.vision.unmatched import kept


def test_a_robot_that_there_is_not_is_an_error_where_the_plan_gives_a_place(things, make_scene, paint):
    scene = make_scene(things).model_copy(update={"robot": "dual_panado"})
    relation = Relation(subject="marker_red", relation="right_of", reference="box")
    plan = LayoutPlan(text="The red marker goes to the right of the box.", relations=[relation])
    with pytest.raises(UnknownName, match="dual_panado"):
        kept(scene, plan, paint(things)[1], {}, {"marker_red": "not found"})
