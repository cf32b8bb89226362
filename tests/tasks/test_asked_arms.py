"""Arms that an instruction names."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import (
    block_and_plate,
    robot,
    scene_of,
    sensible,
    subtask,
    thing,
    workplace,
)
from vcage.base.errors import NoFeasibleTask
from vcage.schema.goals import AskedGoal, Goal, goal_of
from vcage.schema.subtasks import Grasp, Subtask
from vcage.tasks.asked_arms import arm_for, asked_arms, bound_to, for_one_arm, require_arms, those_of
from vcage.tasks.chain_rehearsal import examined
from vcage.tasks.proven_chain import require_chain
from vcage.tasks.ruled_out import require_way
from vcage.tasks.search import FoundSubtasks, compose, find_subtasks

ON_PLATE = goal_of(["block", "on", "plate"])
HANDED = goal_of(["hammer", "handed", "right"])


def asked(goal: Goal, arm: str | None, step: int = 1) -> AskedGoal:
    return AskedGoal(goal=goal, step=step, words="with that arm", arm=arm)


def found_for(arm: str | None, objects: list | None = None, goal: Goal = ON_PLATE) -> FoundSubtasks:
    arms = {} if arm is None else {goal: arm}
    objects = objects or block_and_plate()
    return find_subtasks(workplace(objects), sensible, [goal], arms)


def step_of(found: FoundSubtasks, goal: Goal = ON_PLATE) -> Subtask:
    return next(s for s in found.kept if goal in s.goals)


def test_without_an_arm_both_arms_may_put_the_block_on_the_plate():
    assert {grasp.arm for grasp in step_of(found_for(None)).grasps} == {"left", "right"}


@pytest.mark.parametrize("arm", ["left", "right"])
def test_only_the_requested_arm_has_grasps(arm: str):
    step = step_of(found_for(arm))
    assert step.arm == arm
    assert {grasp.arm for grasp in step.grasps} == {arm}


def test_the_words_of_the_sub_task_say_the_arm():
    step = step_of(found_for("left"))
    assert step.text == "Put the red block onto the white plate with the left arm."
    assert "Use the left arm to put the red block onto the white plate." in step.texts
    assert all("left arm" in text for text in step.texts)


def test_sub_tasks_without_a_requested_arm_may_use_any():
    others = [s for s in found_for("left").kept if ON_PLATE not in s.goals]
    assert others and all(s.arm is None and "arm" not in s.text for s in others)


def test_among_objects_that_stand_elsewhere_the_arm_and_its_words_stay():
    step = step_of(found_for("right"))
    objects = [thing("block", (-0.15, 0.0), 0.1, "content"), thing("plate", (0.1, 0.0), 0.0, "receptacle")]
    then = examined(step, workplace(objects))
    assert then is not None
    assert (then.arm, then.text) == ("right", step.text)
    assert {grasp.arm for grasp in then.grasps} == {"right"}


def test_an_object_out_of_the_arms_reach_is_refused_by_name_with_the_way_out():
    objects = [thing("block", (0.5, 0.2), 0.3, "content"), thing("plate", (0.2, 0.05), 0.0, "receptacle")]
    found = found_for("left", objects)
    scene = scene_of(objects).model_copy(update={"goals": [asked(ON_PLATE, "left")]})
    with pytest.raises(NoFeasibleTask) as refused:
        compose(scene, objects, found.kept, found.refused)
    assert "block on plate ('with that arm') with the left arm" in refused.value.message
    assert "the left arm does not reach" in refused.value.message and "red block" in refused.value.message
    assert "leave the arm out" in refused.value.hint


def test_a_requested_arm_excludes_a_hand_over():
    goal = goal_of(["cookie_box", "inside", "packaging_box"])
    objects = [thing("cookie_box", (-0.6, 0.1), 0.3), thing("packaging_box", (0.6, 0.1))]
    assert step_of(found_for(None, objects, goal), goal).hand_to == "right"
    assert not [s for s in found_for("right", objects, goal).kept if goal in s.goals]


def test_a_chain_for_one_arm_is_proven_with_that_arm():
    objects = block_and_plate()
    scene = scene_of(objects).model_copy(update={"goals": [asked(ON_PLATE, "right")]})
    require_chain(scene, objects, np.random.default_rng(0))


def test_a_hand_over_is_assigned_to_the_giving_arm():
    objects = [thing("hammer", (-0.05, 0.0), 0.0, "content")]
    step = step_of(found_for("left", objects, HANDED), HANDED)
    assert (step.arm, step.hand_to) == ("left", "right")
    assert {grasp.arm for grasp in step.grasps} == {"left"}
    assert "from the left arm to the right arm" in step.text


def test_the_put_down_after_a_hand_over_is_assigned_to_the_taking_arm():
    on_table = goal_of(["hammer", "on", "table"])
    assert arm_for([HANDED, on_table], {on_table: "right"}, "right") == (None, None)
    assert arm_for([HANDED, on_table], {on_table: "left"}, "right")[1] is not None


def test_one_goal_is_not_asked_of_two_arms():
    with pytest.raises(NoFeasibleTask, match="the left arm and of the right arm"):
        asked_arms([asked(ON_PLATE, "left"), asked(ON_PLATE, "right", 2)])


@pytest.mark.parametrize(
    ("goal", "arm", "why"), [(ON_PLATE, "third", "no arm 'third'"), (HANDED, "right", "cannot give")]
)
def test_an_arm_that_cannot_be_meant_is_refused_at_once(goal: Goal, arm: str, why: str):
    objects = block_and_plate()
    with pytest.raises(NoFeasibleTask, match=why):
        require_arms([asked(goal, arm)], robot().arms)
    with pytest.raises(NoFeasibleTask, match=why):
        require_way([asked(goal, arm)], objects, robot().arms)


def test_a_hand_over_has_a_giver_and_a_taker():
    arms = dict.fromkeys(("left", "right", "middle"), 0)
    assert [*those_of(arms, "middle", "left")] == ["left", "middle"]
    assert those_of(arms, None, "left") is arms


def test_sentences_that_cannot_take_an_arm_are_left_out():
    step = subtask(texts=["The block goes on the plate.", "Could you put the block on the plate?"])
    bound = bound_to(step.model_copy(update={"grasps": [Grasp(contact=0, arm="left", score=0.0)]}), "left")
    assert bound.texts == [
        "Could you put the block on the plate with the left arm?",
        "Use the left arm to put the block on the plate.",
    ]


def test_a_drawer_is_opened_by_the_requested_arm():
    cabinet = thing("cabinet_two_drawers", (0.0, 0.15))
    goals = [goal_of([cabinet.id, "open", None, link.name]) for link in cabinet.asset.model.links]
    either = {grasp.arm for grasp in step_of(found_for(None, [cabinet], goals[0]), goals[0]).grasps}
    assert either == {"left", "right"}
    found = found_for("left", [cabinet], goals[0])
    step, other = step_of(found, goals[0]), step_of(found, goals[1])
    assert {grasp.arm for grasp in step.grasps} == {"left"} and step.text.endswith(" with the left arm.")
    assert {grasp.arm for grasp in other.grasps} == {"left", "right"}


BAR, SCALE, SCANNER = thing("chocolate_bar"), thing("electronic_scale"), thing("barcode_scanner")
BLOCK, PLATE, SIGN = thing("block"), thing("plate"), thing("payment_sign")
OBJECTS = [BAR, SCALE, SCANNER, BLOCK, PLATE, SIGN]


def goal(subject: str, relation: str, reference: str | None = None) -> Goal:
    return Goal(subject=subject, relation=relation, reference=reference)  # pyrefly: ignore


def test_an_object_weighed_and_scanned_shares_a_group_with_scale_and_scanner():
    goals = [goal(BAR.id, "weighed"), goal(BAR.id, "scanned"), goal(SIGN.id, "presented")]
    assert for_one_arm(OBJECTS, goals) == [{BAR.id, SCALE.id, SCANNER.id}]


def test_an_object_put_on_a_plate_may_change_hands():
    assert for_one_arm(OBJECTS, [goal(BLOCK.id, "on", PLATE.id)]) == []


def test_a_stacked_object_may_not_change_hands():
    other = thing("block", id="block_2")
    assert for_one_arm([*OBJECTS, other], [goal(other.id, "on", BLOCK.id)]) == [{other.id, BLOCK.id}]


def test_things_that_have_nothing_to_do_with_each_other_are_apart():
    other = thing("block", id="block_2")
    goals = [goal(other.id, "on", BLOCK.id), goal(BAR.id, "weighed")]
    assert sorted(map(sorted, for_one_arm([*OBJECTS, other], goals))) == [["block", "block_2"], [BAR.id, SCALE.id]]


@pytest.mark.parametrize(
    ("goals", "arms", "why"),
    [
        ([goal_of(["pot", "held_by_both"])], ["left"], "pot held_by_both takes 2 arms, and the robot has 1"),
        (
            [goal_of([name, "held_up"]) for name in ("can", "block", "mug")],
            ["left", "right"],
            "block held_up and can held_up and mug held_up take 3 arms, and the robot has 2",
        ),
    ],
)
def test_a_robot_with_too_few_arms_is_named_at_once(goals: list[Goal], arms: list[str], why: str):
    with pytest.raises(NoFeasibleTask, match=why):
        require_arms([asked(goal, None) for goal in goals], arms)


@pytest.mark.parametrize(
    ("held", "then", "why"),
    [
        (["pot held_by_both"], "apple on plate", "apple on plate comes after pot held_by_both, when no arm is free"),
        (["can held_up", "mug held_up"], "apple lifted", "after can held_up and mug held_up, when no arm is free"),
        (["can held_up"], "mug handed left", "mug handed left comes after can held_up, when 1 arm is free"),
    ],
)
def test_nothing_is_done_with_arms_that_hold_things_up(held: list[str], then: str, why: str):
    goals = [asked(goal_of(text.split()), None) for text in held]
    with pytest.raises(NoFeasibleTask, match=why):
        require_arms([*goals, asked(goal_of(then.split()), None, step=2)], ["left", "right"])


def test_one_arm_is_not_asked_to_hold_up_two_things():
    held = [goal_of([name, "held_up"]) for name in ("can", "mug")]
    with pytest.raises(NoFeasibleTask, match="can held_up and mug held_up are asked of the left arm"):
        require_arms([asked(goal, "left") for goal in held], ["left", "right"])


def test_one_arm_is_not_asked_for_what_takes_both():
    with pytest.raises(NoFeasibleTask, match="it takes 2 arms, not the left arm alone"):
        require_arms([asked(goal_of(["pot", "held_by_both"]), "left")], ["left", "right"])
