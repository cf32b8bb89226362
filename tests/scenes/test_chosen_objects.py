"""Choosing objects and reading goals with a model that answers from a script."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.models.scripted import Scripted, chosen, description, goal, read, selected
from vcage.base.errors import AnswerNeeded, NoFeasibleTask, UnreadInstruction
from vcage.models.checked_reading import Instructed
from vcage.models.llm_reasoner import LlmReasoner
from vcage.models.registry import Choice, build_models
from vcage.objects.library import Library
from vcage.runs.context import StageContext
from vcage.scenes.chosen_objects import Chosen, choose
from vcage.sim.robots import load_template

PEN = "Put the marker away"
APPLE = "Put the apple on the plate"


@pytest.fixture(scope="module")
def library() -> Library:
    return Library.load()


def choosing(library: Library, task: str, who: Scripted) -> Chosen:
    """Choose for a task with a model that reviews its own goals."""
    context = StageContext("offline")
    context.models = replace(context.models, reasoner=LlmReasoner(who, reviewer=who))
    return choose(task, load_template("table", None), context, np.random.default_rng(0))


def pens(holder: str, *looks: str) -> dict[str, Any]:
    return selected(*(chosen(f"marker/{look}", "content") for look in looks), chosen(holder, "receptacle"))


def inside(holder: str, *looks: str) -> dict[str, Any]:
    return read(*(goal(f"marker_{look}", "inside", holder, words=PEN) for look in looks))


def test_an_object_too_large_goes_back_to_the_chooser_with_the_sizes(library: Library) -> None:
    who = Scripted(
        select_assets=[pens("cup/teal", "red"), pens("document_tray/black", "red")],
        read_goals=[inside("cup_teal", "red"), inside("document_tray_black", "red")],
    )
    found = choosing(library, PEN, who)
    assert [o.id for o in found.objects] == ["marker_red", "document_tray_black"]
    assert "red marker pen (13.0 × 1.8 cm) does not fit in teal cup (4.1 × 3.9 cm)" in who.complaints()


def test_a_choice_that_never_fits_ends_the_run_with_the_sizes(library: Library) -> None:
    who = Scripted(select_assets=[pens("cup/teal", "red")], read_goals=[inside("cup_teal", "red")])
    with pytest.raises(NoFeasibleTask, match=r"13\.0 × 1\.8 cm\) does not fit in teal cup"):
        choosing(library, PEN, who)
    assert who.names().count("select_assets") == 3
    assert who.names().count("read_goals") == 1, "the same choice is read once"


@pytest.mark.parametrize(
    ("task", "objects", "asked", "said"),
    [
        (
            "Put the green bowl on the white bowl",
            [chosen("bowl/green", "content"), chosen("bowl/white", "receptacle")],
            goal("bowl_green", "on", "bowl_white"),
            "nothing is put on the white bowl: they go in it",
        ),
        (
            "Put the tap on the tray",
            [chosen("tap/chrome", "content"), chosen("tray/wood", "receptacle")],
            goal("tap_chrome", "on", "tray_wood"),
            "no contact point to carry it by",
        ),
        (
            "Put the apple into the cabinet with two drawers",
            [chosen("apple/red", "content"), chosen("cabinet_two_drawers/white", "receptacle")],
            goal("apple_red", "inside", "cabinet_two_drawers_white"),
            "they go in its top drawer",
        ),
    ],
)
def test_a_goal_no_sub_task_achieves_is_reported_at_once(
    library: Library, task: str, objects: Sequence[dict], asked: dict, said: str
) -> None:
    who = Scripted(select_assets=[selected(*objects)], read_goals=[read({**asked, "words": task})])
    with pytest.raises(NoFeasibleTask, match=said):
        choosing(library, task, who)


def test_contents_that_do_not_fit_together_are_complained_about(library: Library) -> None:
    task = "Put the four muffins on the small plate"
    looks = [("muffin/blueberry", "muffin_blueberry"), ("muffin/chocolate", "muffin_chocolate")]
    looks += [("muffin/vanilla", "muffin_vanilla"), ("muffin/vanilla", "muffin_vanilla_2")]
    who = Scripted(
        select_assets=[selected(*(chosen(look, "content") for look, _ in looks), chosen("plate/white", "receptacle"))],
        read_goals=[read(*(goal(name, "on", "plate_white", words=task) for _, name in looks))],
    )
    with pytest.raises(NoFeasibleTask, match="do not fit into plate_white"):
        choosing(library, task, who)


def test_a_name_that_nothing_chosen_answers_to_is_complained_about_before_goals_are_read(library: Library) -> None:
    peach = selected(chosen("peach/orange", "content"), chosen("plate/white", "receptacle"))
    apple = selected(chosen("apple/red", "content"), chosen("plate/white", "receptacle"))
    who = Scripted(select_assets=[peach, apple], read_goals=[read(goal("apple_red", "on", "plate_white", words=APPLE))])
    assert choosing(library, APPLE, who).objects[0].id == "apple_red"
    assert "the task names 'apple'" in who.complaints()
    assert who.names() == ["select_assets", "select_assets", "read_goals", "review_goals"]


def test_a_reader_may_say_that_other_objects_are_needed(library: Library) -> None:
    task = "Clear my desk: everything goes into the packaging box"
    box, stapler = chosen("packaging_box/brown", "receptacle"), chosen("stapler/black", "content")
    asked = goal("stapler_black", "inside", "packaging_box_brown", words=task)
    who = Scripted(
        select_assets=[selected(stapler, box, chosen("tap/chrome", "context")), selected(stapler, box)],
        read_goals=[read(wrong_objects=["the tap is not to be moved"]), read(asked)],
    )
    assert [o.id for o in choosing(library, task, who).objects] == ["stapler_black", "packaging_box_brown"]
    assert "the tap is not to be moved" in who.complaints()


def test_context_may_hold_the_plate_that_identifies_the_target(library: Library) -> None:
    task = "Put the red mug on the left plate"
    plates = chosen("plate/white", "receptacle"), chosen("plate/blue", "context")
    answer = read(
        goal("mug_red", "on", "plate_white", words=task),
        descriptions=[description("plate_white", "left_of", "plate_blue", "the left plate")],
    )
    who = Scripted(select_assets=[selected(chosen("mug/red", "content"), *plates)], read_goals=[answer])
    found = choosing(library, task, who)
    assert found.reading is not None and [str(told) for told in found.reading.descriptions] == [
        "plate_white left_of plate_blue"
    ]


def test_an_open_question_passes_through(library: Library, tmp_path) -> None:
    class Waiting(Scripted):
        def answer(self, question):
            if question.name == "read_goals":
                raise AnswerNeeded.of(tmp_path, question.role, 1, "", [])
            return super().answer(question)

    apple = selected(chosen("apple/red", "content"), chosen("plate/white", "receptacle"))
    with pytest.raises(AnswerNeeded):
        choosing(library, APPLE, Waiting(select_assets=[apple]))


@pytest.mark.parametrize("task", ["把苹果放到盘子上", "Leg den Apfel auf den Teller"])
def test_the_rules_refuse_another_language_and_name_the_models_that_read_it(library: Library, task: str) -> None:
    models = build_models(Choice("offline"))
    context: Any = SimpleNamespace(library=library, catalogue=library.entries(), models=models)
    with pytest.raises(UnreadInstruction, match="read English only") as caught:
        choose(task, load_template("table", None), context, np.random.default_rng(0))
    assert "let a model read it" in caught.value.hint


def test_a_reading_by_the_rules_is_checked_again(library: Library) -> None:
    models = build_models(Choice("offline"))

    def misread(asked: Instructed) -> Any:
        return models.reasoner.__class__().read_goals(replace(asked, instruction=APPLE))

    reasoner = SimpleNamespace(provider="offline", select_assets=models.reasoner.select_assets, read_goals=misread)
    context: Any = SimpleNamespace(
        library=library, catalogue=library.entries(), models=SimpleNamespace(reasoner=reasoner)
    )
    with pytest.raises(UnreadInstruction, match="is not believed"):
        choose(
            "Put the apple to the left of the plate", load_template("table", None), context, np.random.default_rng(0)
        )
