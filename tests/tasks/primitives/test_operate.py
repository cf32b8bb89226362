"""The robot opens and closes drawers and lids and presses buttons."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tests.articulated import (
    LID_RANGE,
    TRAVEL,
    asset_of,
    button_top,
    drawer_cabinet,
    drawer_handle,
    lid_handle,
    lidded_chest,
    push_button,
    standing,
)
from tests.example_scenes import TABLE_TOP, robot, template, thing, world_of
from vcage.base.attempts import LIMITS
from vcage.base.errors import UnknownName
from vcage.base.geometry import Pose
from vcage.objects.asset import Asset
from vcage.sim.bodies import Body
from vcage.sim.recording import StateLog
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.tasks.assemble import episode_data
from vcage.tasks.primitives.operate import OperatePlan, Operation
from vcage.tasks.retries import Failed, Retry
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.task import Task, TaskFailed

PLACE = Pose.from_yaw([-0.15, 0.09, TABLE_TOP], -0.1)


@pytest.fixture(scope="module")
def assets(tmp_path_factory) -> dict[str, Asset]:
    folder = tmp_path_factory.mktemp("articulated")
    body = drawer_handle().model_copy(update={"id": 1, "link": None})
    return {
        "cabinet": asset_of("cabinet", drawer_cabinet(folder), [drawer_handle(), body]),
        "chest": asset_of("chest", lidded_chest(folder), [lid_handle()]),
        "button": asset_of("button", push_button(folder), [button_top()]),
    }


@pytest.fixture
def task_with(assets) -> Callable[..., Task]:
    """Makes a task in a settled world with one of the objects, and others."""

    def task_with(name: str, *others: SceneObject, pose: Pose = PLACE, joints=(), failed: int = 0) -> Task:
        objects = [standing(assets[name], pose), *others]
        bodies = {o.id: Body(o.asset.model, o.pose) for o in objects}
        bodies[name] = Body(assets[name].model, pose, joints)
        world = World(template().table, bodies, robot())
        world.settle()
        nothing = Failed(0, "left", None, frozenset())
        return Task(world, {o.id: o for o in objects}, {}, Retry((nothing,) * failed))

    return task_with


def test_a_drawer_is_opened_and_the_cabinet_stays(task_with):
    task = task_with("cabinet")
    task.operate("cabinet", 0, TRAVEL)
    assert task.world.object_joints("cabinet") == pytest.approx([0.0, TRAVEL], abs=0.01)
    np.testing.assert_allclose(task.world.object_pose("cabinet").p, PLACE.p, atol=0.003)
    assert task.arm == "left"
    assert task.contact == 0
    for control in task.world.arms.values():
        np.testing.assert_allclose(control.joints, control.arm.home, atol=0.01)


def test_an_open_drawer_is_closed(task_with):
    task = task_with("cabinet", joints=(0.0, TRAVEL))
    task.operate("cabinet", 0, 0.0)
    assert task.world.object_joints("cabinet") == pytest.approx([0.0, 0.0], abs=0.01)


def test_drawer_contents_come_along(task_with):
    inside = PLACE.apply([0.0, 0.0, 0.139])
    task = task_with("cabinet", thing("rubber_eraser", tuple(inside[:2]), height=inside[2]))
    task.operate("cabinet", 0, TRAVEL)
    moved = PLACE.inverse().apply(task.world.object_pose("rubber_eraser").p)
    assert moved[1] == pytest.approx(-TRAVEL, abs=0.03)


@pytest.mark.slow
def test_a_lid_is_opened_and_closed(task_with):
    task = task_with("chest")
    task.operate("chest", 0, LID_RANGE)
    assert task.world.object_joints("chest") == pytest.approx([LID_RANGE], abs=0.1)
    task.operate("chest", 0, 0.0)
    assert task.world.object_joints("chest") == pytest.approx([0.0], abs=0.1)


@pytest.mark.slow
def test_a_laptop_stays_where_it_stands_while_its_tab_turns_between_firm_fingers():
    laptop = thing("laptop", (0.0, -0.036), -np.radians(15))
    world = world_of([laptop], load_robot("aloha_agilex"))
    world.settle()
    task, before = Task(world, {laptop.id: laptop}, {}), world.object_pose(laptop.id)
    task.operate(laptop.id, 0, 1.75)
    assert world.object_joints(laptop.id) == pytest.approx([1.75], abs=0.1)
    np.testing.assert_allclose(world.object_pose(laptop.id).p, before.p, atol=0.01)


def test_a_pressed_button_goes_down_and_comes_back(task_with):
    task = task_with("button", pose=Pose([0.1, -0.1, TABLE_TOP]))
    deepest = []
    task.world.before_step.append(lambda world: deepest.append(world.object_joints("button")[0]))
    task.operate("button", 0, 0.008)
    assert max(deepest) > 0.007
    assert task.world.object_joints("button")[0] < 0.002


def test_the_same_operation_twice_gives_the_same_states_bit_for_bit(task_with):
    snapshots = []
    for _ in range(2):
        task = task_with("button", pose=Pose([0.1, -0.1, TABLE_TOP]))
        task.operate("button", 0, 0.008)
        snapshots.append(task.world.snapshot())
    assert snapshots[0] == snapshots[1]


def test_a_later_attempt_takes_another_way(task_with):
    ends = []
    for failed in range(2):
        task = task_with("button", pose=Pose([0.1, -0.1, TABLE_TOP]), failed=failed)
        task.operate("button", 0, 0.008)
        ends.append(task.world.steps)
        assert bool(task.changes) is bool(failed)
    assert ends[0] != ends[1]


def test_an_episode_keeps_the_joints_of_the_operated_object(task_with):
    task, log = task_with("button", pose=Pose([0.1, -0.1, TABLE_TOP])), StateLog(fps=50)
    log.record(task.world)
    task.operate("button", 0, 0.008)
    data = episode_data(log, [], {}, {"instruction": "ring", "seed": 0})
    assert data.object_joints["button"].shape == (len(log), 1)
    assert data.object_joints["button"].max() > 0.007


def test_no_more_than_a_few_ways_at_which_the_hand_touches_the_handle_are_planned(task_with, monkeypatch):
    planned, plan = list[OperatePlan](), Operation._plan

    def touching(*args: object) -> OperatePlan:
        planned.append(replace(plan(*args), clear=False))  # pyrefly: ignore[bad-argument-type]
        return planned[-1]

    monkeypatch.setattr(Operation, "_plan", touching)
    task_with("cabinet").operate("cabinet", 0, TRAVEL)
    assert len(planned) == LIMITS.unclear_ways


def test_the_requested_arm_is_used(task_with):
    task = task_with("cabinet")
    task.operate("cabinet", 0, TRAVEL, arms=["right"])
    assert task.arm == "right"


def test_a_handle_out_of_reach_fails_at_the_plan_and_nothing_moves(task_with):
    task = task_with("cabinet")
    task.world.set_object_pose("cabinet", Pose([0.0, 0.9, TABLE_TOP]))
    before = task.world.steps
    with pytest.raises(TaskFailed, match="no way to operate 'handle of drawer_upper' of brown cabinet") as caught:
        task.operate("cabinet", 0, TRAVEL)
    assert caught.value.stage == "plan"
    assert task.world.steps == before


def test_a_blocked_drawer_does_not_count_as_opened(task_with):
    task = task_with("cabinet")
    articulation = task.world._object("cabinet")._articulation
    for joint in articulation.active_joints:
        joint.set_limits([[0.0, 0.03]])
    with pytest.raises(TaskFailed, match=r"came to 0\.0\d+ instead of 0\.120") as caught:
        task.operate("cabinet", 0, TRAVEL)
    assert caught.value.stage == "place"


def test_a_target_beyond_the_range_is_refused(task_with):
    with pytest.raises(TaskFailed, match=r"moves from 0\.000 to 0\.120, not to 0\.2"):
        task_with("cabinet").operate("cabinet", 0, 0.2)


def test_a_contact_point_of_the_body_operates_nothing(task_with):
    with pytest.raises(TaskFailed, match="is on no moving part"):
        task_with("cabinet").operate("cabinet", 1, 0.1)


def test_a_cabinet_is_not_picked_up_by_its_drawer(task_with):
    with pytest.raises(TaskFailed, match="is on a moving part"):
        task_with("cabinet").pick("cabinet", [(0, "left")])


def test_an_arm_that_does_not_exist_is_refused(task_with):
    with pytest.raises(UnknownName, match="arm 'middle'"):
        task_with("cabinet").operate("cabinet", 0, TRAVEL, arms=["middle"])
