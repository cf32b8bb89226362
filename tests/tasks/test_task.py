"""The task API that sub-task scripts call."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from tests.example_scenes import ON_PLATE, TABLE_TOP, block_and_plate, thing, world_of
from vcage.base.errors import UnknownName
from vcage.base.geometry import Pose
from vcage.schema.goals import Goal
from vcage.sim.motion import OPEN_HAND, MotionFailed, MotionPlanner
from vcage.sim.paths import JointPath, Load
from vcage.sim.world import World
from vcage.tasks.primitives.place import Surroundings
from vcage.tasks.retries import Failed, Retry
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import Slot
from vcage.tasks.task import Task, TaskFailed

GRASPS = [(0, "left"), (0, "right"), (1, "left"), (1, "right")]


def task_on(objects: Sequence[SceneObject], failed: Sequence[Failed] = ()) -> Task:
    """A task in a settled world; the block's slot is the middle of the plate."""
    world = world_of(objects)
    world.settle()
    return Task(world, {o.id: o for o in objects}, {"block": ON_PLATE}, Retry(tuple(failed)))


@pytest.fixture
def task() -> Task:
    return task_on(block_and_plate())


@pytest.fixture(scope="module")
def done() -> Task:
    """A task after a whole pick and place."""
    task = task_on(block_and_plate())
    task.pick("block", GRASPS)
    task.place("plate")
    task.home()
    return task


def test_a_picked_object_is_between_the_fingers(task: Task):
    task.pick("block", GRASPS)
    assert task.world.holds(task.arm, "block")


def test_a_picked_object_is_lifted_before_anything_else(task: Task):
    heights = []
    task.world.before_step.append(lambda world: heights.append(world.object_pose("block").p[2]))
    task.pick("block", GRASPS)
    here = task.world.object_pose("block").p
    task.home()
    assert max(heights) > TABLE_TOP + 0.08
    assert np.linalg.norm(here[:2] - task.world.object_pose("block").p[:2]) > 0.05


def test_the_first_grasp_that_can_be_planned_is_taken(task: Task):
    task.pick("block", GRASPS)
    assert (task.contact, task.arm) == GRASPS[0]


@pytest.mark.parametrize(
    ("blamed", "grasp", "same_slot"),
    [({"grasp"}, (0, "right"), True), ({"slot"}, (0, "left"), False), ({"arm"}, (0, "right"), True)],
)
def test_a_further_attempt_changes_the_part_to_blame_and_keeps_the_rest(
    blamed: set[str], grasp: tuple[int, str], same_slot: bool
):
    task = task_on(block_and_plate(), [Failed(*GRASPS[0], ON_PLATE, frozenset(blamed))])
    task.pick("block", GRASPS)
    task.place("plate")
    assert (task.contact, task.arm) == grasp
    assert (task.slot == ON_PLATE) is same_slot
    assert [("arm instead of" in change, "from the slot" in change) for change in task.changes] == (
        [(True, False)] if same_slot else [(False, True)]
    )


def test_without_another_grasp_the_slot_changes():
    task = task_on(block_and_plate(), [Failed(*GRASPS[0], ON_PLATE, frozenset({"grasp"}))])
    task.pick("block", GRASPS[:1])
    assert (task.contact, task.arm) == GRASPS[0]
    assert task.slot != ON_PLATE


def test_a_placed_object_comes_to_rest_in_its_slot(done: Task):
    slot = done.world.object_pose("plate") * ON_PLATE.pose
    np.testing.assert_allclose(done.world.object_pose("block").p, slot.p, atol=0.006)


def test_a_placed_object_stands_upright(done: Task):
    assert done.world.object_pose("block").rotation()[2, 2] > 0.999


def test_placing_leaves_the_receptacle_where_it_was(done: Task):
    np.testing.assert_allclose(done.world.object_pose("plate").p, [0.05, 0.05, TABLE_TOP], atol=0.003)


def test_all_arms_are_home_with_open_grippers_in_the_end(done: Task):
    for control in done.world.arms.values():
        np.testing.assert_allclose(control.joints, control.arm.home, atol=0.01)
        assert control.opening > 0.98


def test_an_object_that_no_arm_reaches_fails_at_the_plan_with_the_arm_and_the_contact():
    task = task_on([thing("block", (0.0, 0.3)), thing("plate", (0.05, 0.05))])
    task.world.set_object_pose("block", Pose([0.0, 0.9, TABLE_TOP]))
    with pytest.raises(TaskFailed, match="left arm at 'sides, fingers left and right'") as caught:
        task.pick("block", GRASPS[:1])
    assert caught.value.stage == "plan"


def test_nothing_moves_when_no_grasp_can_be_planned(task: Task):
    task.world.set_object_pose("block", Pose([0.0, 0.9, TABLE_TOP]))
    before = task.world.steps
    with pytest.raises(TaskFailed):
        task.pick("block", GRASPS)
    assert task.world.steps == before
    assert (task.arm, task.contact) == (None, None)


def test_no_grasps_at_all_is_a_failed_plan(task: Task):
    with pytest.raises(TaskFailed, match="nothing to try") as caught:
        task.pick("block", [])
    assert caught.value.stage == "plan"


