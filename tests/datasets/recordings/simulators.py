"""Small files with the keys that LIBERO, Isaac Lab, ManiSkill and RoboTwin write."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tests.datasets.recordings.layouts import FRAMES, HEIGHT, WIDTH, jpeg, rooms

STEPS = np.arange(FRAMES, dtype=float)[:, None]


def ramp(columns: int, start: float = 0.0) -> np.ndarray:
    """(T, columns) numbers of which all differ."""
    return start + STEPS + np.arange(columns) / 100


def libero(path: Path, language: Any = "put the bowl on the plate", *, convention: str | None = None) -> Path:
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        data.attrs["env_args"] = json.dumps({"type": 1, "env_name": "Libero", "env_kwargs": {"control_freq": 20}})
        data.attrs["problem_info"] = json.dumps({"problem_name": "tabletop", "language_instruction": language})
        data.attrs["tag"], data.attrs["num_demos"] = "libero-v1", 1
        if convention is not None:
            data.attrs["macros_image_convention"] = convention
        demo = data.create_group("demo_0")
        demo["actions"], demo["states"], demo["robot_states"] = ramp(7), np.ones((FRAMES, 20)), np.ones((FRAMES, 9))
        demo["rewards"], demo["dones"] = np.zeros(FRAMES, np.uint8), np.zeros(FRAMES, np.uint8)
        for camera in ("agentview_rgb", "eye_in_hand_rgb"):
            demo[f"obs/{camera}"] = rooms()
        demo["obs/agentview_depth"] = np.zeros((FRAMES, HEIGHT, WIDTH, 1), np.float32)
        for name, columns, start in (("joint_states", 7, 10), ("gripper_states", 2, 20), ("ee_states", 6, 30)):
            demo[f"obs/{name}"] = ramp(columns, start)
        demo["obs/ee_pos"], demo["obs/ee_ori"] = ramp(6, 30)[:, :3], ramp(6, 30)[:, 3:]
    return path


def isaac_lab(path: Path, success: Sequence[bool | None] = (True,), *, args: dict[str, Any] | None = None) -> Path:
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        data.attrs["total"] = FRAMES * len(success)
        data.attrs["env_args"] = json.dumps(
            {"env_name": "Isaac-Stack-Cube-Franka-IK-Rel-v0", "type": 2, **(args or {})}
        )
        for number, stated in enumerate(success):
            demo = data.create_group(f"demo_{number}")
            demo.attrs["num_samples"] = FRAMES
            if stated is not None:
                demo.attrs["success"] = stated
            demo["actions"], demo["obs/actions"] = ramp(7, number), ramp(7, number)
            demo["initial_state/articulation/robot/joint_position"] = np.zeros((1, 9))
            demo["states/rigid_object/cube_1/root_pose"] = np.zeros((FRAMES, 7))
            for name, columns, start in (("joint_pos", 9, 10), ("joint_vel", 9, 0), ("gripper_pos", 2, 20)):
                demo[f"obs/{name}"] = ramp(columns, start)
            demo["obs/eef_pos"], demo["obs/eef_quat"], demo["obs/object"] = ramp(3), ramp(4), ramp(39)
            demo["obs/table_cam"] = rooms()
            demo["obs/table_cam_segmentation"] = rooms()
            demo["obs/datagen_info/eef_pose/franka"] = np.tile(np.eye(4), (FRAMES, 1, 1))
    return path


def maniskill(
    path: Path,
    success: Sequence[bool | None] = (True,),
    *,
    kwargs: dict[str, Any] | None = None,
    labels: bool = True,
    pictures: bool = True,
) -> Path:
    """Trajectories of FRAMES actions; ``success`` is what the description says, and the labels with ``labels``."""
    episodes = []
    with h5py.File(path, "w") as file:
        for number, stated in enumerate(success):
            part = file.create_group(f"traj_{number}")
            part["actions"] = ramp(8, number).astype(np.float32)
            part["obs/agent/qpos"] = np.concatenate([ramp(9, 10), ramp(9, 99)[:1]])
            part["obs/agent/qvel"] = np.zeros((FRAMES + 1, 9))
            part["obs/extra/goal_pos"] = np.zeros((FRAMES + 1, 3))
            camera = "obs/sensor_data/base_camera"
            if pictures:
                part[f"{camera}/rgb"] = rooms(FRAMES + 1)
                part[f"{camera}/depth"] = np.zeros((FRAMES + 1, HEIGHT, WIDTH, 1), np.int16)
            part["obs/sensor_param/base_camera/intrinsic_cv"] = np.tile(np.eye(3), (FRAMES + 1, 1, 1))
            part["env_states/actors/cube"] = np.zeros((FRAMES + 1, 13))
            done = np.zeros(FRAMES, bool)
            done[-1] = labels and stated is not False
            part["success"], part["fail"], part["rewards"] = done, np.zeros(FRAMES, bool), np.zeros(FRAMES)
            told = {} if stated is None else {"success": stated}
            episodes.append({"episode_id": number, "elapsed_steps": FRAMES, **told})
    described = {"env_info": {"env_id": "PickCube-v1", "env_kwargs": kwargs or {}}, "episodes": episodes}
    path.with_suffix(".json").write_text(json.dumps(described))
    return path


def robotwin_tree(root: Path, episodes: int = 2) -> Path:
    """A task's folder: ``data/episode<N>.hdf5`` and ``instructions/episode<N>.json``."""
    for folder in ("data", "instructions"):
        (root / folder).mkdir(parents=True)
    for number in range(episodes):
        with h5py.File(root / f"data/episode{number}.hdf5", "w") as file:
            encoded = [jpeg(picture, swapped=True) for picture in rooms()]
            file["observation/head_camera/rgb"] = np.array(encoded, dtype=f"S{max(map(len, encoded))}")
            file["observation/head_camera/depth"] = np.zeros((FRAMES, HEIGHT, WIDTH))
            file["observation/head_camera/intrinsic_cv"] = np.tile(np.eye(3), (FRAMES, 1, 1))
            for arm in ("left", "right"):
                file[f"joint_action/{arm}_arm"] = ramp(6, number)
                file[f"joint_action/{arm}_gripper"] = STEPS[:, 0]
            file["joint_action/vector"] = ramp(14, number)
            file.create_group("endpose")
            file["pointcloud"] = np.zeros((FRAMES, 0), np.float32)
        told = {"seen": [f"Beat block {number}", f"Hit cube {number}"], "unseen": [f"Strike {number}"]}
        (root / f"instructions/episode{number}.json").write_text(json.dumps(told))
    (root / "scene_info.json").write_text("{}")
    return root


def robotwin_v1(path: Path, instructions: Any = '["Beat the block", "Hit the cube"]') -> Path:
    with h5py.File(path, "w") as file:
        file["data_format_version"], file["instructions"] = "v1.0", instructions
        file["additional_info/frequency"] = np.int32(15)
        for kind, start in (("state", 0), ("action", 1)):
            for arm in ("left", "right"):
                file[f"{kind}/{arm}_arm_joint_states"] = ramp(6, start)
                file[f"{kind}/{arm}_ee_joint_states"] = ramp(1, start)
                file[f"{kind}/{arm}_ee_poses"] = ramp(7, start)
        encoded = [jpeg(picture, swapped=True) for picture in rooms()]
        file["vision/cam_head/colors"] = np.array(encoded, dtype=f"S{max(map(len, encoded))}")
        file["vision/cam_head/depths"] = np.zeros((FRAMES, HEIGHT, WIDTH))
    return path
