"""The slots that a reasoner fills: in the sub-tasks, their scripts, the critic's question and the episodes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.example_scenes import scene_of, sensible, thing, workplace
from tests.run_folders import OPTIONS, Finished, copied
from vcage.base.errors import InputFileError
from vcage.base.files import RunFolder, read_json, write_json
from vcage.episodes.question import Asking, _question
from vcage.episodes.scripts import prepare_run
from vcage.models.rules.reasoner import OfflineReasoner
from vcage.runs.context import StageContext
from vcage.scenes.slot_choices import with_chosen_slots
from vcage.schema.goals import AskedGoal, goal_of
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Preference, SlotAnswer, SlotQuestion, Subtask, Subtasks
from vcage.stages import search_subtasks
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import find_subtasks
from vcage.tasks.synthesis import load_script

Fill = Callable[[SlotQuestion], SlotAnswer]


class Filling(OfflineReasoner):
    """Fills slots as scripted, and keeps its questions."""

    def __init__(self, fill: Fill):
        self.fill, self.asked = fill, list[tuple[str | None, list[SlotQuestion]]]()

    def fill_slots(self, instruction: str | None, questions: Sequence[SlotQuestion]) -> list[SlotAnswer]:
        self.asked.append((instruction, list(questions)))
        return [self.fill(question) for question in questions]


def last_grasp(question: SlotQuestion) -> SlotAnswer:
    """The grasp that is ranked last, and that the receptacle must stay."""
    last = question.grasps[-1]
    stays = [s for s in question.statements if s.word == "unmoved"][:1]
    return SlotAnswer(subtask=question.subtask, grasp=Preference(contact=last.contact, arm=last.arm), statements=stays)


def searched(run: RunFolder, context: StageContext, fill: Fill) -> tuple[Subtasks, Filling]:
    reasoner, mine = Filling(fill), StageContext("offline")
    mine.models = replace(context.models, reasoner=reasoner)
    return search_subtasks.execute(run, OPTIONS, mine).record, reasoner


@pytest.fixture(scope="module")
def chosen(finished: Finished, tmp_path_factory: pytest.TempPathFactory) -> tuple[RunFolder, Subtasks, Filling]:
    """A run whose sub-tasks were searched with a reasoner that prefers the last grasps."""
    run = copied(finished.run, tmp_path_factory.mktemp("chosen") / "run", before="search_subtasks")
    return run, *searched(run, finished.context, last_grasp)


def of_chain(record: Subtasks) -> list[Subtask]:
    kept = {subtask.id: subtask for subtask in record.kept}
    return [kept[name] for name in record.chains[0].subtasks]


def test_the_reasoner_is_asked_once_for_the_whole_chain(chosen: tuple[RunFolder, Subtasks, Filling]):
    _, record, reasoner = chosen
    ((instruction, questions),) = reasoner.asked
    assert instruction == record.instruction
    assert [question.subtask for question in questions] == record.chains[0].subtasks


def test_the_preferred_grasp_is_first_and_the_others_are_kept(
    finished: Finished, chosen: tuple[RunFolder, Subtasks, Filling]
):
    ranked = {s.id: s for s in Subtasks.read(finished.run.subtasks).kept}
    for subtask in of_chain(chosen[1]):
        assert subtask.prefers is not None
        assert (subtask.grasps[0].contact, subtask.grasps[0].arm) == (subtask.prefers.contact, subtask.prefers.arm)
        told = {(g.contact, g.arm) for g in subtask.grasps}
        assert told == {(g.contact, g.arm) for g in ranked[subtask.id].grasps}


def test_without_an_opinion_the_ranking_stays(finished: Finished, tmp_path: Path):
    run = copied(finished.run, tmp_path / "run", before="search_subtasks")
    record, _ = searched(run, finished.context, lambda question: SlotAnswer(subtask=question.subtask))
    before = Subtasks.read(finished.run.subtasks)
    assert (record.kept, record.chains) == (before.kept, before.chains)


def test_the_script_shows_the_checks_and_carries_them(chosen: tuple[RunFolder, Subtasks, Filling], tmp_path: Path):
    run, record, _ = chosen
    subtask = of_chain(record)[0]
    (statement,) = subtask.statements
    path = run.root / subtask.script
    assert load_script(path).values["STATEMENTS"] == [(statement.subject, "unmoved", None, None)]
    alone = RunFolder(tmp_path / "alone")
    prepare_run(alone, path, seed=0, force=False)
    (again,) = Subtasks.read(alone.subtasks).kept
    assert (again.statements, again.prefers) == (subtask.statements, subtask.prefers)


def test_the_critic_is_asked_about_unchanged_facts(finished: Finished, chosen: tuple[RunFolder, Subtasks, Filling]):
    run, record, _ = chosen
    subtask, scene = of_chain(record)[0], Scene.read(run.layout)
    asking = Asking.of(subtask, {}, None)
    assert _question(finished.context, scene, asking).statements == subtask.statements
    assert asking.hash != replace(asking, statements=[]).hash


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"statements": [{"subject": "ghost", "word": "unmoved"}]}, "statements.0"),
        ({"prefers": {"contact": 0, "arm": "third"}}, "prefers"),
    ],
)
def test_an_edited_choice_of_an_unknown_object_is_refused(
    chosen: tuple[RunFolder, Subtasks, Filling], finished: Finished, tmp_path: Path, change: dict, field: str
):
    run, record, _ = chosen
    before, told = run.subtasks.read_bytes(), read_json(run.subtasks)
    number = [s.id for s in record.kept].index(record.chains[0].subtasks[0])
    told["kept"][number] |= change
    write_json(run.subtasks, told)
    try:
        with pytest.raises(InputFileError, match=rf"kept\.{number}\.{field}"):
            search_subtasks.EDITABLE.accepted(run, run.subtasks, [], tmp_path, finished.context)
    finally:
        run.subtasks.write_bytes(before)


def test_an_object_of_the_sub_task_cannot_be_said_to_stay(
    chosen: tuple[RunFolder, Subtasks, Filling], finished: Finished, tmp_path: Path
):
    run, record, _ = chosen
    before, told = run.subtasks.read_bytes(), read_json(run.subtasks)
    number = [s.id for s in record.kept].index(record.chains[0].subtasks[0])
    told["kept"][number]["statements"] = [{"subject": told["kept"][number]["object"], "word": "unmoved"}]
    write_json(run.subtasks, told)
    try:
        with pytest.raises(InputFileError, match="is moved by the sub-task"):
            search_subtasks.EDITABLE.accepted(run, run.subtasks, [], tmp_path, finished.context)
    finally:
        run.subtasks.write_bytes(before)


# --- places --------------------------------------------------------------------------------------------

TRAY = [thing("rubber_eraser", (-0.2, -0.05), 0.0, "content"), thing("toolbox_tray", (0.05, 0.05), 0.0, "receptacle")]
"""Two compartments of which the front one is planned."""


def done_with(fill: Fill, objects: Sequence[SceneObject] = TRAY) -> list[Subtask]:
    """The chain that puts things into compartments of their own, as a reasoner would have it done."""
    names = [o.id for o in objects if o.record.role == "content"]
    goals = [AskedGoal(goal=goal_of([name, "inside", "toolbox_tray"]), step=1, words="put") for name in names]
    scene = scene_of(objects, "Put it all into the toolbox tray").model_copy(update={"goals": goals})
    rng = np.random.default_rng(0)
    kept = {s.id: s for s in find_subtasks(workplace(objects, rng), sensible).kept}
    chain = [kept[f"{name}-into-toolbox_tray-{number}"] for number, name in enumerate(names)]
    (done,) = with_chosen_slots([chain], kept, scene, objects, Filling(fill), rng)
    return done


def to_the_back(question: SlotQuestion) -> SlotAnswer:
    return SlotAnswer(subtask=question.subtask, point=1)


def test_the_chain_goes_to_the_chosen_place():
    (step,) = done_with(to_the_back)
    assert (step.id, step.functional_point) == ("rubber_eraser-into-toolbox_tray-1", 1)


def test_where_the_chosen_places_conflict_objects_go_to_the_planned_ones(
    caplog: pytest.LogCaptureFixture,
):
    cars = [thing("toy_car", (x, -0.12), 0.0, "content", id=name) for name, x in (("one", -0.2), ("two", 0.2))]

    def all_to_the_back(question: SlotQuestion) -> SlotAnswer:
        return to_the_back(question).model_copy(update={"statements": question.statements[:1]})

    done = done_with(all_to_the_back, [*cars, TRAY[1]])
    assert [step.functional_point for step in done] == [0, 1]
    assert all(step.statements for step in done)
    assert "not the chosen places" in caplog.text
