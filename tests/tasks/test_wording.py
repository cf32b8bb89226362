from __future__ import annotations

from dataclasses import replace

import pytest

from tests.models.test_wordings import BOTTOM, LEFT, ON, STEPS, TOP, starting, task
from tests.objects.test_scene_names import look
from vcage.models.wordings import TaskToWord
from vcage.schema.goals import AskedGoal, Description, goal_of
from vcage.tasks.wording import by_arm, in_one_sentence, template_wordings, wordings

PHRASES = {"pen": "red pen", "cabinet": "white cabinet", "bell": "service bell"}


@pytest.mark.parametrize(
    ("goal", "first"),
    [
        (("pen", "inside", "cabinet", "drawer_top"), "Put the red pen into the top drawer of the white cabinet."),
        (("pen", "on", "cabinet", None), "Put the red pen onto the white cabinet."),
        (("cabinet", "open", None, "drawer_top"), "Open the top drawer of the white cabinet."),
        (("cabinet", "closed", None, "drawer_top"), "Close the top drawer of the white cabinet."),
        (("bell", "pressed", None, "button"), "Press the button of the service bell."),
        (("bell", "turned", None, "dial"), "Turn the dial of the service bell."),
        (("pen", "handed", "right"), "Hand the red pen to the right arm, which puts it down."),
    ],
)
def test_a_goal_has_at_least_ten_wordings(goal: tuple[str | None, ...], first: str) -> None:
    found = wordings(goal_of(goal), PHRASES)
    assert found[0] == first
    assert len(set(found)) == len(found) >= 10
    assert all(PHRASES[goal[0] or ""] in sentence and sentence[-1] in ".?" for sentence in found)


def test_a_hit_names_the_tool_that_it_is_done_with() -> None:
    goal, phrases = goal_of(("pen", "hit")), {"pen": "red pen", "mallet": "wooden mallet"}
    assert all("the wooden mallet" in text for text in wordings(goal, phrases, tool="mallet"))
    assert wordings(goal, phrases)[0] == "Hit the red pen with a tool."


OPEN = ["Open the drawer.", "Please open the drawer.", "Pull the drawer open.", "The drawer should be open."]
PUT = ["Put the red cup into the drawer.", "Place the red cup in the drawer."]
WEIGH = ["Weigh the apple."]


def test_one_command_has_its_own_wordings():
    assert in_one_sentence([[OPEN]]) == OPEN


def test_steps_are_stated_in_their_order_with_then():
    found = in_one_sentence([[OPEN], [PUT]])
    assert found[0] == "Open the drawer, then put the red cup into the drawer."
    assert "Pull the drawer open, then place the red cup in the drawer." in found


def test_goals_in_any_order_are_joined_by_and():
    assert in_one_sentence([[PUT, WEIGH]])[0] == "Put the red cup into the drawer and weigh the apple."


def test_wishes_and_statements_are_not_strung_together():
    assert not any("please" in text.lower() or "should" in text for text in in_one_sentence([[OPEN], [PUT]]))


def test_a_command_names_the_arm_that_must_do_it():
    assert by_arm(PUT[:1], "left") == [
        "Put the red cup into the drawer with the left arm.",
        "Use the left arm to put the red cup into the drawer.",
    ]


def pens(*colours: str, into: int | None = None, **more: object) -> TaskToWord:
    """So many of some pens shall go into a box."""
    names = [f"pen_{n}" for n, _ in enumerate(colours)]
    things = {name: look("marker", colour) for name, colour in zip(names, colours, strict=True)}
    phrases = {name: f"{colour} marker pen" for name, colour in zip(names, colours, strict=True)}
    goals = [(1, (name, "inside", "box")) for name in names[:into]]
    box = {"box": look("packaging_box")}
    return task(*goals, things=things | box, phrases=phrases | {"box": "brown packaging box"}, **more)


def test_a_task_has_a_full_and_a_short_sentence():
    found = template_wordings(task(ON))
    assert found[:2] == ["Put the red apple onto the white plate.", "Put the apple onto the plate."]
    assert len(found) >= 20


