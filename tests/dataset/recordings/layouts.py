"""Small files in each layout, with pictures whose colours are known."""

from __future__ import annotations

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


def robotwin_vision(path: Path, *, swapped: bool = False) -> Path:
    """RoboTwin's second layout, one camera."""
    with h5py.File(path, "w") as file:
        dataset = file.create_dataset("vision/cam_head/colors", (FRAMES,), h5py.vlen_dtype(np.uint8))
        for index, picture in enumerate(rooms()):
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
