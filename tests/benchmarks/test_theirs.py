"""The tasks of others: which of their sentences are read right, and what their goals say in our vocabulary."""

from __future__ import annotations

from dataclasses import replace

import pytest

from benchmarks._sentences.sources import Sentence
from benchmarks._sentences.whole import Ran, Tried, Whole
from benchmarks._theirs.reading import Found, means
from benchmarks._theirs.tasks import SUITES, Task, tasks, whole
from benchmarks.theirs import QUICK_TASKS, chosen, figures
from tests.models.rules.scenes import kinds, read
from vcage.models.selection_check import entries_of, name_objects


def task(text: str, *goals: str, start: tuple[str, ...] = ()) -> Task:
    return Task("ours", text, goals, start, "", {"cabinet": ("cabinet_three_drawers", "cabinet_two_drawers")})


def is_right(asked: Task) -> bool:
    found, reading = read(asked.text)
    return means(reading, entries_of(name_objects(found, kinds()), kinds()), asked)


def test_the_suites_have_all_their_tasks_each_with_goals_or_with_what_no_goal_states() -> None:
    assert [len({one.id for one in tasks(suite)}) for suite in SUITES] == [112, 50]
    assert all(bool(one.goals) != bool(one.lacks) for suite in SUITES for one in tasks(suite))
    assert {one.id for one in whole()} < {one.id for one in tasks("libero")}


def test_quick_takes_tasks_from_the_whole_of_a_suite() -> None:
    few = chosen("robotwin", QUICK_TASKS)
    assert len(few) == QUICK_TASKS and few[0] == tasks("robotwin")[0] and few[-1] in tasks("robotwin")[40:]


@pytest.mark.parametrize(
    "asked",
    [
        task("Put the lemon in the basket", "lemon inside basket"),
        task("Open the top drawer of the cabinet", "cabinet/drawer_top open"),
        task("Put the red mug on the right plate", "mug/red on plate", start=("plate right_of plate_2",)),
        task("Put the red mug on the right plate", "mug/red on plate", start=("plate_2 left_of plate",)),
        task("Put the lemon in the basket, then open the microwave", "lemon inside basket", "then microwave/door open"),
        task("Put the red block on the blue block", "block/red on block/blue"),
    ],
)
def test_a_reading_is_right_that_asks_for_the_goals_of_the_task(asked: Task) -> None:
    assert is_right(asked)


@pytest.mark.parametrize(
    "asked",
    [
        task("Put the lemon in the basket", "lemon on basket"),
        task("Put the lemon in the basket", "lime inside basket"),
        task("Put the lemon in the basket", "lemon inside basket", "basket on table"),
        task("Put the lemon in the basket and open the microwave", "lemon inside basket"),
        task("Put the lemon in the basket with the left arm", "lemon inside basket"),
        task("Put the lemon in the basket and open the microwave", "lemon inside basket", "then microwave/door open"),
        task("Put the red mug on the right plate", "mug/red on plate", start=("plate left_of plate_2",)),
        task("Put the blue block on the red block", "block/red on block/blue"),
    ],
)
def test_a_reading_is_wrong_that_asks_for_other_goals_or_leaves_open_what_the_task_says(asked: Task) -> None:
    assert not is_right(asked)


def test_names_of_a_task_become_ids_of_the_library() -> None:
    told = task("", "block/red on cabinet/drawer_top", start=("plate left_of plate_2",)).options(kinds())
    assert told["goals"][0].startswith("block_red on cabinet_three_drawers_")
    assert told["goals"][0].endswith("/drawer_top")
    first, _, second = told["starts"][0].split()
    assert second == f"{first}_2"


def test_what_the_library_lacks_stays_in_the_words_of_the_task() -> None:
    assert task("", "unicorn/pink on plate").options(kinds())["goals"][0].startswith("unicorn/pink on plate_")


def ended(text: str, **update: object) -> Ran:
    whole = {"sentence": text, "source": "libero/ours", "seed": 0, "exit_code": 0, "reason": "", "templates": ["place"]}
    fields = {"tried": [], "wrong_episode": "", "first": True, "first_verified": True, "seconds": 2.0}
    return Ran.model_validate({**whole, **fields, **update})


def test_figures_count_runs_of_feasible_tasks_and_those_that_failed_by_reason() -> None:
    told = [
        (replace(task("a"), suite="libero"), Found(read=True)),
        (replace(task("b"), suite="libero"), Found(stated=True)),
        (replace(task("c"), suite="libero"), Found(wrong="the apple is on the plate")),
    ]
    runs = [
        ended("a"),
        ended("a", first_verified=False, tried=[refused()]),
        ended("a", first=False, first_verified=False, reason="it slipped"),
        ended("b", source="libero/other", templates=[], first=None, first_verified=False, reason="nothing fits"),
    ]
    found = figures(told, runs)
    (row,) = found["rows"]
    assert (row["read"], row["wrong"], row["by_goals"], row["stated"]) == (1, 1, 1, 2)
    assert (row["feasible"], row["success"], row["verified"]) == (1, 0.6667, 0.3333)
    reasons = [failure["reason"] for failure in found["failures"]]
    assert reasons == ["done, but the critic says no: unseen", "failed: it slipped", "not feasible: nothing fits"]


def test_a_refusal_of_what_is_so_counts_against_the_critic() -> None:
    (motion,) = figures([], [ended("a", tried=[refused()])])["motions"]
    assert (motion["template"], motion["attempts"], motion["accepted"], motion["false_refused"]) == ("place", 1, 0, 1)


def refused() -> Tried:
    return Tried(
        template="place", subtask="a-in-b", step=0, attempt=0, true=True, accepted=False, stage="done", reason="unseen",
        truth="it lies there",
    )  # fmt: skip


def test_goals_run_without_their_sentence_and_have_a_folder_of_their_own() -> None:
    spoken = Whole(Sentence("Put the lemon in the basket", "ours"))
    stated = replace(spoken, goals=("lemon inside basket",))
    assert spoken.options.instruction == spoken.sentence.text and stated.options.instruction is None
    assert stated.options.goals == ("lemon inside basket",) and stated.name != spoken.name
