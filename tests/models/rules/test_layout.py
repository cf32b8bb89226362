"""The plan of a scene without an instruction: receptacles in the middle, free drawers, like by like."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from tests.example_scenes import library, scene_of, thing
from vcage.models.rules.layout import MAX_ROW, plan_layout, plan_scene
from vcage.plans.check import plan_complaints
from vcage.schema.goals import AskedGoal, Goal
from vcage.schema.plan import LayoutPlan, Relation, RelationWord
from vcage.schema.scene import Role, Scene

RECEPTACLES = ["packaging_box", "cabinet_two_drawers", "pen_tray"]
CONTENTS = ["stapler", "apple", "banana", "marker", "pear", "tape_roll"]


def laid(receptacles: Sequence[str], contents: Sequence[str], context: Sequence[str] = ()) -> Scene:
    roles: list[tuple[str, Role]] = [
        *((name, "receptacle") for name in receptacles),
        *((name, "content") for name in contents),
        *((name, "context") for name in context),
    ]
    return scene_of([thing(name, (0.0, 0.0), role=role) for name, role in roles]).model_copy(
        update={"instruction": None}
    )


def plan(found: Scene, seed: int = 0) -> LayoutPlan:
    return plan_scene(found, library().entries(), np.random.default_rng(seed))


def places(of: LayoutPlan, word: str) -> dict[str, str]:
    """Where things stand so: subject → reference."""
    return {r.subject: r.reference for r in of.relations if r.relation == word}


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(
    ("receptacles", "context"), [(RECEPTACLES, ["tap"]), (["plate", "bowl", "cutting_board", "tray"], []), ([], [])]
)
def test_every_object_has_a_place_without_contradiction(receptacles, context, seed):
    found = laid(receptacles, CONTENTS, context)
    planned = plan(found, seed)
    assert plan_complaints(planned, found) == []
    assert all(o.phrase in planned.text for o in found.objects)


def test_an_openable_object_stands_in_the_middle_of_the_receptacles_with_nothing_before_it():
    planned = plan(laid(RECEPTACLES, CONTENTS))
    assert planned.relations[0] == Relation(subject="cabinet_two_drawers", relation="center", reference="table")
    sides = places(planned, "left_of") | places(planned, "right_of")
    assert sides["packaging_box"] == sides["pen_tray"] == "cabinet_two_drawers"
    assert "cabinet_two_drawers" not in places(planned, "in_front_of").values()
    assert not set(sides.values()) & set(CONTENTS)


def test_the_row_is_no_wider_than_the_arms_share():
    planned = plan(laid(["plate", "bowl", "cutting_board", "tray"], []))
    beside = places(planned, "left_of") | places(planned, "right_of")
    assert len(beside) == MAX_ROW - 1
    assert list(places(planned, "in_front_of")) == ["bowl"], "the smallest"


def test_things_of_a_kind_stand_together():
    near = places(plan(laid(RECEPTACLES, CONTENTS)), "near")
    fruit = {"apple", "banana", "pear"}
    assert sum({a, b} <= fruit for a, b in near.items()) >= 1


def test_the_seed_settles_which_side_is_which():
    found = laid(RECEPTACLES, CONTENTS)
    assert plan(found, 3) == plan(found, 3)
    assert {"pen_tray" in places(plan(found, seed), "left_of") for seed in range(8)} == {True, False}


def test_a_scanner_stands_before_a_receptacle_that_does_not_open_where_every_arm_comes_to():
    planned = plan(laid(["cash_drawer", "shopping_basket"], [*CONTENTS, "barcode_scanner"]))
    assert places(planned, "in_front_of")["barcode_scanner"] == "shopping_basket"
    assert "barcode_scanner" not in {*places(planned, "near"), *places(planned, "near").values()}


def test_things_start_around_the_receptacle_that_they_go_to():
    found = laid(["plate", "bowl"], ["apple", "banana", "pear", "stapler"])
    wanted = {"apple": "bowl", "banana": "bowl", "pear": "bowl", "stapler": "plate"}
    goals = [AskedGoal(goal=Goal(subject=a, relation="on", reference=b), step=0, words="x") for a, b in wanted.items()]
    planned = plan_layout(found.model_copy(update={"goals": goals}), library().entries(), np.random.default_rng(0))
    around = {r.subject: r.reference for r in planned.relations if r.subject in wanted and r.relation != "near"}
    assert around == wanted


@pytest.mark.parametrize(
    ("goal", "start"), [("left_of", "in_front_of"), ("right_of", "in_front_of"), ("in_front_of", "left_of")]
)
def test_what_goes_to_a_side_starts_on_the_next_one(goal: RelationWord, start: str):
    found = laid(["plate"], ["apple"])
    asked = [AskedGoal(goal=Goal(subject="apple", relation=goal, reference="plate"), step=0, words="x")]
    planned = plan_layout(found.model_copy(update={"goals": asked}), library().entries(), np.random.default_rng(0))
    assert places(planned, start)["apple"] == "plate"


def test_things_that_go_to_no_receptacle_are_shared_out():
    planned = plan_layout(laid(["plate", "bowl"], CONTENTS), library().entries(), np.random.default_rng(0))
    around = [r.reference for r in planned.relations if r.subject in CONTENTS and r.relation != "near"]
    assert sorted(around) == ["bowl"] * 3 + ["plate"] * 3
