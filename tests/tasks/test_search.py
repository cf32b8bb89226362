"""Sub-tasks of a scene, and the chain for an instruction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from tests.scenes import TABLE_TOP, block_and_plate, kinematics, sensible, thing
from vcage.base.errors import NoFeasibleTask
from vcage.schema.subtasks import ChainOption, PairAnswer, PairQuestion
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import FoundSubtasks, compose, find_subtasks


def found_in(objects: Sequence[SceneObject], judge=sensible, seed: int = 0) -> FoundSubtasks:
    return find_subtasks(objects, kinematics(), judge, TABLE_TOP, np.random.default_rng(seed))


def stationery() -> list[SceneObject]:
    return [
        thing("marker", (-0.2, 0.0), np.pi / 2, "content"),
        thing("whiteboard_eraser", (0.22, 0.0), np.pi / 2, "content"),
        thing("packaging_box", (0.0, 0.05), 0.0, "receptacle"),
    ]


def nonsense(questions: Sequence[PairQuestion]) -> list[PairAnswer]:
    return [a.model_copy(update={"sensible": False, "reason": "nobody does that"}) for a in sensible(questions)]


def everything(_instruction: str, options: Sequence[ChainOption]) -> list[str]:
    return [option.id for option in options]


def nothing(_instruction: str, _options: Sequence[ChainOption]) -> list[str]:
    return []


# --- search --------------------------------------------------------------------------------------------


def test_each_content_gets_a_sub_task_for_the_box():
    kept = found_in(stationery()).kept
    assert [s.id for s in kept] == ["marker-into-packaging_box", "whiteboard_eraser-into-packaging_box"]


def test_a_kept_sub_task_states_its_goal_and_its_script():
    kept = found_in(block_and_plate()).kept
    assert [(g.subject, g.relation, g.reference) for g in kept[0].goals] == [("block", "on", "plate")]
    assert kept[0].script == "subtasks/block-onto-plate.py"


def test_the_grasps_of_a_sub_task_come_best_first():
    scores = [grasp.score for grasp in found_in(block_and_plate()).kept[0].grasps]
    assert len(scores) > 1
    assert scores == sorted(scores, reverse=True)


def test_every_ordered_pair_is_kept_or_refused():
    objects = stationery()
    result = found_in(objects)
    seen = {(s.object, s.receptacle) for s in result.kept} | {(r.object, r.receptacle) for r in result.refused}
    assert seen == {(a.id, b.id) for a in objects for b in objects if a.id != b.id}


def test_candidates_are_contact_points_times_functional_points():
    marker, eraser, _box = stationery()
    expected = len(marker.asset.annotation.contact_points) + len(eraser.asset.annotation.contact_points)
    assert found_in(stationery()).candidates == expected


def test_every_refusal_says_why():
    assert all(refusal.reason for refusal in found_in(stationery()).refused)


def test_a_pair_that_does_not_fit_is_not_put_before_the_reasoner():
    asked: list[PairQuestion] = []

    def judge(questions: Sequence[PairQuestion]) -> list[PairAnswer]:
        asked.extend(questions)
        return sensible(questions)

    found_in(block_and_plate(), judge)
    assert [(q.object, q.receptacle) for q in asked] == [("block", "plate")]


def test_the_reasoner_is_not_asked_when_nothing_fits():
    def judge(_questions: Sequence[PairQuestion]) -> list[PairAnswer]:
        raise AssertionError("nothing to ask")

    assert found_in([thing("marker", (-0.2, 0.0)), thing("whiteboard_eraser", (0.2, 0.0))], judge).kept == []


def test_a_pair_that_is_not_sensible_is_refused_with_the_reasoners_reason():
    result = found_in(block_and_plate(), nonsense)
    assert result.kept == []
    assert "not sensible: nobody does that" in [r.reason for r in result.refused]


def test_an_object_out_of_reach_is_refused_at_each_contact_point():
    block, plate = thing("block", (0.0, 0.9)), thing("plate", (0.05, 0.05))
    result = found_in([block, plate])
    assert result.kept == []
    assert [r.contact for r in result.refused if r.object == "block"] == [0, 1]


def test_a_receptacle_that_is_full_already_is_refused():
    box = thing("packaging_box", (0.0, 0.05), 0.0, "receptacle")
    filling = thing("packaging_box", (0.0, 0.05), 0.0, id="filling", container=box.id)
    result = found_in([thing("marker", (-0.2, 0.0), np.pi / 2, "content"), box, filling])
    assert "marker-into-packaging_box" not in [s.id for s in result.kept]


def test_the_same_seed_finds_the_same_sub_tasks():
    first, second = (found_in(stationery(), seed=3) for _ in range(2))
    assert first == second


# --- chain ---------------------------------------------------------------------------------------------


def test_the_chain_is_what_the_reasoner_chose():
    objects = stationery()
    result = found_in(objects)
    chain = compose("pack it", result.kept, result.refused, objects, everything)
    assert chain == ["marker-into-packaging_box", "whiteboard_eraser-into-packaging_box"]


def test_the_reasoner_sees_what_the_catalogue_calls_the_things_and_only_their_own_look():
    objects = stationery()
    asked: list[ChainOption] = []

    def choose(_instruction: str, options: Sequence[ChainOption]) -> list[str]:
        asked.extend(options)
        return [option.id for option in options]

    compose("pack it", found_in(objects).kept, [], objects, choose)
    kinds = [asked[0].object_kind, asked[0].receptacle_kind]
    assert [kind.words for kind in kinds] == [objects[i].asset.annotation.words for i in (0, 2)]
    assert [[v.id for v in kind.variants] for kind in kinds] == [[objects[i].record.variant] for i in (0, 2)]


def test_no_chain_names_the_objects_that_stay_where_they_are():
    with pytest.raises(NoFeasibleTask, match="black marker pen, blue whiteboard eraser"):
        compose("pack it", [], [], stationery(), nothing)


def test_a_content_without_a_feasible_sub_task_is_named_with_the_reason():
    block, plate = thing("block", (0.0, 0.9), role="content"), thing("plate", (0.05, 0.05), role="receptacle")
    result = found_in([block, plate])
    with pytest.raises(NoFeasibleTask, match=r"red block.*does not reach"):
        compose("Put the block on the plate", result.kept, result.refused, [block, plate], everything)


def test_a_chain_that_forgets_a_content_is_refused():
    objects = stationery()
    result = found_in(objects)
    with pytest.raises(NoFeasibleTask, match="whiteboard eraser"):
        compose("pack it", result.kept, result.refused, objects, lambda _i, options: [options[0].id])
