"""The check of a reading: its input, and the readings it must accept."""

from __future__ import annotations

import pytest

from tests.models.catalogue import CATALOGUE, entry
from vcage.models.checked_reading import Instructed
from vcage.models.second_look import second_look, unmet_names
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import AskedGoal, Description, Reading, goal_of

CABINET = entry("cabinet", "cabinet", "furniture", holds="in").model_copy(
    update={"moving_parts": ["drawer_top", "drawer_bottom"]}
)
PEACH = entry("peach", "peach", "fruit", ("orange",))
KINDS = {kind.name: kind for kind in [*CATALOGUE, CABINET, PEACH]}


def look(name: str, colour: str | None = None) -> CatalogueEntry:
    kind = KINDS[name]
    return kind.model_copy(update={"variants": [v for v in kind.variants if colour in (None, v.id)][:1]})


THINGS = {
    "apple_red": look("apple", "red"),
    "apple_green": look("apple", "green"),
    "peach": look("peach"),
    "mug_white": look("mug", "white"),
    "mug_red": look("mug", "red"),
    "plate": look("plate"),
    "bowl": look("bowl"),
    "cabinet": look("cabinet"),
}
MUGS = ["mug_red on plate", "mug_white on plate"]


def _named(text: str) -> list[str | None]:
    subject, relation, *rest = text.split()
    reference, _, part = (rest[0] if rest else "").partition("/")
    return [subject, relation, reference or None, part or None]


def look_at(
    task: str, *goals: str, told: str = "", arm: str | None = None, untouched: tuple[str, ...] = ()
) -> list[str]:
    """The complaints about goals such as "apple_red on plate", whose words are the whole task."""
    asked = [AskedGoal(goal=goal_of(_named(text)), step=1, words=task, arm=arm) for text in goals]
    said = [one.split() for one in told.split(", ") if one]
    fields = [dict(zip(("subject", "relation", "reference"), one, strict=True)) for one in said]
    descriptions = [Description(**one, words=task) for one in fields]
    return second_look(
        Instructed(task, THINGS), Reading(goals=asked, untouched=list(untouched), descriptions=descriptions)
    )


@pytest.mark.parametrize(
    ("task", "goals", "said"),
    [
        ("Put the green apple on the plate", ["peach on plate"], "'green apple', but no goal speaks"),
        ("Put the green apple on the plate", ["apple_red on plate"], "asks for green"),
        ("Put both mugs on the plate", ["mug_red on plate"], "asks for 2, but the goals speak of 1"),
        ("Put a mug on the plate", MUGS, "asks for 1, but goals are given for 2"),
        ("Put one red and two white mugs on the plate", MUGS, "'two white mugs' asks for 3, but the goals speak of 2"),
        ("Put two red and one white mug on the plate", MUGS, "'two red' asks for 2, but goals are given for 1"),
        ("Put one red and one green apple on the plate", ["apple_red on plate"], "'one green apple' asks for 2"),
        ("Put the peach to the left of the plate", ["peach right_of plate"], "but 'right_of'"),
        ("Put the peach behind the plate", ["peach in_front_of plate"], "but 'in_front_of'"),
        ("Put the peach in the top drawer", ["peach inside cabinet/drawer_bottom"], "the top drawer is named"),
        ("Put all the mugs on the plate", ["mug_red on plate"], "no goal speaks of mug_white"),
        ("Put the peach on the left plate", ["peach on plate"], "'the left …' is said"),
        ("Put the peach on the plate with the left arm", ["peach on plate"], "'left arm' is said"),
        ("Put the peach on the plate", ["peach on plate", "bowl on table"], "the instruction names no such object"),
        ("Put the peach on the plate", ["peach inserted_in bowl"], "names 'plate'"),
        ("Take the peach out of the bowl and put it on the plate", ["peach on plate"], "names 'bowl'"),
    ],
)
def test_a_misreading_is_seen(task: str, goals: list[str], said: str) -> None:
    found = look_at(task, *goals)
    assert any(said in complaint for complaint in found), found


def test_an_opening_where_a_closing_is_asked_is_seen() -> None:
    asked = AskedGoal(goal=goal_of(["cabinet", "open", None, "drawer_top"]), step=1, words="Close the top drawer")
    found = second_look(Instructed("Close the top drawer", THINGS), Reading(goals=[asked]))
    assert "'close the' is said, but no goal says 'closed'" in found


def test_what_things_are_poured_out_of_need_not_be_named() -> None:
    task = "Pour the peach into the bowl and put the green apple on the plate"
    assert look_at(task, "mug_red poured bowl", "apple_green on plate", told="peach inside mug_red") == []


def test_words_that_no_goal_answers_are_named() -> None:
    asked = AskedGoal(goal=goal_of(["peach", "on", "plate"]), step=1, words="Put the peach on the plate")
    found = second_look(Instructed("Put the peach on the plate and stir the soup", THINGS), Reading(goals=[asked]))
    assert found == ["the words 'stir', 'soup' are in no 'words' of a goal or description"]


