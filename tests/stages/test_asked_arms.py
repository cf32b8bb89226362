"""An instruction that names an arm: its recordings were made with that arm."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.example_scenes import block_and_plate, scene_of
from tests.run_folders import FPS
from vcage.base.errors import InputFileError
from vcage.base.files import RunFolder, read_json, write_json
from vcage.datasets.reader import EpisodeReader
from vcage.runs.context import StageContext
from vcage.scenes.layout_items import Targets, layout_items
from vcage.schema.episodes import Episodes
from vcage.schema.goals import AskedGoal, goal_of
from vcage.schema.scene import Scene
from vcage.schema.subtasks import Subtasks
from vcage.stages import chain, search_subtasks

STAGES = ("select_place", "inpaint_plan", "match", "optimize", "search_subtasks", "collect")


@pytest.fixture(scope="module", params=["left", "right"])
def recorded(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, RunFolder]:
    """An arm, and a run in which it was asked to do all."""
    run, context = RunFolder(tmp_path_factory.mktemp(request.param) / "run"), StageContext("offline")
    instruction = f"Put the marker into the packaging box with the {request.param} arm"
    options = chain.ChainOptions(instruction=instruction, models="offline", episodes=1, fps=FPS, workers=1)
    for name in STAGES:
        chain.STAGES[name].execute(run, options, context)
    return request.param, run


@pytest.mark.slow
def test_the_gripper_that_closed_is_that_of_the_arm_and_no_other(recorded: tuple[str, RunFolder]):
    arm, run = recorded
    (accepted,) = [episode for episode in Episodes.read(run.episodes).episodes if episode.accepted]
    with EpisodeReader(run.root / str(accepted.file)) as reader:
        episode = reader.episode
    closed = {
        name.removesuffix("_gripper")
        for name, column in zip(episode.state_names, episode.action.T, strict=True)
        if name.endswith("_gripper") and column.min() < 0.9
    }
    moved = {name for name, joints in episode.robot_joints.items() if np.ptp(joints, axis=0).max() > 0.1}
    assert closed == moved == {arm}
    assert [segment.arm for segment in episode.segments] == [arm]


@pytest.mark.slow
def test_the_episode_names_the_requested_arm(recorded: tuple[str, RunFolder]):
    arm, run = recorded
    (accepted,) = [episode for episode in Episodes.read(run.episodes).episodes if episode.accepted]
    with EpisodeReader(run.root / str(accepted.file)) as reader:
        episode = reader.episode
    assert [goal["arm"] for goal in episode.meta["scene"]["goals"]] == [arm]
    assert all(segment.text.endswith(f" with the {arm} arm.") for segment in episode.segments)


@pytest.mark.slow
def test_the_sub_task_edited_to_another_arm_is_refused(recorded: tuple[str, RunFolder], tmp_path: Path):
    arm, run = recorded
    record = Subtasks.read(run.subtasks)
    (name,) = record.chains[0].subtasks
    number = [s.id for s in record.kept].index(name)
    other = "right" if arm == "left" else "left"
    before, context = run.subtasks.read_bytes(), StageContext("offline")
    for change, field in (
        ({"arm": None}, "arm"),
        ({"arm": other}, "arm"),
        ({"grasps": [{"contact": 0, "arm": other, "score": 0.0}]}, "grasps.0.arm"),
    ):
        told = read_json(run.subtasks)
        told["kept"][number] |= change
        write_json(run.subtasks, told)
        with pytest.raises(InputFileError, match=rf"kept\.{number}\.{field}"):
            search_subtasks.EDITABLE.accepted(run, run.subtasks, [], tmp_path, context)
        run.subtasks.write_bytes(before)


@pytest.mark.parametrize(("arm", "side"), [("left", -1), ("right", 1), (None, 0)])
def test_objects_may_stand_in_reach_of_the_requested_arm(arm: str | None, side: int):
    objects, context = block_and_plate(), StageContext("offline")
    goal = AskedGoal(goal=goal_of(["block", "on", "plate"]), step=1, words="put", arm=arm)
    scene = scene_of(objects).model_copy(update={"goals": [goal]})
    items = layout_items(scene, Targets({o.id: o.pose for o in objects}, {}), context)
    for item in items:
        free = np.asarray(item.allowed)
        far_left, far_right = (_holds(free, (x, 0.18)) for x in (-0.35, 0.35))
        assert (far_left, far_right) == (side <= 0, side >= 0), item.id


def test_an_object_requested_of_two_arms_may_stand_in_reach_of_both():
    objects, context = block_and_plate(), StageContext("offline")
    goals = [
        AskedGoal(goal=goal_of(["block", relation, "plate"]), step=step, words="put", arm=arm)
        for step, (relation, arm) in enumerate([("on", "left"), ("beside", "right")])
    ]
    scene = scene_of(objects).model_copy(update={"goals": goals})
    items = layout_items(scene, Targets({o.id: o.pose for o in objects}, {}), context)
    for item in items:
        free = np.asarray(item.allowed)
        assert _holds(free, (0.0, 0.1)), item.id
        assert not any(_holds(free, (x, 0.18)) for x in (-0.35, 0.35)), item.id


def _holds(rectangles: np.ndarray, at: tuple[float, float]) -> bool:
    return bool(np.any(np.all((rectangles[:, 0] <= at) & (at <= rectangles[:, 1]), axis=1)))


@pytest.mark.slow
def test_the_layout_gives_that_arm_reach(recorded: tuple[str, RunFolder]):
    arm, run = recorded
    scene, context = Scene.read(run.layout), StageContext("offline")
    for o in scene.objects:
        if o.id in {scene.goals[0].goal.subject, scene.goals[0].goal.reference}:
            role = "receptacle" if o.id == scene.goals[0].goal.reference else "content"
            reach = context.within_reach(context.asset(o), role, scene, arm=arm)
            assert reach is not None
            assert _holds(reach + [[-1e-3], [1e-3]], o.pose.position[:2]), o.id
