"""Wiping: a pad is drawn to and fro over a flat top, and the tool goes back."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import TABLE_TOP, thing, workplace, world_of
from vcage.base.geometry import Pose
from vcage.schema.goals import Goal
from vcage.tasks.state import Watch
from vcage.tasks.task import Task
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.truth import goals_hold
from vcage.tasks.wiping import flat_top
from vcage.tasks.workcell import TaskFailed

BOARD, SPONGE, APPLE = thing("cutting_board", (0.05, 0.05), 0.3), thing("sponge", (-0.25, -0.02), 0.6), thing("apple")
ON_BOARD = APPLE.moved(Pose(BOARD.pose.p + [0.0, 0.0, 0.025], APPLE.pose.q))
GOAL = Goal(subject=BOARD.id, relation="wiped")
WIPE = TEMPLATES["wipe"]


def examined(*objects, asked=(GOAL,)):
    (proposal,), _ = WIPE.proposals(objects, asked)
    return proposal.examine(workplace([*objects]))


def grasps(subtask) -> list[tuple[int, str]]:
    return [(grasp.contact, grasp.arm) for grasp in subtask.grasps]


def test_a_board_in_reach_of_a_sponge_in_reach_is_wiped() -> None:
    subtask, _ = examined(BOARD, SPONGE)
    assert subtask is not None and subtask.goals == [GOAL]
    assert (subtask.object, subtask.tool, subtask.grasped, subtask.receptacle) == (BOARD.id, SPONGE.id, SPONGE.id, None)
    assert len({subtask.text, *subtask.texts}) >= 10


def test_nothing_is_wiped_unless_it_is_asked_for_and_nothing_by_itself() -> None:
    assert not WIPE.proposals([BOARD, SPONGE], ())[0]
    assert not WIPE.proposals([BOARD, SPONGE], [Goal(subject=SPONGE.id, relation="wiped")])[0]


@pytest.mark.parametrize(
    ("name", "why"), [("mug", "white mug has no flat top to wipe"), ("block", "red block (4.0 × 4.0 cm)")]
)
def test_what_has_no_flat_top_for_the_pad_is_refused_by_name(name: str, why: str) -> None:
    (proposal,), _ = WIPE.proposals([thing(name), SPONGE], [Goal(subject=name, relation="wiped")])
    refusal = proposal.impossible()
    assert refusal is not None and why in refusal.reason


def test_what_lies_on_it_is_named_unless_it_is_asked_to_be_moved() -> None:
    subtask, refused = examined(BOARD, SPONGE, ON_BOARD)
    assert subtask is None and "red apple lies on" in refused[0].reason
    away = Goal(subject=APPLE.id, relation="moved_away")
    assert examined(BOARD, SPONGE, ON_BOARD, asked=(GOAL, away))[0] is not None


def test_a_board_out_of_reach_is_refused_with_a_reason_for_each_contact_point() -> None:
    subtask, refused = examined(thing("cutting_board", (0.0, 1.0)), SPONGE)
    assert subtask is None and len(refused) == len(SPONGE.asset.annotation.carrying_points)
    assert all("does not reach" in refusal.reason for refusal in refused)


def test_a_block_at_the_corner_of_a_turned_tray_is_beside_it_also_a_little_higher() -> None:
    tray, block = thing("tray", (0.05, 0.05), np.pi / 4), thing("block", (0.16, -0.06), height=TABLE_TOP + 1e-4)
    subtask, refused = examined(tray, SPONGE, block, asked=(Goal(subject=tray.id, relation="wiped"),))
    assert subtask is not None, refused


@pytest.mark.parametrize(("at", "offered"), [((0.25, 0.35), False), ((-0.5, 0.3), True)])
def test_a_grasp_with_which_no_arm_reaches_all_of_a_mat_is_refused(at: tuple[float, float], offered: bool) -> None:
    mat = thing("customer_mat", at)
    subtask, refused = examined(mat, SPONGE, asked=(Goal(subject=mat.id, relation="wiped"),))
    assert (subtask is not None) is offered and all("does not reach" in refusal.reason for refusal in refused)


@pytest.mark.parametrize(
    "name", ["cutting_board", *(pytest.param(name, marks=pytest.mark.slow) for name in ("plate", "customer_mat"))]
)
def test_the_robot_wipes_a_flat_thing_and_puts_the_sponge_back(name: str) -> None:
    flat = thing(name, (0.05, 0.05), 0.3)
    top, goal = flat_top(flat), Goal(subject=name, relation="wiped")
    subtask, _ = examined(flat, SPONGE, asked=(goal,))
    objects = {o.id: o for o in (flat, SPONGE)}
    world = world_of([flat, SPONGE])
    world.settle()
    task, watch = Task(world, objects, {}), Watch(world, objects, [goal])
    task.wipe(SPONGE.id, flat.id, grasps(subtask))
    task.home()
    assert goals_hold([goal], watch).success
    assert task.moment is not None and task.later is not None and top is not None
    first, later = (state.objects[SPONGE.id].p for state in (task.moment, task.later))
    assert np.linalg.norm(later - first) > 0.05 and abs(first[2] - flat.pose.p[2] - top.floor) < 0.003
    assert np.linalg.norm(world.object_pose(SPONGE.id).p - SPONGE.pose.p) < 0.02


def test_a_board_on_which_something_lies_is_not_wiped() -> None:
    subtask, _ = examined(BOARD, SPONGE)
    objects = {o.id: o for o in (BOARD, SPONGE, ON_BOARD)}
    world = world_of([BOARD, SPONGE, ON_BOARD])
    with pytest.raises(TaskFailed, match=r"red apple lies on the .* cutting board, which is wiped when it is empty"):
        Task(world, objects, {}).wipe(SPONGE.id, BOARD.id, grasps(subtask))


def test_a_tool_that_does_not_touch_wipes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    subtask, _ = examined(BOARD, SPONGE)
    objects = {o.id: o for o in (BOARD, SPONGE)}
    world = world_of([BOARD, SPONGE])
    world.settle()
    task, watch = Task(world, objects, {}), Watch(world, objects, [GOAL])
    monkeypatch.setattr("vcage.tasks.use.carry_out_down", lambda *_, **__: world.state())
    monkeypatch.setattr("vcage.tasks.primitives.wipe._gap", lambda *_: 0.0)
    with pytest.raises(TaskFailed, match="the yellow sponge lifted off the light brown cutting board"):
        task.wipe(SPONGE.id, BOARD.id, grasps(subtask))
    assert not goals_hold([GOAL], watch).success
