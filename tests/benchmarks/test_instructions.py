"""How readings are compared with what a record says."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks._instructions.tasks import counted, outcome, possible
from benchmarks.instructions import agrees, load_scenes, read
from vcage.objects.library import Library
from vcage.schema.goals import AskedGoal, goal_of

SCENES = load_scenes()


def asked(*goals: tuple[str | None, ...]) -> list[AskedGoal]:
    return [AskedGoal(goal=goal_of(goal), step=step, words="x") for step, goal in enumerate(goals)]


IN_CUP = ("pen", "inside", "cup")
OPEN = ("box", "open", None, "lid")


@pytest.mark.parametrize(
    ("found", "steps", "right"),
    [
        ([IN_CUP], [[["inside", "pen", "cup"]]], True),
        ([IN_CUP], [[["inside", "pen|ruler", "cup|box"]]], True),
        ([IN_CUP], [[["on", "pen", "cup"]]], False),
        ([IN_CUP], [[["inside", "pen", "box"]]], False),
        ([IN_CUP, OPEN], [[["inside", "pen", "cup"]]], False),
        ([IN_CUP], [[["inside", "pen", "cup"], ["open", "box/lid"]]], False),
        ([OPEN, IN_CUP], [[["inside", "pen", "cup"], ["open", "box/lid"]]], True),
        ([OPEN, IN_CUP], [[["inside", "pen", "cup"]], [["open", "box/lid"]]], False),
        ([("a", "on", "b"), ("b", "on", "c")], [[["tower", "a", "b", "c"]]], True),
        ([("a", "on", "c"), ("b", "on", "c")], [[["tower", "a", "b", "c"]]], False),
    ],
)
def test_a_reading_with_the_same_goals_in_an_allowed_order_is_right(found, steps, right) -> None:
    assert agrees(asked(*found), steps) is right


def test_a_refusal_is_right_where_the_record_asks_for_one() -> None:
    refused = {"say": "Where is the mug?", "scene": "kitchen", "refuse": "a question"}
    assert read(refused, SCENES["kitchen"])[0] == "right"
    assert read({**refused, "say": "Put the banana in the pot"}, SCENES["kitchen"])[0] == "misread"
    steps = {"say": "Where is the mug?", "steps": [[["inside", "banana_ripe", "pot_steel"]]]}
    assert read(steps, SCENES["kitchen"])[0] == "refused"


def test_a_foreign_task_is_right_regardless_of_which_instance() -> None:
    library = Library.load()
    kinds = [library.entry(name) for name in ("apple", "plate", "block")]
    goal = {"relation": "on", "subject": "apple", "reference": "plate", "part": None}
    task = {"text": "Put the apple on the plate", "goals": [goal], "needs": [], "objects": ["apple", "plate"]}
    assert outcome(task, kinds)[0] == "right"
    assert outcome({**task, "goals": [{**goal, "subject": "block"}]}, kinds)[0] == "misread"
    assert outcome({**task, "text": "Throw the apple at the plate"}, kinds)[0] == "refused"


def test_tasks_of_missing_kinds_are_left_out(tmp_path: Path) -> None:
    path = tmp_path / "libero.json"
    path.write_text('[{"needs": ["kind:stove"]}, {"needs": ["verb:pour"]}]')
    assert possible(path) == [{"needs": ["verb:pour"]}]


def test_reasons_of_refusals_are_counted_without_the_words_that_they_are_about() -> None:
    told = counted([("refused", "'a' in 'b' is not understood: no"), ("refused", "'c' in 'd' is not understood: no")])
    assert (told["refused"], told["reasons"], told["right_share"]) == (2, {"no": 2}, 0.0)