@pytest.mark.parametrize(
    ("task", "goals"),
    [
        ("Put the apples on the plate", ["apple_red on plate", "apple_green on plate"]),
        ("Could you put two mugs on the plate, please?", MUGS),
        ("Put one red and one white mug on the plate", MUGS),
        ("Put one red mug and a white one on the plate", MUGS),
        ("Put the red mug, sorry, the white one on the plate", ["mug_white on plate"]),
        ("All the mugs except the red one go on the plate", ["mug_white on plate"]),
        ("Put the fruit in the bowl", ["apple_red inside bowl", "apple_green inside bowl", "peach inside bowl"]),
        ("Can you put the peach right away on the plate?", ["peach on plate"]),
        ("Put one red mug in the bowl and a white one on the plate", ["mug_red inside bowl", "mug_white on plate"]),
        ("Put the mugs away", ["mug_red inside bowl", "mug_white inside bowl"]),
        ("Fill the bowl", ["peach inside bowl"]),
        ("Pass the peach from the left arm to the right arm", ["peach handed right"]),
        ("Hang up the red mug and put the red apple on the plate", ["mug_red hung_on bowl", "apple_red on plate"]),
    ],
)
def test_a_right_reading_is_left_alone(task: str, goals: list[str]) -> None:
    assert look_at(task, *goals) == []


def test_descriptions_arms_and_objects_left_alone_answer_words() -> None:
    for task in ("Take the peach out of the bowl and put it on the plate", "Empty the bowl onto the plate"):
        assert look_at(task, "peach on plate", told="peach inside bowl") == []
    assert look_at("Put the peach on the plate with the left arm", "peach on plate", arm="left") == []
    assert look_at("Put the peach on the plate and leave the bowl alone", "peach on plate", untouched=("bowl",)) == []


def test_the_right_way_up_is_no_side() -> None:
    assert not any("right_of" in one for one in look_at("Turn the peach the right way up", "peach upright"))


def test_the_right_one_of_a_swap_is_a_thing_and_no_arm() -> None:
    swap = ["mug_white in_place_of mug_red", "mug_red in_place_of mug_white"]
    told = "mug_white left_of mug_red, mug_red right_of mug_white"
    assert look_at("Swap the left mug with the right one", *swap, told=told) == []
    assert any("'right arm' is said" in one for one in look_at("Swap the mugs with the right arm", *swap))


def test_a_side_may_tell_the_place_where_a_thing_lies_at_the_start() -> None:
    told = "peach inside bowl, bowl left_of mug_red"
    assert look_at("Take the peach from the left bowl and put it on the plate", "peach on plate", told=told) == []


def test_a_drawer_that_a_thing_is_taken_from_must_be_described() -> None:
    task = "Take the peach from the top drawer and put it in the bottom one"
    goal = goal_of(["peach", "inside", "cabinet", "drawer_top"])
    told = Description(subject="peach", relation="inside", reference="cabinet", part="drawer_bottom", words=task)
    swapped = Reading(goals=[AskedGoal(goal=goal, step=1, words=task)], descriptions=[told])
    assert any("taken from the top drawer" in said for said in second_look(Instructed(task, THINGS), swapped))


def test_a_clause_before_once_that_is_done_comes_last() -> None:
    task = "Put the peach in the bottom drawer of the cabinet, and shut it once that's done"
    goals = [
        goal_of(["peach", "inside", "cabinet", "drawer_bottom"]),
        goal_of(["cabinet", "closed", None, "drawer_bottom"]),
    ]

    def look_at_steps(*steps: int) -> list[str]:
        asked = [AskedGoal(goal=goal, step=step, words=task) for goal, step in zip(goals, steps, strict=True)]
        return second_look(Instructed(task, THINGS), Reading(goals=asked))

    assert look_at_steps(1, 2) == []
    assert len(look_at_steps(2, 1)) == 1 and "comes before" in look_at_steps(2, 1)[0]


def test_using_an_arm_is_answered_by_the_arm() -> None:
    task = "Use the left arm to put the peach on the plate"
    asked = AskedGoal(goal=goal_of(_named("peach on plate")), step=1, words="put the peach on the plate", arm="left")
    assert second_look(Instructed(task, THINGS), Reading(goals=[asked])) == []


def test_a_goal_true_at_the_start_is_named() -> None:
    task = "Pick up the peach on the plate and put it on the plate"
    assert look_at(task, "peach on plate", told="peach on plate") == [
        "peach on plate is a goal, but true at the start already"
    ]


def test_a_handover_in_the_wrong_direction_is_seen() -> None:
    task = "Give the peach from the left hand to the right one"
    assert look_at(task, "peach handed right") == []
    assert look_at(task, "peach handed left") == ["it is handed 'left', but the instruction says 'to the right'"]


def test_weighing_and_scanning_are_goals_of_their_own() -> None:
    assert look_at("Weigh the peach", "peach on plate") == ["'weigh' is said, but no goal says 'weighed'"]
    assert look_at("Weigh the peach", "peach weighed") == []


def test_a_sentence_in_another_language_is_not_held_against_its_words() -> None:
    assert look_at("Lege den Pfirsich links neben den Teller", "peach left_of plate") == []


def test_a_name_of_the_catalogue_that_nothing_chosen_answers_to_is_named() -> None:
    said = "Put the apple to the left of the plate"
    assert unmet_names(said, KINDS.values(), [KINDS["peach"], KINDS["plate"]]) == [
        "the task names 'apple', but nothing is chosen that is called so"
    ]
    assert unmet_names(said, KINDS.values(), [KINDS["apple"], KINDS["plate"]]) == []
    assert unmet_names("Prepare breakfast for me", KINDS.values(), [KINDS["peach"]]) == []
