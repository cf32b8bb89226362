"""The review of sentences that say a task."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.objects.test_scene_names import LIBRARY, look
from vcage.models.wordings import TaskToWord
from vcage.schema.goals import AskedGoal, Description, goal_of

THINGS = {
    "apple": look("apple"),
    "pear": look("pear"),
    "plate": look("plate", "white"),
    "mug": look("mug", "blue"),
    "cabinet": look("cabinet_two_drawers", "white"),
    "lamp": look("flashlight"),
    "scale": look("electronic_scale"),
}
PHRASES = {
    "apple": "red apple", "pear": "green pear", "plate": "white plate", "mug": "blue mug",
    "cabinet": "white two-drawer cabinet", "lamp": "black flashlight", "scale": "white electronic scale",
}  # fmt: skip

CATALOGUE = LIBRARY.entries()


def task(*goals: tuple[int, tuple[str | None, ...]], instruction: str = "Do it", **more: object) -> TaskToWord:
    asked = [AskedGoal(goal=goal_of(goal), step=step, words="it") for step, goal in goals]
    none = {"untouched": [], "descriptions": [], "lying": {}, "tools": []}
    fields = {**none, "things": THINGS, "phrases": PHRASES, "catalogue": CATALOGUE, **more}
    return TaskToWord(instruction=instruction, goals=asked, **fields)


ON = (1, ("apple", "on", "plate"))
LEFT = (1, ("pear", "left_of", "plate"))
TOP, BOTTOM = (1, ("mug", "inside", "cabinet", "drawer_top")), (1, ("pear", "inside", "cabinet", "drawer_bottom"))
STEPS = ((1, ("cabinet", "open", None, "drawer_top")), (2, ("mug", "inside", "cabinet", "drawer_top")))
OF = "drawer of the cabinet"
THEN_BOTTOM = (*STEPS, (3, ("cabinet", "open", None, "drawer_bottom")))


@pytest.mark.parametrize(
    ("asked", "sentence"),
    [
        (task(ON), "Put the apple on the plate."),
        (task(ON), "Could you take the red apple and set it down onto the white plate?"),
        (task(ON), "Please put the apple on top of the plate"),
        (task((1, ("mug", "held_by_both"))), "Lift the mug with both arms."),
        (task(ON, LEFT), "Put the apple on the plate and the pear to the left of the plate."),
        (task(TOP, BOTTOM), "The mug goes into the top drawer and the pear into the bottom drawer of the cabinet."),
        (task(*STEPS), "Open the top drawer of the cabinet, then put the mug in it."),
        (task(*STEPS), "Open the topmost drawer of the cabinet, then put the mug in it."),
        (task(*THEN_BOTTOM), f"Open the top {OF}, then put the mug into the top {OF}, then open the bottom {OF}."),
        (task(ON, untouched=["mug"]), "Put the apple on the plate, but leave the mug alone."),
        (task((1, ("apple", "weighed")), tools=["scale"]), "Put the apple on the scale to check its weight."),
    ],
)
def test_a_sentence_that_asks_for_exactly_the_goals_is_taken(asked, sentence):
    assert asked.complaints(sentence) == []


@pytest.mark.parametrize(
    ("asked", "sentence", "about"),
    [
        (task(ON), "Put the pear on the plate.", "nothing that the task is about"),
        (task(ON), "Put the fruit on the plate.", "may mean apple, pear"),
        (task(ON), "Put the banana and the apple on the plate.", "there is no 'banana'"),
        (task(ON), "Put the green apple on the plate.", "there is none"),
        (task(ON), "Put the two apples on the plate.", "there are 1"),
        (task(ON), "Put the apple on the left plate.", "there is none"),
        (task(ON), "Put the apple beside the plate.", "does not say 'apple on plate'"),
        (task(ON), "Put the apple on the plate with the left arm.", "'left' is not asked for"),
        (task(ON), "Put the apple on the plate, leftmost.", "'leftmost' is not asked for"),
        (task(ON), "Put the apple on the plate in one go.", "'one' says nothing"),
        (task(ON), "Weigh the apple and put it on the plate.", "'weigh' is not asked for"),
        (task(ON), "Don't put the apple on the plate.", "nothing is to be left alone"),
        (task(ON), "Put the apple on the plate first.", "asks for an order"),
        (task(ON), "Put everything on the plate, the apple too.", "speaks of all"),
        (task(ON), "Put the apple on the plate.\nThen", "on one line"),
        (task(ON, LEFT), "Put the pear on the plate and the apple to the left of the plate.", "'apple on plate'"),
        (task(LEFT), "Put the pear to the right of the plate.", "'right' is not asked for"),
        (task(TOP, BOTTOM), "The mug goes in the bottom drawer and the pear in the top drawer of the cabinet.", "part"),
        (task(*STEPS), "Put the mug in the top drawer of the cabinet and open it.", "in their order"),
        (task(*THEN_BOTTOM), f"Open the bottom {OF}, then open the top {OF}, then put the mug in it.", "their order"),
        (task(ON, untouched=["mug"]), "Put the apple on the plate.", "to be left alone"),
        (task(ON, instruction="All the fruit goes on the plate"), "Put the apple on the plate.", "speaks of all"),
    ],
)
def test_an_unclear_untrue_or_different_sentence_is_complained_about(asked, sentence, about):
    assert any(about in complaint for complaint in asked.complaints(sentence)), asked.complaints(sentence)


def test_the_arm_that_must_do_it_is_named():
    by_left = replace(task(ON), goals=[AskedGoal(goal=goal_of(ON[1]), step=1, words="it", arm="left")])
    assert by_left.complaints("Put the apple on the plate with the left arm.") == []
    assert by_left.complaints("Put the apple on the plate.")
    assert by_left.complaints("Put the apple on the plate with the right arm.")


def test_a_side_given_by_a_description_may_be_mentioned():
    told = Description(subject="plate", relation="left_of", reference="table", words="the plate on the left")
    described = task(ON, descriptions=[told])
    assert described.complaints("Put the apple on the left plate.") == []
    assert described.complaints("Put the apple on the plate on the left.") == []
    assert described.complaints("Put the apple on the right plate.")


def starting(word: str, holder: str, part: str | None = None) -> Description:
    return Description(subject="apple", relation=word, reference=holder, part=part, words="it")  # pyrefly: ignore


FROM_TOP, OUT_OF_MUG = starting("inside", "cabinet", "drawer_top"), starting("inside", "mug")


@pytest.mark.parametrize(
    ("told", "sentence"),
    [
        (FROM_TOP, "Put the apple from the top drawer of the cabinet on the plate."),
        (FROM_TOP, "Take the apple out of the top drawer and set it on the plate."),
        (FROM_TOP, "The apple in the top drawer of the cabinet goes on the plate."),
        (OUT_OF_MUG, "Get the apple out of the mug and put it on the plate."),
        (starting("on", "scale"), "Move the apple from the scale onto the plate."),
    ],
)
def test_a_sentence_that_says_where_a_thing_is_taken_from_is_taken(told, sentence):
    assert task(ON, descriptions=[told]).complaints(sentence) == []


@pytest.mark.parametrize(
    ("told", "sentence"),
    [
        (FROM_TOP, "Put the apple on the plate."),
        (FROM_TOP, "Put the apple from the cabinet on the plate."),
        (FROM_TOP, "Put the apple from the bottom drawer of the cabinet on the plate."),
        (OUT_OF_MUG, "Put the apple on the plate."),
        (OUT_OF_MUG, "Put the apple beside the mug on the plate."),
    ],
)
def test_a_sentence_must_say_where_a_thing_is_taken_from(told, sentence):
    complaints = task(ON, descriptions=[told]).complaints(sentence)
    assert any("does not say that the red apple is taken from" in complaint for complaint in complaints)


def test_the_thing_that_one_is_taken_from_may_be_where_it_goes():
    move = task((1, ("apple", "inside", "cabinet", "drawer_bottom")), descriptions=[FROM_TOP])
    said = "Put the apple from the {} drawer of the cabinet into the {} drawer of the cabinet."
    assert move.complaints(said.format("top", "bottom")) == []
    assert move.complaints(said.format("bottom", "top"))


def test_sentences_are_reviewed_each_once():
    good = "Put the apple on the plate."
    assert task(ON).reviewed([good, "Put the pear on the plate.", good]) == [good]