def test_only_the_requests_of_the_instruction_are_stated():
    assert not any("open" in text.lower() for text in template_wordings(task(TOP)))


def test_several_objects_for_one_place_share_a_clause():
    found = template_wordings(pens("red", "blue"))
    assert found[:2] == [
        "Put the red marker pen and the blue marker pen into the brown packaging box.",
        "Put the marker pens into the packaging box.",
    ]


def test_some_of_a_kind_are_called_by_their_colours():
    found = template_wordings(pens("red", "blue", "green", into=2))
    assert found
    assert all("red marker pen" in text and "blue marker pen" in text for text in found)


def test_all_of_one_phrase_have_a_name_and_one_of_them_has_none():
    assert template_wordings(pens("red", "red"))[0] == "Put the two red marker pens into the brown packaging box."
    assert template_wordings(pens("red", "red", into=1)) == []


def test_one_of_two_alike_is_named_by_its_description():
    left = Description(subject="pen_0", relation="left_of", reference="pen_1", words="the left pen")
    found = template_wordings(pens("red", "red", into=1, descriptions=[left]))
    assert "Put the left marker pen into the packaging box." in found


def test_an_object_starting_in_a_drawer_or_a_mug_is_taken_from_there():
    drawer = starting("inside", "cabinet", "drawer_top")
    assert template_wordings(task(ON, descriptions=[drawer]))[:4] == [
        "Put the red apple from the top drawer of the white two-drawer cabinet onto the white plate.",
        "Put the apple from the top drawer of the two-drawer cabinet onto the plate.",
        "Take the red apple out of the top drawer of the white two-drawer cabinet and put it onto the white plate.",
        "Take the apple out of the top drawer of the two-drawer cabinet and put it onto the plate.",
    ]
    mug = template_wordings(task(ON, descriptions=[starting("inside", "mug")]))
    assert mug and all("from the" in text or "out of the" in text for text in mug)


def test_two_objects_from_two_places_are_requested_one_by_one():
    pear = (1, ("pear", "on", "plate"))
    lying = [starting("inside", "mug"), starting("on", "scale").model_copy(update={"subject": "pear"})]
    found = template_wordings(task(ON, pear, descriptions=lying))
    assert (
        found[1]
        == "Put the apple from the mug onto the plate and put the pear from the electronic scale onto the plate."
    )
    assert "Take the apple out of the mug and put it onto the plate" in found[3]
    assert "take the pear off the electronic scale and put it onto the plate" in found[3]


def test_goals_of_one_step_are_joined_by_and_those_of_several_by_then():
    assert "Put the apple onto the plate and put the pear to the left of the plate." in template_wordings(
        task(ON, LEFT)
    )
    first = template_wordings(task(*STEPS))[1]
    assert first == (
        "Open the top drawer of the two-drawer cabinet, then put the mug into the top drawer of the two-drawer cabinet."
    )


def test_each_goal_keeps_its_part():
    assert len(template_wordings(task(TOP, BOTTOM))) >= 10


def test_a_push_has_wording_of_its_own():
    found = template_wordings(task(LEFT), pushed=[goal_of(LEFT[1])])
    assert found[0] == "Push the green pear to the left of the white plate."


def test_the_required_arm_is_stated():
    by_left = replace(task(ON), goals=[AskedGoal(goal=goal_of(ON[1]), step=1, words="it", arm="left")])
    found = template_wordings(by_left)
    assert "Put the apple onto the plate with the left arm." in found
    assert all("left arm" in text for text in found)


def test_objects_to_be_left_alone_rule_out_template_wordings():
    assert template_wordings(task(ON, untouched=["mug"])) == []


def test_where_all_of_a_kind_are_meant_every_sentence_says_so():
    found = template_wordings(pens("red", "blue", instruction="All the pens go into the box"))
    assert found[0] == "Put all the marker pens into the brown packaging box."
    assert all("all the marker pens" in text for text in found)
    assert template_wordings(pens("red", "blue", instruction="Everything goes into the box")) == []
