"""Orders that take a moment: a fixed CRF, the least effort, few scored frames, this process alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tests.datasets.recordings.layouts import FRAMES, act, robotwin, rooms
from vcage.datasets.packing.output import OutputSpec
from vcage.datasets.packing.pack import Order, Packed, pack
from vcage.datasets.packing.settings import CompressionSettings

FPS = 16.67


def settings(**changes: Any) -> CompressionSettings:
    return CompressionSettings(**{"crf": 20, "effort": "fast", "keyframes": 3, **changes})


def order(root: Path, out: Path, *, target: str | None = None, task: str | None = None, **changes: Any) -> Order:
    """An order of recordings that do not say their frame rate; ``changes`` are the order's or the settings'."""
    own = {name: changes.pop(name) for name in ("cameras", "skip_damaged", "colours") if name in changes}
    return Order(root, out, settings(**changes), OutputSpec(target, FPS, task), **own)


def packed(root: Path, out: Path, **changes: Any) -> Packed:
    return pack(order(root, out, **changes), workers=1)


def robotwin_folder(folder: Path, count: int = 2) -> Path:
    folder.mkdir()
    for number in range(count):
        robotwin(folder / f"episode{number}.hdf5")
    return folder


def act_folder(folder: Path, *names: str) -> Path:
    folder.mkdir()
    for name in names or ("a", "b"):
        act(folder / f"{name}.hdf5")
    return folder


def add_camera(path: Path, name: str) -> Path:
    """The same ACT file with another camera."""
    with h5py.File(path, "r+") as file:
        file[f"observations/images/{name}"] = np.ascontiguousarray(rooms(FRAMES)[:, ::-1])
    return path


def filled(path: Path, value: np.ndarray, key: str = "observations/images/top") -> Path:
    """A file that holds pictures and nothing else."""
    with h5py.File(path, "w") as file:
        file[key] = value
    return path
