import pytest

from vcage.models.checked_reading import CheckedReading
from vcage.models.quantifiers import left_over, quantified
from vcage.objects.library import Library
from vcage.schema.goals import AskedGoal, Reading, goal_of

LIBRARY = Library.load()
DESK = {"cup": "mug", "tap": "tap", "box": "packaging_box", "pen": "marker", "apple": "apple"}
THINGS = {name: LIBRARY.entry(kind) for name, kind in DESK.items()}


def forgotten(said, things, spoken):
    """Complaints about a sentence whose goals put each thing on the table."""
    goals = [AskedGoal(goal=goal_of([name, "on", "table"]), step=1, words=said) for name in spoken]
    return list(left_over(CheckedReading(said, things, reading=Reading(goals=goals))))


@pytest.mark.parametrize(
    ("text", "noun", "colour"),
    [
        ("everything goes into the box", (), None),
        ("put all of them into the box", (), None),
        ("put all the red pens into the box", ("pen",), "red"),
        ("dump everything in the box and put the lid on the table", (), None),
        ("place every bread on the table into the basket", ("bread",), None),
        ("everything yellow goes in the pot", (), "yellow"),
        ("put the rest of the fruit on the plate", ("fruit",), None),
        ("the rest goes into the basket", (), None),
    ],
)
def test_a_quantifier_tells_its_noun_and_colour(text, noun, colour):
    (found,) = quantified(text)
    assert (found.noun, found.colour) == (noun, colour)


@pytest.mark.parametrize(
    "text",
    ["first of all open the box", "stack the bowls on top of each other", "put it away",
     "pour everything in the red cup into the bowl", "take the cup and tip everything that is in it into the bowl"],
)  # fmt: skip
def test_words_other_than_quantifiers_are_skipped(text):
    assert quantified(text) == []


def test_an_object_that_no_goal_speaks_of_is_named():
    (complaint,) = forgotten("Clear my desk: everything goes into the packaging box", THINGS, ["box", "pen", "apple"])
    assert "'everything'" in complaint
    assert "cup, tap" in complaint


def test_only_objects_of_the_noun_fall_under_it():
    assert forgotten("Put all the pens into the box", THINGS, ["box", "pen"]) == []
    assert len(forgotten("Put all the fruit into the box", THINGS, ["box", "pen"])) == 1


@pytest.mark.parametrize(
    ("said", "over"),
    [
        ("Put the cups and the plates into the box, put them all away", []),
        ("Open all the drawers", []),
        ("Everything that's yellow goes on the tray", ["everything"]),
        ("Please put all in the box", ["all"]),
    ],
)
def test_all_without_a_noun_means_the_objects_named_before(said: str, over: list[str]) -> None:
    assert [one.words for one in quantified(said)] == over


def test_exceptions_may_be_left_over() -> None:
    mug = LIBRARY.entry("mug")
    looks = {f"mug_{v.id}": mug.model_copy(update={"variants": [v]}) for v in mug.variants}
    said = "All the mugs except the red one go into the box"
    assert forgotten(said, looks, ["mug_white", "mug_blue", "mug_yellow_and_white"]) == []
    assert len(forgotten(said, looks, ["mug_white"])) == 1
