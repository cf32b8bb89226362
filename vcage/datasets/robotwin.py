"""Episodes as RoboTwin's HDF5, for the trainers that read it: its first layout, one file per episode.

Layout (T frames; https://github.com/RoboTwin-Platform/RoboTwin, ``envs/utils/pkl2hdf5.py``)::

    /observation/<camera>/rgb (T,)               JPEG, NUL-padded to one length
    /observation/<camera>/intrinsic_cv (T, 3, 3)  /extrinsic_cv (T, 3, 4)  world → camera, OpenCV axes
    /observation/<camera>/cam2world_gl (T, 4, 4)  camera → world, OpenGL axes
    /joint_action/{left_arm (T, n), left_gripper (T,), right_arm, right_gripper, vector (T, D)}   targets at
                                                  the frame itself: readers take those of the next frame for an action

RoboTwin hands RGB arrays to an encoder that expects BGR, and its readers take what OpenCV decodes for RGB: red and blue
are swapped in its JPEGs. So they are here, and the file's attribute ``jpeg_colours`` says it.

Two things are ours: ``/joint_state`` beside ``/joint_action`` is the measured state (RoboTwin has commands only), and
the attributes fps, instruction and robot. There is no ``endpose``: episodes do not record it; and no sub-tasks, for
which the layout has no place.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import cv2
import h5py
import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import UsageError
from vcage.datasets.hdf5_files import new_hdf5
from vcage.datasets.reader import EpisodeReader
from vcage.datasets.recordings.hdf5_colours import COLOURS
from vcage.datasets.recordings.robotwin import ARM_PARTS
from vcage.datasets.stored_pictures import spooled

CAMERA_NAMES = {"cam_high": "head_camera", "cam_left_wrist": "left_camera", "cam_right_wrist": "right_camera"}
"""Our name of a camera → RoboTwin's; others keep theirs."""

JPEG_QUALITY = 95
"""Of RoboTwin's own files."""

OPENGL_AXES = np.diag([1.0, -1.0, -1.0, 1.0])
"""OpenCV's camera axes (y down, z forward) in OpenGL's (y up, z backward)."""


def export_robotwin(reader: EpisodeReader, out: Path, frames: NDArray[np.int64] | None = None) -> Path:
    """Write an episode as a RoboTwin file, whole or not at all.

    Args:
        reader: the episode, open.
        out: the ``.hdf5`` file.
        frames: (K,) increasing indices of those to write; None for all.

    Raises:
        UsageError: a number of the state belongs to no arm of RoboTwin's.
        DamagedFile: the episode cannot be read.
        OutputFolderError, DiskFull: the file cannot be written.
    """
    episode = reader.episode
    frames = np.arange(episode.frames) if frames is None else frames
    parts = _arm_parts(episode.state_names)
    with new_hdf5(out) as file:
        file.attrs.update({"fps": episode.fps, "instruction": episode.instruction, "robot": str(episode.meta["robot"])})
        file.attrs[COLOURS] = "swapped"
        _write_joints(file.create_group("joint_action"), episode.targets[frames], parts)
        _write_joints(file.create_group("joint_state"), episode.qpos[frames], parts)
        for name, track in episode.cameras.items():
            group = file.create_group(f"observation/{CAMERA_NAMES.get(name, name)}")
            group["intrinsic_cv"] = np.tile(track.intrinsics, (len(frames), 1, 1))
            group["extrinsic_cv"] = track.extrinsics[frames, :3]
            group["cam2world_gl"] = np.linalg.inv(track.extrinsics[frames]) @ OPENGL_AXES
            wanted = set(frames.tolist())
            pictures = (picture for frame, picture in enumerate(reader.images(name)) if frame in wanted)
            _write_pictures(group, pictures, Path(out).parent)
    return Path(out)


def _arm_parts(state_names: list[str]) -> dict[str, list[int]]:
    """Return RoboTwin's parts of the robot, in its order → their columns in a state.

    Raises:
        UsageError: a column belongs to none.
    """
    parts: dict[str, list[int]] = {name: [] for name in ARM_PARTS}
    for column, name in enumerate(state_names):
        part = f"{name.split('_')[0]}_{'gripper' if name.endswith('_gripper') else 'arm'}"
        if part not in parts:
            raise UsageError(
                f"{name} belongs to no arm known to RoboTwin",
                hint="its arms are left and right; export to LeRobot instead",
            )
        parts[part].append(column)
    return {name: columns for name, columns in parts.items() if columns}


def _write_joints(group: h5py.Group, values: NDArray[np.float64], parts: dict[str, list[int]]) -> None:
    for name, own in parts.items():
        group[name] = values[:, own[0]] if name.endswith("gripper") else values[:, own]
    group["vector"] = values[:, [column for own in parts.values() for column in own]]


def _write_pictures(group: h5py.Group, pictures: Iterable[NDArray[np.uint8]], folder: Path) -> None:
    quality = [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY]
    # OpenCV takes BGR; given RGB it swaps red and blue, as RoboTwin does
    swapped = (cv2.imencode(".jpg", picture, quality)[1].tobytes() for picture in pictures)
    with spooled(swapped, folder) as files:
        dataset = group.create_dataset("rgb", (len(files),), f"S{files.longest}")
        for index, data in enumerate(files):
            dataset[index] = data
