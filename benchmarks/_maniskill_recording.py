"""Time a peer's recording: ManiSkill's motion-planning runner on StackCube, with cameras like ours.

As ``mani_skill.examples.motionplanning.panda.run`` does it with ``--only-count-success``: the same solver, the same
``RecordEpisode`` with the same arguments, which keeps actions, states of the environment and pictures (gzip) in HDF5,
and by default the same shaders. Its own environment has one camera and keeps no pictures; this one has three, and
keeps a frame of every second step.

A process of its own (``python -m benchmarks._maniskill_recording COUNT FOLDER SHADERS``) that prints a line whenever a
successful trajectory is written: its number, the seconds since the start, its frames, and the CPU seconds of the
process.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

import gymnasium
import sapien
from mani_skill.envs.tasks.tabletop.stack_cube import StackCubeEnv
from mani_skill.examples.motionplanning.panda.solutions import solveStackCube
from mani_skill.sensors.camera import CameraConfig
from mani_skill.utils import sapien_utils
from mani_skill.utils.registration import register_env
from mani_skill.utils.wrappers.record import RecordEpisode

from vcage.setup.vulkan import ensure_driver

WIDTH, HEIGHT, FPS, CONTROL_HZ = 320, 240, 10, 20
"""Of the pictures, as ours are by default; and steps of ManiSkill's controller per second."""

EVERY = CONTROL_HZ // FPS
"""Steps from one frame to the next."""

TASK = "RecordedStackCube-v1"


@register_env(TASK, max_episode_steps=200)
class RecordedStackCube(StackCubeEnv):
    """StackCube seen by three cameras, one of them at the hand; they draw in every second step, from the reset on."""

    def __init__(self, *args: Any, **kwargs: Any):
        self._steps = 0
        super().__init__(*args, **kwargs)

    @property
    def _default_sensor_configs(self) -> list[CameraConfig]:
        high = sapien_utils.look_at(eye=[-0.6, 0.0, 0.9], target=[0.0, 0.0, 0.0])
        side = sapien_utils.look_at(eye=[0.3, 0.4, 0.5], target=[-0.05, 0.0, 0.1])
        hand = self.agent.robot.links_map["panda_hand"]
        wrist: Any = sapien.Pose([0.075, 0.0, 0.035], [0.70710678, 0.0, -0.70710678, 0.0])
        return [
            CameraConfig("high", high, WIDTH, HEIGHT, 0.95, 0.01, 20),
            CameraConfig("side", side, WIDTH, HEIGHT, 1.3, 0.01, 20),
            CameraConfig("wrist", wrist, WIDTH, HEIGHT, 1.3, 0.01, 20, mount=hand),
        ]

    def reset(self, *args: Any, **kwargs: Any) -> Any:
        self._steps = 0
        return super().reset(*args, **kwargs)

    @property
    def next_is_drawn(self) -> bool:
        """True if the next observation has pictures."""
        return self._steps % EVERY == 0

    def get_obs(self, *args: Any, **kwargs: Any) -> Any:
        drawn = self.next_is_drawn
        self._steps += 1
        return super().get_obs(*args, **kwargs) if drawn else {}


class EverySecond(RecordEpisode):
    """Records the steps that are drawn."""

    def __init__(self, env: Any, **options: Any):
        super().__init__(env, **options)
        self.frames = 0

    def reset(self, *args: Any, **kwargs: Any) -> Any:
        self.frames = 1
        return super().reset(*args, **kwargs)

    def step(self, action: Any) -> Any:
        task: Any = self.base_env
        if not task.next_is_drawn:
            return self.env.step(action)
        self.frames += 1
        return super().step(action)


def record(count: int, folder: Path, shaders: str) -> None:
    """Record successful trajectories.

    Args:
        count: how many.
        folder: in which ``trajectories.h5`` is written.
        shaders: the runner's ``--shader``, or ``minimal``.
    """
    start = time.perf_counter()
    ensure_driver()
    env: Any = EverySecond(
        gymnasium.make(
            TASK,
            robot_uids="panda",  # the environment's own choice has another camera at the hand
            obs_mode="rgb",
            control_mode="pd_joint_pos",
            render_mode="rgb_array",
            sensor_configs={"shader_pack": shaders},
            human_render_camera_configs={"shader_pack": shaders},
            viewer_camera_configs={"shader_pack": shaders},
            sim_backend="cpu",
        ),
        output_dir=str(folder),
        trajectory_name="trajectories",
        save_video=False,
        source_type="motionplanning",
        source_desc="official motion planning solution from ManiSkill contributors",
        video_fps=30,
        record_reward=False,
        save_on_reset=False,
    )
    done = seed = 0
    while done < count:
        outcome = solveStackCube(env, seed=seed, debug=False, vis=False)
        seed += 1
        if outcome == -1 or not outcome[-1]["success"].item():
            env.flush_trajectory(save=False)
            continue
        env.flush_trajectory()
        done += 1
        print(done, round(time.perf_counter() - start, 3), env.frames, round(time.process_time(), 3), flush=True)
    env.close()


if __name__ == "__main__":
    record(int(sys.argv[1]), Path(sys.argv[2]), sys.argv[3])
