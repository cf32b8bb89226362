"""Complaints about a model's reading of an instruction."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from tests.models.catalogue import CATALOGUE, entry
from tests.models.scripted import Scripted, description, goal, read
from vcage.base.errors import ModelRefused, UnreadInstruction
from vcage.models.llm_reading import ThirdReader
from vcage.models.llm_reasoner import LlmReasoner
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import AskedGoal, Reading, goal_of

TASK = "Put the apple to the left of the plate"
GOOD = read(goal("apple", "left_of", "plate", words=TASK))
CABINET = entry("cabinet", "cabinet", "furniture", holds="in").model_copy(update={"moving_parts": ["drawer_top"]})


def things(*names: str) -> dict[str, CatalogueEntry]:
    kinds = {kind.name: kind for kind in [*CATALOGUE, CABINET]}
    found = {}
    for name in names:
        kind, _, look = name.partition(":")
        entry_ = kinds[kind]
        look = look or entry_.variants[0].id
        found[name.replace(":", "_")] = entry_.model_copy(
            update={"variants": [v for v in entry_.variants if v.id == look]}
        )
    return found


TWO = things("apple", "plate")


def reading(
    who: Scripted,
    task: str = TASK,
    among: Mapping[str, CatalogueEntry] = TWO,
    review: bool = False,
    third: ThirdReader | None = None,
    moved: tuple[str, ...] = (),
    lying: Mapping[str, str] | None = None,
) -> Reading:
    reasoner = LlmReasoner(who, reviewer=who if review else None, third=third)
    return reasoner.read_goals(task, among, lying or {}, moved)


def complaint_about(answer: Mapping, task: str, among: Mapping[str, CatalogueEntry], **how) -> str:
    """The complaint about an answer that is given in every round."""
    with pytest.raises(ModelRefused) as caught:
        reading(Scripted(read_goals=[answer]), task, among, **how)
    return caught.value.message


def test_a_right_reading_is_taken_at_once() -> None:
    who = Scripted(read_goals=[GOOD])
    assert [str(asked.goal) for asked in reading(who).goals] == ["apple left_of plate"]
    assert who.names() == ["read_goals"]


def test_an_arm_and_a_description_are_part_of_the_reading() -> None:
    task = "Take the apple out of the bowl with the left arm and put it on the plate"
    answer = read(
        goal("apple", "on", "plate", words=task, arm="left"),
        descriptions=[description("apple", "inside", "bowl", "out of the bowl")],
    )
    found = reading(Scripted(read_goals=[answer]), task, things("apple", "plate", "bowl"))
    assert found.goals[0].arm == "left" and [str(told) for told in found.descriptions] == ["apple inside bowl"]


@pytest.mark.parametrize(
    ("wrong", "complaint"),
    [
        (read(goal("apple", "left_of", "plate", words="the pear")), "words are not copied"),
        (read(goal("unicorn", "left_of", "plate", words=TASK)), "subject: Input should be 'apple' or 'plate'"),
        (read(goal("apple", "left_of", words=TASK)), "takes a reference"),
        (read(goal("apple", "left_of", "apple", words=TASK)), "its own reference"),
        (read(goal("apple", "left_of", "table", words=TASK)), "only 'on' it"),
        (read(goal("apple", "left_of", "plate", words=TASK, step=0)), "step counts from 1"),
        (read(goal("apple", "left_of", "plate", words=TASK), untouched=["apple"]), "untouched"),
        (read(goal("apple", "left_of", "plate", words=TASK), unread=["left"]), "unread or wrong_objects is not"),
        (read(), "goals: is empty"),
        (read(*[goal("apple", "left_of", "plate", words=TASK)] * 2), "given 2 times"),
        (
            read(*(goal("apple", word, "plate", words=TASK) for word in ("left_of", "right_of"))),
            "that is a circle",
        ),
        (
            read(*(goal("apple", "on", place, words=TASK) for place in ("plate", "table"))),
            "goals of one step contradict each other",
        ),
        (
            read(
                goal("apple", "left_of", "plate", words=TASK),
                descriptions=[description("apple", "beside", "table", "the apple")],
            ),
            "says nothing of a place on the table",
        ),
    ],
)
def test_an_answer_that_cannot_be_right_is_complained_about(wrong: dict, complaint: str) -> None:
    who = Scripted(read_goals=[wrong, GOOD])
    reading(who)
    assert complaint in who.complaints()


def test_a_part_that_is_not_there_is_named_with_those_that_are() -> None:
    task = "Put the apple into the cabinet"
    answer = read(goal("apple", "inside", "plate", words=task, part="drawer_top"))
    assert "plate has no moving part 'drawer_top'" in complaint_about(answer, task, things("apple", "plate", "cabinet"))


def test_the_second_look_is_a_complaint() -> None:
    wrong = read(goal("apple", "right_of", "plate", words=TASK))
    assert "is asked, but no goal or description says 'left_of', but 'right_of'" in complaint_about(wrong, TASK, TWO)


def test_an_object_that_was_chosen_to_be_moved_and_is_in_no_goal_is_named() -> None:
    among = things("apple", "plate", "croissant")
    assert "croissant is to be moved" in complaint_about(GOOD, TASK, among, moved=("apple", "croissant"))


def test_a_review_that_disagrees_is_a_complaint_and_then_a_refusal() -> None:
    who = Scripted(read_goals=[GOOD], review_goals=[{"lacks": ["the pear"], "adds": []}])
    with pytest.raises(ModelRefused, match="the goals lack this: the pear"):
        reading(who, review=True)
    assert who.names() == ["read_goals", "review_goals"] * 3


def test_a_review_sees_the_goals_in_plain_words() -> None:
    who = Scripted(read_goals=[GOOD])
    reading(who, review=True)
    assert "- the red apple is to the left of the white plate." in who.asked[1].messages[0].text


def test_another_reader_that_reads_it_otherwise_is_a_complaint() -> None:
    def third(*_: object) -> Reading:
        asked = AskedGoal(goal=goal_of(["apple", "on", "plate"]), step=1, words=TASK)
        return Reading(goals=[asked])

    task = "Put the apple on the plate"
    who = Scripted(
        read_goals=[read(goal("apple", "beside", "plate", words=task)), read(goal("apple", "on", "plate", words=task))]
    )
    reading(who, task, third=third)
    assert "a grammar reads the instruction otherwise: it asks for apple on plate" in who.complaints()


def test_another_reader_that_cannot_read_it_is_not_heard() -> None:
    def third(*_: object) -> Reading:
        raise UnreadInstruction("no")

    assert reading(Scripted(read_goals=[GOOD]), third=third).goals


def test_words_without_a_goal_end_the_reading_and_wrong_objects_say_whose_fault_it_is() -> None:
    with pytest.raises(UnreadInstruction, match="stir") as caught:
        reading(Scripted(read_goals=[read(unread=["stir the soup"])]))
    assert caught.value.details["wrong_objects"] == []
    with pytest.raises(UnreadInstruction) as caught:
        reading(Scripted(read_goals=[read(wrong_objects=["there is no pear"])]))
    assert caught.value.details["wrong_objects"] == ["there is no pear"]


def test_a_sentence_of_another_language_is_read_without_checks_of_its_words() -> None:
    task = "Leg den Apfel auf den Teller"
    found = reading(Scripted(read_goals=[read(goal("apple", "on", "plate", words="den Apfel auf den Teller"))]), task)
    assert [str(asked.goal) for asked in found.goals] == ["apple on plate"]


def test_a_source_that_no_description_says_is_a_complaint() -> None:
    task = "Take the apple off the plate and put it on the table"
    answer = read(goal("apple", "on", "table", words=task))
    told = complaint_about(answer, task, TWO, moved=("apple",), lying={"apple": "plate"})
    assert "apple starts in or on plate, and no description says so" in told
