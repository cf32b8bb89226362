"""Sub-tasks of a scene, and the chain for an instruction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from tests.example_scenes import block_and_plate, scene_of, sensible, subtask, thing, workplace
from vcage.base.errors import NoFeasibleTask
from vcage.schema.goals import AskedGoal, Goal
from vcage.schema.subtasks import Check, PairAnswer, PairQuestion, Refusal
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import FoundSubtasks, compose, find_subtasks
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.workplace import Workplace


def found_in(objects: Sequence[SceneObject], judge=sensible, seed: int = 0) -> FoundSubtasks:
    return find_subtasks(workplace(objects, np.random.default_rng(seed)), judge)


def stationery() -> list[SceneObject]:
    return [
        thing("marker", (-0.2, 0.0), np.pi / 2, "content"),
        thing("whiteboard_eraser", (0.22, 0.0), np.pi / 2, "content"),
        thing("packaging_box", (0.0, 0.05), 0.0, "receptacle"),
    ]


def nonsense(questions: Sequence[PairQuestion]) -> list[PairAnswer]:
    return [a.model_copy(update={"sensible": False, "reason": "nobody does that"}) for a in sensible(questions)]


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


def test_every_template_keeps_its_reasons():
    out_of_reach = ["block", "electronic_scale", "price_sign", "cereal_box", "barcode_scanner", "cabinet_one_drawer",
                    "service_bell", "kitchen_timer", "hammer", "sponge"]  # fmt: skip
    objects = [thing(name, (0.4 * k, 3.0)) for k, name in enumerate(out_of_reach)]
    objects.append(thing("block", (4.0, 3.0), id="other_block"))
    asked = [
        Goal(subject="block", relation="hit"),
        Goal(subject="electronic_scale", relation="wiped"),
        Goal(subject="block", relation="poured", reference="electronic_scale"),
        Goal(subject="block", relation="hung_on", reference="electronic_scale"),
        Goal(subject="block", relation="inserted_in", reference="electronic_scale"),
        Goal(subject="block", relation="beside", reference="electronic_scale"),
        Goal(subject="cabinet_one_drawer", relation="beside", reference="block"),
        Goal(subject="block", relation="handed", reference="right"),
        *(Goal(subject="block", relation=word) for word in ("lifted", "shaken", "held_up", "held_by_both")),
    ]
    result = find_subtasks(workplace(objects), sensible, asked)
    assert result.kept == []
    assert {refusal.template for refusal in result.refused} == set(TEMPLATES)


@pytest.mark.parametrize(
    "goal",
    [
        Goal(subject="block", relation="beside", reference="plate"),
        Goal(subject="block", relation="handed", reference="right"),
        Goal(subject="cookie_box", relation="scanned"),
    ],
)
def test_refusals_of_other_goals_name_no_receptacle(goal: Goal):
    out_of_reach = ["block", "plate", "cookie_box", "barcode_scanner"]
    objects = [thing(name, (0.4 * k, 3.0)) for k, name in enumerate(out_of_reach)]
    refused = find_subtasks(workplace(objects), sensible, [goal]).refused
    assert {refusal.receptacle for refusal in refused if refusal.goal == goal} == {None}


def test_an_object_is_examined_at_its_present_place_after_an_earlier_one():
    plate = thing("plate", (0.05, 0.05))
    kept = [len(found_in([thing("block", (-0.2, y), 0.3), plate]).kept) for y in (-0.05, 0.9, -0.05)]
    assert kept == [1, 0, 1]


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


def test_an_implausible_pair_is_refused_with_the_reasoners_reason():
    result = found_in(block_and_plate(), nonsense)
    assert result.kept == []
    assert "not sensible: nobody does that" in [r.reason for r in result.refused]


def test_an_object_out_of_reach_is_refused_at_each_contact_point():
    block, plate = thing("block", (0.0, 0.9)), thing("plate", (0.05, 0.05))
    result = found_in([block, plate])
    assert result.kept == []
    assert [r.contact for r in result.refused if r.object == "block"] == [0, 1]


def test_a_full_receptacle_is_refused():
    box = thing("packaging_box", (0.0, 0.05), 0.0, "receptacle")
    filling = thing("packaging_box", (0.0, 0.05), 0.0, id="filling", container=box.id)
    result = found_in([thing("marker", (-0.2, 0.0), np.pi / 2, "content"), box, filling])
    assert "marker-into-packaging_box" not in [s.id for s in result.kept]


def test_the_same_seed_finds_the_same_sub_tasks():
    first, second = (found_in(stationery(), seed=3) for _ in range(2))
    assert first == second


# --- what a refusal says -------------------------------------------------------------------------------


def refused_for(check: str) -> NoFeasibleTask:
    """The error where one check refuses the request."""
    goal = Goal(subject="marker", relation="inside", reference="packaging_box")
    asked = AskedGoal(goal=goal, step=0, words="the words")
    scene = scene_of(stationery()).model_copy(update={"instruction": "the words", "goals": [asked]})
    failed = Check(name=check, passed=False, message="too wide")  # pyrefly: ignore
    refusal = Refusal(template="place", object="marker", goal=goal, reason="too wide", checks=[failed])
    with pytest.raises(NoFeasibleTask) as caught:
        compose(scene, stationery(), [], [refusal])
    return caught.value


def test_another_seed_is_offered_only_where_chance_matters():
    assert "another --seed gives another layout" in refused_for("reach_place").hint
    for check in ("fits", "opening"):
        assert "smaller thing" in refused_for(check).hint and "does not help" in refused_for(check).hint


def far_away(objects: Sequence[SceneObject]) -> list[SceneObject]:
    return [thing(o.record.asset, (0.4 * number, 3.0)) for number, o in enumerate(objects)]


# --- chain ---------------------------------------------------------------------------------------------


def chain_for(objects: Sequence[SceneObject], *goals: tuple[str, str, str], untouched: Sequence[str] = ()) -> list[str]:
    """The chain of sub-tasks for goals (subject, relation, reference), one step after another."""
    asked = [
        AskedGoal(goal=Goal(subject=s, relation=r, reference=o), step=step, words=f"{s} {r} {o}")
        for step, (s, r, o) in enumerate(goals)
    ]
    result = found_in(objects)
    asking = scene_of(objects).model_copy(update={"goals": asked, "untouched": list(untouched)})
    (chain,) = compose(asking, objects, result.kept, result.refused)
    return chain.subtasks


def test_the_chain_brings_about_the_goals_in_their_order():
    goals = [(name, "inside", "packaging_box") for name in ("whiteboard_eraser", "marker")]
    assert chain_for(stationery(), *goals) == [f"{name}-into-packaging_box" for name, _, _ in goals]


def test_a_goal_that_no_sub_task_brings_about_is_named_with_the_words_for_it():
    with pytest.raises(NoFeasibleTask, match=r"marker left_of packaging_box \('marker left_of packaging_box'\)"):
        chain_for(stationery(), ("marker", "left_of", "packaging_box"))


def test_a_content_without_a_feasible_sub_task_is_named_with_the_reason():
    block, plate = thing("block", (0.0, 0.9), role="content"), thing("plate", (0.05, 0.05), role="receptacle")
    with pytest.raises(NoFeasibleTask, match=r"block on plate.*does not reach"):
        chain_for([block, plate], ("block", "on", "plate"))


def test_an_object_to_be_left_alone_is_not_moved():
    with pytest.raises(NoFeasibleTask, match=r"marker inside packaging_box.*: marker is to be left alone"):
        chain_for(stationery(), ("marker", "inside", "packaging_box"), untouched=["marker"])


def test_goals_impossible_in_any_order_are_reported_as_such():
    objects = block_and_plate()
    goals = [Goal(subject="block", relation="on", reference=name) for name in ("plate", "table")]
    found = find_subtasks(workplace(objects), sensible, goals)
    asked = [AskedGoal(goal=goal, step=0, words=str(goal)) for goal in goals]
    with pytest.raises(NoFeasibleTask, match="each can be brought about, but in no order all of them") as caught:
        compose(scene_of(objects).model_copy(update={"goals": asked}), objects, found.kept, found.refused)
    assert caught.value.details == {"missing": [], "reasons": []}


@pytest.mark.parametrize(("holder", "steps"), [("mug", 2), ("bowl", 4)])
def test_a_filled_container_is_moved_with_its_contents_where_it_can_be_held_level(holder: str, steps: int):
    objects = [thing("block", (-0.2, 0.0)), thing(holder, (0.0, 0.1)), thing("tray", (0.25, 0.0))]
    fill = subtask("block", holder, "inside")
    aside = subtask("block", "table", id="aside", template="set_down", functional_point=None)
    goals = [
        AskedGoal(goal=goal, step=step, words="the words")
        for step, goal in enumerate([fill.goals[0], Goal(subject=holder, relation="on", reference="tray")])
    ]
    scene = scene_of(objects, "Fill it, then move it").model_copy(update={"goals": goals})
    (chain,) = compose(scene, objects, [fill, subtask(holder, "tray"), aside], [])
    assert len(chain.subtasks) == steps


def test_two_things_change_places_by_a_third_place():
    apple, block = thing("apple", (-0.2, -0.05)), thing("block", (0.2, -0.05))
    goals = [
        Goal(subject=name, relation="in_place_of", reference=other)
        for name, other in (("apple", "block"), ("block", "apple"))
    ]
    asked = [AskedGoal(goal=goal, step=1, words="swap") for goal in goals]
    scene = scene_of([apple, block], "Swap them").model_copy(update={"goals": asked})
    place = Workplace.of(scene, [apple, block], np.random.default_rng(0))
    found = find_subtasks(place, sensible, goals)
    (chain,) = compose(scene, [apple, block], found.kept, found.refused)
    first, *others = chain.subtasks
    assert first.endswith("onto-table") and {*others} == {
        "apple-in_place_of-block",
        "block-in_place_of-apple",
    }


def test_a_thing_is_put_on_another_with_its_front_to_the_robot_in_one_step():
    soap, tray = thing("soap_bar", (-0.2, -0.05), 1.0), thing("tray", (0.1, 0.0))
    goals = [
        Goal(subject="soap_bar", relation="on", reference="tray"),
        Goal(subject="soap_bar", relation="facing_robot"),
    ]
    asked = [AskedGoal(goal=goal, step=1, words="put it there") for goal in goals]
    scene = scene_of([soap, tray], "Put it there").model_copy(update={"goals": asked})
    found = find_subtasks(Workplace.of(scene, [soap, tray], np.random.default_rng(0)), sensible, goals)
    (chain,) = compose(scene, [soap, tray], found.kept, found.refused)
    assert chain.subtasks == ["soap_bar-onto-tray-facing_robot"]
