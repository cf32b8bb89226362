"""Slots of sub-tasks that may be chosen, and what becomes of a choice."""

from __future__ import annotations

from collections.abc import Sequence

from tests.example_scenes import block_and_plate, scene_of, sensible, subtask, thing, workplace
from vcage.schema.goals import goal_of
from vcage.schema.subtasks import Grasp, Preference, SlotAnswer, SlotQuestion, Statement, Subtask
from vcage.tasks.chain_rehearsal import examined
from vcage.tasks.choosing import as_chosen, filled, preferred_first, slot_questions, with_open_parts
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import actions_of, find_subtasks, initial_state


def searched(objects: Sequence[SceneObject]) -> dict[str, Subtask]:
    found = find_subtasks(workplace(objects), sensible)
    return {subtask.id: subtask for subtask in found.kept}


def asked(chain: Sequence[Subtask], kept: dict[str, Subtask], objects: Sequence[SceneObject]) -> list[SlotQuestion]:
    actions = actions_of(chain, objects, scene_of(objects))
    return slot_questions(chain, kept.values(), objects, initial_state(objects), actions)


TRAY = [thing("rubber_eraser", (-0.2, -0.05), 0.0, "content"), thing("toolbox_tray", (0.05, 0.05), 0.0, "receptacle")]
FRONT, BACK = "rubber_eraser-into-toolbox_tray-0", "rubber_eraser-into-toolbox_tray-1"


def test_every_feasible_grasp_is_named_best_first():
    objects = block_and_plate()
    kept = searched(objects)
    (question,) = asked([kept["block-onto-plate"]], kept, objects)
    assert [(g.contact, g.arm) for g in question.grasps] == [
        (g.contact, g.arm) for g in kept["block-onto-plate"].grasps
    ]
    assert {g.name for g in question.grasps} <= {c.name for c in objects[0].asset.annotation.contact_points}
    assert question.places == []


def test_several_places_of_one_receptacle_are_offered_with_their_names():
    kept = searched(TRAY)
    (question,) = asked([kept[FRONT]], kept, TRAY)
    told = [(place.point, place.name, place.subtask) for place in question.places]
    assert told == [(0, "front compartment", FRONT), (1, "back compartment", BACK)]
    assert all(place.grasps for place in question.places)


def test_another_place_is_another_sub_task_that_brings_about_the_same():
    kept = searched(TRAY)
    (chosen,) = filled([kept[FRONT]], kept, [SlotAnswer(subtask=FRONT, point=1)])
    assert (chosen.id, chosen.functional_point) == (BACK, 1)
    assert chosen.goals == kept[FRONT].goals


def test_the_preferred_grasp_comes_first_and_the_others_stay():
    objects = block_and_plate()
    step = searched(objects)["block-onto-plate"]
    last = step.grasps[-1]
    answer = SlotAnswer(subtask=step.id, grasp=Preference(contact=last.contact, arm=last.arm))
    (chosen,) = filled([step], {}, [answer])
    assert chosen.grasps == [last, *step.grasps[:-1]]


def test_without_an_opinion_nothing_changes():
    objects = block_and_plate()
    step = searched(objects)["block-onto-plate"]
    assert filled([step], {step.id: step}, [SlotAnswer(subtask=step.id)]) == [step]


def test_a_choice_stays_where_things_stand_elsewhere():
    step = searched(block_and_plate())["block-onto-plate"]
    last = step.grasps[-1]
    update = {"prefers": Preference(contact=last.contact, arm=last.arm), "statements": [STILL]}
    objects = [thing("block", (-0.15, 0.0), 0.1, "content"), thing("plate", (0.1, 0.0), 0.0, "receptacle")]
    then = examined(step.model_copy(update=update), workplace(objects))
    assert then is not None
    assert (then.grasps[0].contact, then.grasps[0].arm) == (last.contact, last.arm)
    assert then.statements == [STILL]


def test_a_preferred_grasp_that_is_not_feasible_there_changes_nothing():
    grasps = [Grasp(contact=contact, arm="left", score=-contact) for contact in range(3)]
    assert preferred_first(grasps, Preference(contact=2, arm="right")) == grasps
    assert as_chosen(subtask(grasps=grasps), subtask()).grasps == grasps


STILL = Statement(subject="plate", word="unmoved")


def told(question: SlotQuestion) -> set[str]:
    return {str(statement) for statement in question.statements}


def test_an_object_outside_a_sub_task_may_be_said_to_be_unmoved():
    objects = [*block_and_plate(), thing("mug", (0.3, -0.1))]
    kept = searched(objects)
    (question,) = asked([kept["block-onto-plate"]], kept, objects)
    assert told(question) == {"plate unmoved", "mug unmoved"}


def test_the_result_of_an_earlier_step_may_be_said_to_last():
    second = thing("block", (0.2, -0.1), 0.0, "content", id="block_2")
    objects = [*block_and_plate(), second]
    kept = searched(objects)
    first, then = asked([kept["block-onto-plate"], kept["block_2-onto-plate"]], kept, objects)
    assert "block on plate" not in told(first)
    assert "block on plate" in told(then)


def test_for_a_repeated_sub_task_only_facts_true_both_times_may_be_said():
    second = thing("block", (0.2, -0.1), 0.0, "content", id="block_2")
    objects = [*block_and_plate(), second]
    kept = searched(objects)
    twice, other = kept["block_2-onto-plate"], kept["block-onto-plate"]
    first, _, again = asked([twice, other, twice], kept, objects)
    assert told(first) == told(again)
    assert "block on plate" not in told(again) and "plate unmoved" in told(again)


def test_parts_that_stay_closed_and_a_cabinet_that_stays_may_be_said():
    objects = [thing("cabinet_two_drawers", (0.0, 0.15)), thing("mug", (0.3, -0.1))]
    kept = searched(objects)
    opens = next(s for s in kept.values() if s.template == "open")
    (question,) = asked([opens], kept, objects)
    moved = opens.goals[0].part
    others = {f"cabinet_two_drawers/{link.name} closed" for link in objects[0].asset.model.links if link.name != moved}
    assert told(question) == {"cabinet_two_drawers unmoved", "mug unmoved", *others}


def test_neither_a_container_put_away_nor_its_contents_are_called_unmoved():
    bowl = thing("bowl", (-0.15, 0.0), 0.0, "content")
    lime = thing("lime", (-0.15, 0.0), 0.0, container="bowl", height=0.75)
    step = subtask("bowl", "table", "on", functional_point=None, template="set_down")
    (question,) = asked([step], {}, [bowl, lime, thing("plate", (0.3, 0.1))])
    assert "plate unmoved" in told(question)
    assert not {"bowl unmoved", "lime unmoved"} & told(question)


def test_a_statement_reads_as_a_goal_does():
    assert Statement(subject="c", word="open", part="lid").goal == goal_of(["c", "open", None, "lid"])
    assert str(STILL) == "plate unmoved" and STILL.goal is None


def test_other_open_parts_of_the_handled_object_are_checked_too():
    both = tuple(link.joint.far_end for link in thing("cabinet_two_drawers").asset.model.links)
    cabinet = thing("cabinet_two_drawers", (0.0, 0.06))
    cabinet = cabinet.moved(cabinet.pose, both)
    shut = [goal_of([cabinet.id, "closed", None, "drawer_top"])]
    step = subtask(cabinet.id, template="close", goals=shut)
    (question,) = asked([step], {}, [cabinet])
    told = with_open_parts(step, question, SlotAnswer(subtask=step.id))
    assert [str(s) for s in told.statements] == [f"{cabinet.id}/drawer_bottom open"]
    assert with_open_parts(step, question, told) == told
