"""What every recording offers, whatever its layout: cameras with pictures in RGB, and the commands to the robot."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from vcage.errors import DamagedFile, UnknownName

ARM_JOINTS = 6
"""Joints of an arm in ACT's 7- and 14-number commands; each arm's gripper follows them."""


@dataclass(frozen=True)
class Camera:
    """The pictures of one camera as they lie in the file.

    Args:
        name: short name, as in ``cam_high``.
        key: where in the file they are.
        frames: how many there are.
        width, height: of the first picture, pixels.
        storage: ``raw``, ``jpeg`` or ``png``.
        stored_bytes: what they take now.
    """

    name: str
    key: str
    frames: int
    width: int
    height: int
    storage: str
    stored_bytes: int

    @property
    def raw_bytes(self) -> int:
        """Size of the pictures as uint8 RGB."""
        return self.frames * self.width * self.height * 3


@dataclass(frozen=True)
class Motion:
    """What the robot was told.

    Args:
        action: (T, D) commands: joint positions, or poses.
        grippers: columns of ``action`` that open and close a gripper.
    """

    action: NDArray[np.float64]
    grippers: tuple[int, ...] = ()

    def require_finite(self, what: str) -> Motion:
        """Itself.

        Raises:
            DamagedFile: a command is NaN or infinite; names ``what`` and the frame.
        """
        bad = np.argwhere(~np.isfinite(self.action))
        if len(bad):
            raise DamagedFile(
                f"{what}: the action of frame {bad[0][0]} holds NaN or infinity",
                hint="leave the episode out, or mend the action",
            )
        return self


def act_grippers(numbers: int) -> tuple[int, ...]:
    """Columns of the grippers in commands of arms with six joints and a gripper each; none for other commands."""
    per_arm = ARM_JOINTS + 1
    return tuple(range(ARM_JOINTS, numbers, per_arm)) if numbers % per_arm == 0 else ()


class Recording(ABC):
    """One episode of somebody's data set; nothing is read before it is asked for.

    Attributes:
        path: the file or the folder.
        notes: what a user must know about how it was understood, such as colours that were swapped back.
    """

    LAYOUT: ClassVar[str]
    """Name of the layout, for people."""

    def __init__(self, path: Path):
        self.path = Path(path)
        self.notes: list[str] = []

    @property
    @abstractmethod
    def cameras(self) -> list[Camera]:
        """Sorted by name; at least one."""

    @property
    @abstractmethod
    def motion(self) -> Motion | None:
        """What the robot was told; None where the recording holds pictures only."""

    @property
    def fps(self) -> float | None:
        """Frames per second; None where the recording does not say."""
        return None

    @abstractmethod
    def pictures(self, camera: str, indices: Sequence[int] | None = None) -> NDArray[np.uint8]:
        """(N, H, W, 3) uint8 RGB at increasing ``indices`` (None: all), whatever way they are stored.

        Raises:
            UnknownName: there is no such camera.
            DamagedFile: a picture cannot be read, or is not as large as the first.
        """

    def camera(self, name: str) -> Camera:
        """The camera of that name.

        Raises:
            UnknownName: there is none.
        """
        for one in self.cameras:
            if one.name == name:
                return one
        raise UnknownName("camera", name, [one.name for one in self.cameras])


def stacked(pictures: Sequence[NDArray[np.uint8]], what: str) -> NDArray[np.uint8]:
    """(N, H, W, 3) of pictures that must be of one size.

    Raises:
        DamagedFile: they are not; names the first that differs.
    """
    for index, picture in enumerate(pictures):
        if picture.shape != pictures[0].shape:
            (h, w), (first_h, first_w) = picture.shape[:2], pictures[0].shape[:2]
            raise DamagedFile(
                f"{what}: picture {index} is {w}x{h}, the first {first_w}x{first_h}",
                hint="a video has one size: resize the pictures, or split the recording where the size changes",
            )
    return np.stack(pictures)