def test_fingers_that_close_on_nothing_fail_the_grasp(task: Task):
    control = task.world.arms["left"]
    closed = control.grip

    def grip_thin_air(opening: float) -> None:
        task.world.set_object_pose("block", Pose([0.4, 0.15, TABLE_TOP]))
        closed(opening)

    control.grip = grip_thin_air
    with pytest.raises(TaskFailed, match="the fingers closed on nothing where red block should be") as caught:
        task.pick("block", GRASPS[:1])
    assert caught.value.stage == "grasp"


def test_an_object_that_slips_on_the_way_fails_the_grasp(task: Task):
    task.pick("block", GRASPS)
    task.world.set_object_pose("block", Pose([0.4, 0.15, TABLE_TOP]))
    task.world.arms[task.arm].grip(0.0)
    with pytest.raises(TaskFailed, match="block slipped out of the fingers"):
        task.place("plate")


def test_placing_before_picking_fails(task: Task):
    with pytest.raises(TaskFailed, match="nothing was picked up"):
        task.place("plate")


def test_a_receptacle_out_of_reach_fails_at_the_plan(task: Task):
    task.pick("block", GRASPS[:1])
    task.world.set_object_pose("plate", Pose([0.0, 1.2, TABLE_TOP]))
    with pytest.raises(TaskFailed, match="block cannot be brought to plate") as caught:
        task.place("plate")
    assert caught.value.stage == "plan"


def test_nothing_is_put_where_the_hand_could_not_be_drawn_back_past_an_arm_that_holds_something_up(
    task: Task, monkeypatch
):
    free = MotionPlanner.line

    def line(planner: MotionPlanner, q: np.ndarray, pose: Pose, load: Load = OPEN_HAND) -> JointPath:
        if "block" in load.ignore:
            raise MotionFailed("the hand would touch the other arm")
        return free(planner, q, pose, load)

    task.pick("block", GRASPS)
    monkeypatch.setattr(MotionPlanner, "line", line)
    monkeypatch.setattr(World, "keeping", frozenset({"right"}))
    with pytest.raises(TaskFailed, match="the hand would touch the other arm") as failed:
        task.place("plate")
    assert failed.value.stage == "plan" and task.world.holds(task.arm, "block")


@pytest.mark.parametrize(
    ("object_id", "grasp", "named"),
    [("brick", (0, "left"), "object 'brick'"), ("block", (0, "middle"), "arm 'middle'"), ("block", (9, "left"), "'9'")],
)
def test_an_unknown_name_is_refused_with_the_known_ones(task: Task, object_id: str, grasp: tuple[int, str], named: str):
    with pytest.raises(UnknownName, match=named):
        task.pick(object_id, [grasp])


def test_an_object_without_a_slot_cannot_be_placed():
    objects = block_and_plate()
    task = Task(world_of(objects), {o.id: o for o in objects}, {})
    task.pick("block", GRASPS[:1])
    with pytest.raises(UnknownName, match="slot 'block'"):
        task.place("plate")


@pytest.mark.parametrize(
    ("elsewhere", "named"), [(("block",), "block"), (("plate", 1), "functional point 1 of plate"), ((), "table")]
)
def test_a_place_against_the_slot_is_refused_with_both(task: Task, elsewhere: tuple[str | int, ...], named: str):
    task.pick("block", GRASPS)
    expected = f"block cannot be put at {named}: its slot was planned at functional point 0 of plate"
    with pytest.raises(TaskFailed, match=expected) as caught:
        task.place(*elsewhere)
    assert (caught.value.stage, caught.value.exhausted) == ("plan", True)


def test_a_receptacle_stays_an_obstacle_if_no_point_is_named(task: Task, monkeypatch):
    seen: list[tuple[str, int | None]] = []
    of = Surroundings.of
    monkeypatch.setattr(Surroundings, "of", lambda cell, name, *where: seen.append(where) or of(cell, name, *where))
    task.pick("block", GRASPS)
    task.place("plate")
    assert set(seen) == {("plate", 0)}


def test_a_question_holds_the_words_and_the_goals(task: Task):
    asked = task.ask("Put it there.", [("block", "on", "plate")])
    assert asked.text == "Put it there."
    assert asked.goals == [Goal(subject="block", relation="on", reference="plate")]


def test_a_slot_that_no_grasp_leads_to_gives_way_to_another():
    objects = block_and_plate()
    world = world_of(objects)
    world.settle()
    task = Task(world, {o.id: o for o in objects}, {"block": Slot("plate", 0, Pose([0.0, 0.9, 0.0066]))})
    task.pick("block", GRASPS)
    task.place("plate")
    task.home()
    plate, block = task.world.object_pose("plate").p, task.world.object_pose("block").p
    assert np.linalg.norm(block[:2] - plate[:2]) < 0.08
    assert [change for change in task.changes if "cm from the slot that was planned" in change]


def test_nothing_is_grasped_that_could_not_be_put_anywhere():
    objects = block_and_plate()
    world = world_of(objects)
    task = Task(world, {o.id: o for o in objects}, {"block": ON_PLATE})
    world.set_object_pose("plate", Pose([0.0, 1.2, TABLE_TOP]))
    before = world.steps
    with pytest.raises(TaskFailed, match="its place is out of reach") as caught:
        task.pick("block", GRASPS)
    assert (caught.value.stage, caught.value.exhausted) == ("plan", True)
    assert world.steps == before
