from __future__ import annotations

import numpy as np
import pytest

from vcage.base.errors import UsageError
from vcage.sim.recording import StateLog
from vcage.sim.replay import camera_paths, render_log
from vcage.sim.world import World


@pytest.fixture(scope="module")
def log(template, bodies, robot) -> StateLog:
    """One second in which the right arm swings."""
    world, log = World(template.table, bodies, robot), StateLog(fps=10)
    log.record(world)
    arm = world.arms["right"]
    arm.command_joints(arm.joints + 0.3 * np.eye(7)[0])
    world.step(250)
    return log


def test_frames_are_evenly_spaced_from_zero(log):
    assert len(log) == 10
    assert np.allclose(log.timestamps(), np.arange(10) / 10)


def test_command_and_measured_state_are_separate(log):
    state, command = log.arm_array("right", "state"), log.arm_array("right", "command")
    assert state.shape == command.shape == (10, 8)
    assert command[0, 0] - state[0, 0] == pytest.approx(0.3, abs=1e-6)
    assert np.all(np.diff(state[:, 0]) >= -1e-6)
    assert state[0, -1] == pytest.approx(1.0, abs=1e-3)


def test_a_frame_rate_that_does_not_divide_the_physics_rate_is_refused(world):
    with pytest.raises(UsageError, match="12 frames") as caught:
        StateLog(fps=12).record(world)
    assert "10" in caught.value.hint


def test_recording_goes_on_from_a_snapshot_as_if_nothing_had_happened(template, bodies, robot):
    world, log = World(template.table, bodies, robot), StateLog(fps=10)
    log.record(world)
    world.step(60)
    snapshot = world.snapshot()
    world.arms["left"].command_gripper(0.0)
    world.step(100)

    again = World(template.table, bodies, robot)
    again.restore(snapshot)
    log.record(again)
    assert len(log) == 3
    again.step(90)
    assert np.allclose(log.timestamps(), np.arange(6) / 10)
    assert log.frames[-1].arms["left"].command[-1] == 1.0
    assert log.frame_at(60) == 3


def test_object_poses_are_recorded(log, bodies):
    assert log.object_array("cube").shape == (10, 7)
    assert np.allclose(log.object_array("cube")[0, :3], bodies["cube"].pose.p, atol=1e-3)


def test_replay_shows_the_recorded_states(log, rendered, template):
    short = StateLog(log.fps, log.frames[::5])
    for frame, shown in zip(short.frames, render_log(rendered, short), strict=True):
        assert set(shown.pictures) == {"cam_high", "cam_left_wrist", "cam_right_wrist"}
        assert all(p.shape == (240, 320, 3) for p in shown.pictures.values())
        assert np.allclose(rendered.object_pose("cube").p, frame.objects["cube"].p, atol=1e-6)
        assert np.allclose(rendered.arms["right"].tool_pose.p, frame.arms["right"].tool.p, atol=1e-5)


def test_replay_of_the_same_log_gives_the_same_pictures(log, rendered):
    short = StateLog(log.fps, log.frames[:1])
    first, second = (next(iter(render_log(rendered, short, ["cam_high"]))) for _ in range(2))
    assert list(first.pictures) == ["cam_high"]
    assert np.array_equal(first.pictures["cam_high"], second.pictures["cam_high"])


def test_camera_paths_need_no_rendering(log, template, bodies, robot):
    paths = camera_paths(World(template.table, bodies, robot), log.states())
    assert {name: len(path) for name, path in paths.items()} == dict.fromkeys(robot.cameras, 10)
    assert not np.allclose(paths["cam_right_wrist"][0].extrinsics(), paths["cam_right_wrist"][-1].extrinsics())
