"""Clips as they lie on the disk, and how a picture is read back."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import cv2
import h5py
import numpy as np
from numpy.typing import NDArray

from vcage.base.videos import decode

DRAWS = 20
"""Random frames that are read to time one."""

BYTES = h5py.vlen_dtype(np.uint8)


class Stored(Protocol):
    """A clip in a file."""

    @property
    def bytes(self) -> int:
        """Bytes of its pictures."""

    def read(self, indices: Sequence[int]) -> NDArray[np.uint8]:
        """(N, H, W, 3) uint8 RGB of the frames ``indices``, increasing; the file is opened and closed."""


@dataclass(frozen=True)
class Video:
    """A video file."""

    path: Path

    @property
    def bytes(self) -> int:
        return self.path.stat().st_size

    def read(self, indices: Sequence[int]) -> NDArray[np.uint8]:
        return decode(self.path, indices)


@dataclass(frozen=True)
class Pictures:
    """Single pictures, each encoded, in an HDF5 file; ``bytes`` are the pictures' own, without what HDF5 adds."""

    path: Path
    bytes: int

    def read(self, indices: Sequence[int]) -> NDArray[np.uint8]:
        with h5py.File(self.path) as file:
            pictures = [cv2.imdecode(file["pictures"][i], cv2.IMREAD_COLOR)[..., ::-1] for i in indices]
            return np.stack(pictures).astype(np.uint8, copy=False)


def store_pictures(frames: NDArray[np.uint8], path: Path, extension: str, options: Sequence[int]) -> Pictures:
    """Encode each of (T, H, W, 3) uint8 RGB frames with OpenCV, ``.png`` or ``.jpg``, into an HDF5 file."""
    encoded = [cv2.imencode(extension, np.ascontiguousarray(frame[..., ::-1]), list(options))[1] for frame in frames]
    with h5py.File(path, "w") as file:
        dataset = file.create_dataset("pictures", len(encoded), BYTES)
        for i, data in enumerate(encoded):
            dataset[i] = data.ravel()
    return Pictures(path, sum(data.size for data in encoded))


def random_decode_ms(stored: Stored, count: int, seed: int = 0) -> float:
    """Mean CPU time to read one of ``count`` frames from the closed file, milliseconds.

    A video's table of frames is known from an earlier read, as it is to who reads frame after frame.
    """
    indices = np.random.default_rng(seed).integers(count, size=DRAWS)
    stored.read([0])
    start = time.process_time()
    for index in indices:
        stored.read([int(index)])
    return 1000 * (time.process_time() - start) / DRAWS
