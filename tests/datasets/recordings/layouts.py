"""Small files in each layout, with pictures whose colours are known."""

from __future__ import annotations

import json
import struct
import zlib
from collections.abc import Sequence
from pathlib import Path

import cv2
import h5py
import numpy as np

FRAMES, HEIGHT, WIDTH = 6, 32, 48
WOOD, BLUE = (190, 140, 90), (40, 70, 200)


def room(index: int = 0) -> np.ndarray:
    """(H, W, 3) RGB: a wooden table with a blue thing that moves."""
    picture = np.empty((HEIGHT, WIDTH, 3), np.uint8)
    picture[:] = WOOD
    picture[8:16, 4 + 4 * index : 12 + 4 * index] = BLUE
    return picture


def rooms(frames: int = FRAMES) -> np.ndarray:
    return np.stack([room(index) for index in range(frames)])


def jpeg(picture: np.ndarray, *, swapped: bool = False) -> bytes:
    """A JPEG of an RGB picture; swapped as when an RGB array is handed to OpenCV."""
    data = picture if swapped else cv2.cvtColor(picture, cv2.COLOR_RGB2BGR)
    return cv2.imencode(".jpg", data, [cv2.IMWRITE_JPEG_QUALITY, 95])[1].tobytes()


def robotwin(path: Path, *, swapped: bool = True, pictures: np.ndarray | None = None) -> Path:
    """RoboTwin's first layout, two cameras."""
    encoded = [jpeg(picture, swapped=swapped) for picture in (rooms() if pictures is None else pictures)]
    with h5py.File(path, "w") as file:
        for camera in ("head_camera", "left_camera"):
            file[f"observation/{camera}/rgb"] = np.array(encoded, dtype=f"S{max(map(len, encoded))}")
            file[f"observation/{camera}/intrinsic_cv"] = np.tile(np.eye(3), (len(encoded), 1, 1))
        for arm in ("left", "right"):
            file[f"joint_action/{arm}_arm"] = np.linspace(0, 1, len(encoded) * 6).reshape(-1, 6)
            file[f"joint_action/{arm}_gripper"] = np.linspace(1, 0, len(encoded))
    return path


def robotwin_vision(path: Path, *, swapped: bool = False, pictures: np.ndarray | None = None) -> Path:
    """RoboTwin's second layout, one camera."""
    with h5py.File(path, "w") as file:
        dataset = file.create_dataset("vision/cam_head/colors", (FRAMES,), h5py.vlen_dtype(np.uint8))
        for index, picture in enumerate(rooms() if pictures is None else pictures):
            dataset[index] = np.frombuffer(jpeg(picture, swapped=swapped), np.uint8)
        file["action/left_arm"], file["action/left_gripper"] = np.zeros((FRAMES, 6)), np.zeros(FRAMES)
        file["state/left_arm"] = np.ones((FRAMES, 6))
    return path


def act(path: Path, *, encoded: bool = False) -> Path:
    """ACT's layout, one camera, arrays or padded JPEG."""
    with h5py.File(path, "w") as file:
        file["action"], file["observations/qpos"] = np.zeros((FRAMES, 14)), np.zeros((FRAMES, 14))
        pictures: np.ndarray = rooms()
        if encoded:
            files = [jpeg(picture) for picture in pictures]
            pictures = np.zeros((FRAMES, max(map(len, files)) + 9), np.uint8)
            for row, data in zip(pictures, files, strict=True):
                row[: len(data)] = np.frombuffer(data, np.uint8)
        file["observations/images/cam_high"] = pictures
    return path


DEMOS = ("demo_0", "demo_2", "demo_10")
RATE = 20.0


def robomimic(path: Path, demos: Sequence[str] = DEMOS, *, rate: float | None = RATE) -> Path:
    """robomimic's layout, two cameras; the commands of a demonstration are its number."""
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        data.attrs["total"] = FRAMES * len(demos)
        data.attrs["env_args"] = json.dumps(
            {"env_name": "Lift", "env_kwargs": {} if rate is None else {"control_freq": rate}}
        )
        for name in demos:
            number = int(name.removeprefix("demo_"))
            demo = data.create_group(name)
            demo.attrs["num_samples"], demo.attrs["model_file"] = FRAMES, "<mujoco/>"
            demo["actions"], demo["states"] = np.full((FRAMES, 7), float(number)), np.ones((FRAMES, 32))
            pictures = np.roll(rooms(), number, axis=2)
            chunks = (1, HEIGHT, WIDTH, 3)
            demo.create_dataset("obs/agentview_image", data=pictures, chunks=chunks, compression="gzip")
            demo["obs/robot0_eye_in_hand_image"] = pictures[:, ::-1]
            demo["obs/robot0_joint_pos"] = np.full((FRAMES, 7), 0.5)
            demo["obs/robot0_gripper_qpos"] = np.full((FRAMES, 2), 0.04)
            demo["obs/robot0_eef_pos"] = np.zeros((FRAMES, 3))
        file["mask/train"] = np.array(demos[1:], "S")
    return path


def png_that_declares(width: int, height: int) -> bytes:
    """A PNG of some ten bytes whose header says that it has so many pixels."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(b"")) + chunk(b"IEND", b"")
