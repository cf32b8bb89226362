from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from tests.models.catalogue import CATALOGUE
from tests.models.tabletop import BLOCKS, BOX, ERASER, MARKERS, PLATE, scene_of
from vcage.base.errors import ModelRefused
from vcage.models.rules.reasoner import MAX_DRAWS, OfflineReasoner
from vcage.plans.check import plan_complaints
from vcage.plans.descriptions import described_relations
from vcage.schema.goals import AskedGoal, Description, Goal
from vcage.schema.plan import LayoutPlan, Relation, RelationWord, Selection

REASONER = OfflineReasoner()


@pytest.mark.parametrize("seed", range(5))
def test_a_layout_holds_every_object_and_no_contradiction(seed: int) -> None:
    scene = scene_of([BOX, *MARKERS, ERASER.moved(role="context"), PLATE.moved(role="context")])
    plan = REASONER.plan_layout(scene, [], np.random.default_rng(seed), partial(plan_complaints, scene=scene))
    assert plan_complaints(plan, scene) == []
    assert all(o.phrase in plan.text for o in scene.objects)


def test_contents_start_beside_their_receptacle_on_both_sides() -> None:
    plan = REASONER.plan_layout(scene_of([PLATE, *BLOCKS]), [], np.random.default_rng(0), lambda _: [])
    words = {r.relation for r in plan.relations if r.subject.endswith("block")}
    assert words == {"left_of", "right_of", "in_front_of"}


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    "triples",
    [
        [("red-block", "left_of", "green-block"), ("green-block", "left_of", "blue-block")],
        [("plate", "left_of", "table")],
        [("blue-block", "beside", "plate"), ("red-block", "in_front_of", "table")],
        [("plate", "right_of", "eraser")],
    ],
)
def test_a_layout_states_the_description_in_the_instruction(
    triples: list[tuple[str, RelationWord, str]], seed: int
) -> None:
    told = [Description(subject=s, relation=r, reference=o, words="x") for s, r, o in triples]
    things = [PLATE, *BLOCKS, ERASER.moved(id="eraser", role="context")]
    scene = scene_of(things).model_copy(update={"descriptions": told})
    plan = REASONER.plan_layout(scene, [], np.random.default_rng(seed), partial(plan_complaints, scene=scene))
    assert set(described_relations(told)) <= set(plan.relations)


@pytest.mark.parametrize("side", ["left_of", "right_of"])
@pytest.mark.parametrize("seed", range(4))
def test_nothing_stands_where_the_instruction_wants_something_put(side: RelationWord, seed: int) -> None:
    deep = [ERASER.moved(id=f"{n}-eraser", role="context", size=(0.1, 0.4, 0.05)) for n in ("one", "two", "three")]
    asked = AskedGoal(goal=Goal(subject="red-block", relation=side, reference="plate"), step=1, words="put it there")
    scene = scene_of([PLATE, BLOCKS[0], *deep]).model_copy(update={"goals": [asked]})
    plan = REASONER.plan_layout(scene, [], np.random.default_rng(seed), lambda _: [])
    assert not [r for r in plan.relations if (r.relation, r.reference) == (side, "plate")]


def test_a_rejected_draw_is_repeated() -> None:
    scene, seen = scene_of([PLATE, *BLOCKS]), []

    def no_red_on_the_left(plan: LayoutPlan) -> list[str]:
        seen.append(plan)
        left = Relation(subject="red-block", relation="left_of", reference="plate")
        return ["not there"] if left in plan.relations or len(seen) == 1 else []

    plan = REASONER.plan_layout(scene, [], np.random.default_rng(0), no_red_on_the_left)
    assert plan is seen[-1] and len(seen) > 1 and seen[0].relations != plan.relations


def test_draws_that_always_fail_are_refused_after_a_few() -> None:
    seen = []

    def never(selection: Selection) -> list[str]:
        seen.append(selection)
        return ["no room"]

    with pytest.raises(ModelRefused, match="no selection of offline can be used: no room") as caught:
        REASONER.select_assets("Put the blocks on the plate", CATALOGUE, np.random.default_rng(0), never)
    assert len(seen) == MAX_DRAWS and "--seed" not in caught.value.hint


def test_another_seed_is_offered_where_failures_differ_between_draws() -> None:
    seen = []

    def never(selection: Selection) -> list[str]:
        seen.append(selection)
        return [f"no room for {len(seen)}"]

    with pytest.raises(ModelRefused) as caught:
        REASONER.select_assets("Put the blocks on the plate", CATALOGUE, np.random.default_rng(0), never)
    assert "another --seed" in caught.value.hint
