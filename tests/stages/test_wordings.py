"""How the task of an episode is said."""

from __future__ import annotations

import json

import h5py
import pytest

from tests.runs import Finished
from tests.scenes import scene_of, subtask, thing
from vcage.datasets.recordings.opening import open_hdf5
from vcage.models.rules.bystanders import asked_by
from vcage.schema.goals import AskedGoal, Goal
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtask
from vcage.stages.context import StageContext
from vcage.stages.wordings import said_of

TEXT = "Put the red block on the plate"
GOAL = Goal(subject="block", relation="on", reference="plate")


@pytest.fixture(scope="module")
def context() -> StageContext:
    return StageContext("offline")


def scene(*others: str) -> Scene:
    things = [thing("block", role="content"), thing("plate", (0.2, 0.0), role="receptacle")]
    things += [thing(name, (-0.2, 0.1 * n), id=f"{name}_{n}") for n, name in enumerate(others)]
    return scene_of(things, TEXT).model_copy(update={"goals": [AskedGoal(goal=GOAL, step=0, words=TEXT)]})


def step() -> Subtask:
    texts = [f"{verb} the red block onto the white plate." for verb in ("Place", "Set", "Move", "Bring")]
    return subtask(text="Put the red block onto the white plate.", texts=texts)


def test_the_only_one_of_its_kind_may_be_called_without_its_colour(context):
    said = said_of(TEXT, [step()], scene(), context)
    assert said[0] == TEXT
    assert "Put the block onto the plate." in said


def test_one_of_several_is_always_called_by_its_colour(context):
    there = scene("block")
    blue = there.objects[2].model_copy(update={"variant": "blue", "phrase": "blue block"})
    there = there.model_copy(update={"objects": [*there.objects[:2], blue]})
    said = said_of(TEXT, [step()], there, context)
    assert len(said) > 3
    assert all("red block" in text for text in said)


def test_beside_one_of_several_another_is_still_called_for_short(context):
    there = scene("block")
    blue = there.objects[2].model_copy(update={"variant": "blue", "phrase": "blue block"})
    there = there.model_copy(update={"objects": [*there.objects[:2], blue]})
    assert "Put the red block onto the plate." in said_of(TEXT, [step()], there, context)


def test_every_wording_of_an_episode_asks_for_the_goals_of_its_scene(finished: Finished):
    path = next(finished.run.root.glob("episodes/*.hdf5"))
    with h5py.File(path) as file:
        said = json.loads(file["meta/task_wordings"][()])
        there = Scene.parse(json.loads(file["meta/scene"][()]), path)
        told = file.attrs["task"]
    assert len(said) >= 10
    assert told in said
    things = {o.id: o.kind() for o in finished.context.objects(there)}
    for text in said:
        read = asked_by(text, things, {})
        assert read is not None
        assert {goal for _, goal in read[0]} == {asked.goal for asked in there.goals}


def test_the_wording_that_was_drawn_is_the_task_of_a_recording(finished: Finished):
    path = next(finished.run.root.glob("episodes/*.hdf5"))
    with h5py.File(path) as file:
        assert open_hdf5(path).task == file.attrs["task"]
