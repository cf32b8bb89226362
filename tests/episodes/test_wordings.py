"""How the task of an episode is said."""

from __future__ import annotations

import json
from dataclasses import replace

import h5py
import pytest

from tests.example_scenes import scene_of, subtask, thing
from tests.run_folders import Finished
from vcage.datasets.recordings.opening import open_hdf5
from vcage.episodes.wordings import MOST_WORDINGS, task_to_word, worded_chain, wordings_for
from vcage.models.rules.reasoner import OfflineReasoner
from vcage.models.wordings import TaskToWord, TaskWordings
from vcage.runs.context import StageContext
from vcage.schema.goals import AskedGoal, Goal
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Chain, Subtasks

TEXT = "Put the red block on the plate"
GOAL = Goal(subject="block", relation="on", reference="plate")
STEP = subtask(text="Put the red block onto the white plate.", texts=["Set the red block onto the white plate."])
CHAIN = Chain(text=TEXT, subtasks=[STEP.id])


class OneWording(OfflineReasoner):
    """A reasoner with one sentence for every task, and three dropped ones."""

    def word_task(self, task: TaskToWord, plain: list[str]) -> TaskWordings:
        return TaskWordings(["Let the red block rest on the plate."], 3)


@pytest.fixture(scope="module")
def context() -> StageContext:
    return StageContext("offline")


def scene(*others: str) -> Scene:
    things = [thing("block", role="content"), thing("plate", (0.2, 0.0), role="receptacle")]
    things += [thing(name, (-0.2, 0.1 * n), id=f"{name}_{n}") for n, name in enumerate(others)]
    return scene_of(things, TEXT).model_copy(update={"goals": [AskedGoal(goal=GOAL, step=0, words=TEXT)]})


def test_the_sentences_of_a_model_come_first_and_its_dropped_ones_are_counted(context):
    chain = worded_chain(CHAIN, [STEP], scene(), context, OneWording())
    assert chain.wordings[0] == "Let the red block rest on the plate."
    assert "Put the block onto the plate." in chain.wordings
    assert chain.wordings_dropped == 3
    assert len(chain.wordings) < MOST_WORDINGS


def test_a_wording_unclear_in_an_episode_is_left_out_there(context):
    wordings = worded_chain(CHAIN, [STEP], scene(), context, OfflineReasoner()).wordings
    there = scene("block")
    blue = there.objects[2].model_copy(update={"variant": "blue", "phrase": "blue block"})
    there = there.model_copy(update={"objects": [*there.objects[:2], blue]})
    said = wordings_for(TEXT, wordings, [STEP], there, context)
    assert said[0] == TEXT
    assert len(said) > 3
    assert all("red block" in text for text in said)


def test_a_wording_with_another_look_than_the_episode_has_is_left_out(context):
    there = scene()
    blue = there.objects[0].model_copy(update={"variant": "blue", "phrase": "blue block"})
    there = there.model_copy(update={"objects": [blue, *there.objects[1:]]})
    wordings = ["Put the red block onto the plate.", "Put the block onto the plate."]
    assert wordings_for(TEXT, wordings, [STEP], there, context) == [TEXT, "Put the block onto the plate."]


def test_a_sub_task_with_its_own_task_has_its_own_words(context):
    lone = scene().model_copy(update={"instruction": None, "goals": []})
    assert wordings_for(STEP.text, [], [STEP], lone, context) == [STEP.text, *STEP.texts]


def test_every_wording_of_an_episode_holds_against_the_review_in_its_scene(finished: Finished):
    path = next(finished.run.root.glob("episodes/*.hdf5"))
    with h5py.File(path) as file:
        said = json.loads(file["meta/task_wordings"][()])
        there = Scene.parse(json.loads(file["meta/scene"][()]), path)
        told = file.attrs["task"]
    record = Subtasks.read(finished.run.subtasks)
    steps = [step for step in record.kept if step.id in record.chains[0].subtasks]
    assert len(said) >= 10
    assert told in said
    task = task_to_word(steps, there, finished.context)
    assert task.reviewed(said[1:]) == said[1:]
    assert replace(task, instruction="Everything goes on the plate").reviewed(said[1:]) == []


def test_the_wording_that_was_drawn_is_the_task_of_a_recording(finished: Finished):
    path = next(finished.run.root.glob("episodes/*.hdf5"))
    with h5py.File(path) as file:
        assert open_hdf5(path).task == file.attrs["task"]
