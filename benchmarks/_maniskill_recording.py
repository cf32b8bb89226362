"""What a peer's recording takes: ManiSkill's motion-planning runner on StackCube, with cameras like ours.

A process of its own (``python -m benchmarks._maniskill_recording COUNT FOLDER``) that prints a line whenever a
successful trajectory is written: its number, the seconds since the start of the process, and its frames.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

import gymnasium
import h5py
import numpy as np
import sapien
from mani_skill.envs.tasks.tabletop.stack_cube import StackCubeEnv
from mani_skill.examples.motionplanning.panda.solutions import solveStackCube
from mani_skill.sensors.camera import CameraConfig
from mani_skill.utils import sapien_utils
from mani_skill.utils.registration import register_env

from vcage.setup.vulkan import ensure_driver

WIDTH, HEIGHT, FPS, CONTROL_HZ = 320, 240, 10, 20
"""Of the pictures, as ours are by default; and steps of ManiSkill's controller per second."""

EVERY = CONTROL_HZ // FPS
"""Steps from one frame to the next."""

TASK = "RecordedStackCube-v1"


@register_env(TASK, max_episode_steps=200)
class RecordedStackCube(StackCubeEnv):
    """StackCube seen by three cameras, one of them at the hand, in every second step."""

    def __init__(self, *args: Any, **kwargs: Any):
        self.frames: list[dict[str, np.ndarray]] = []
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
        self.frames, self._steps = [], 0
        return super().reset(*args, **kwargs)

    def get_obs(self, *args: Any, **kwargs: Any) -> Any:
        self._steps += 1
        if (self._steps - 1) % EVERY:
            return {}
        seen: Any = super().get_obs(*args, **kwargs)
        pictures = {name: data["rgb"][0].cpu().numpy() for name, data in seen["sensor_data"].items()}
        self.frames.append({**pictures, "qpos": seen["agent"]["qpos"][0].cpu().numpy()})
        return seen


def record(count: int, folder: Path) -> None:
    """Record successful trajectories into one HDF5 file, pictures as they are."""
    start = time.perf_counter()
    ensure_driver()
    env: Any = gymnasium.make(TASK, robot_uids="panda", obs_mode="rgb", control_mode="pd_joint_pos", sim_backend="cpu")
    task, done, seed = env.unwrapped, 0, 0
    assert isinstance(task, RecordedStackCube)
    with h5py.File(folder / "trajectories.h5", "w") as file:
        while done < count:
            outcome = solveStackCube(env, seed=seed, debug=False, vis=False)
            seed += 1
            if outcome == -1 or not outcome[-1]["success"].item():
                continue
            group = file.create_group(f"traj_{done}")
            for name in task.frames[0]:
                group[name] = np.stack([frame[name] for frame in task.frames])
            file.flush()
            done += 1
            print(done, round(time.perf_counter() - start, 3), len(task.frames), flush=True)
    env.close()


if __name__ == "__main__":
    record(int(sys.argv[1]), Path(sys.argv[2]))
