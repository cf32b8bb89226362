"""What every recording offers, whatever its layout: cameras with pictures in RGB, commands to the robot, its state."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import DamagedFile, UnknownName
from vcage.datasets.lerobot.episode import SubtaskSpan
from vcage.datasets.recordings.colours import Colours
from vcage.datasets.recordings.columns import Columns, Motion, act_grippers
from vcage.datasets.recordings.exporting import Exportable
from vcage.datasets.recordings.other_streams import MeasuredStream

HDF5, VIDEOS = "hdf5", "videos"
"""What recordings are packed as, besides LeRobot data sets: HDF5 files with videos beside them, or videos alone."""


@dataclass(frozen=True)
class RecordedCamera:
    """The pictures of one camera as they lie in the file.

    Args:
        name: short name, as in ``cam_high``.
        key: where in the file they are.
        frames: how many there are.
        width, height: of the first picture, pixels.
        storage: ``raw``, a kind of picture file such as ``jpeg``, or the codec of a video, such as ``hevc``.
        stored_bytes: what they take now.
        channels: of the pictures in the file: 1 grey, 3 RGB, 4 RGBA; they are read as RGB.
    """

    name: str
    key: str
    frames: int
    width: int
    height: int
    storage: str
    stored_bytes: int
    channels: int = 3

    @property
    def raw_bytes(self) -> int:
        """Size of the pictures as uint8 RGB."""
        return self.frames * self.width * self.height * 3

    @property
    def notes(self) -> list[str]:
        """What a user must know where the pictures are not RGB in the file."""
        if self.channels == 1:
            return [f"{self.name} is grey; it is read as RGB"]
        return [f"{self.name} has an alpha channel; it is laid over white"] if self.channels == 4 else []


def relative_name(path: Path, root: Path) -> str:
    """A path without suffix, relative to the file or the folder ``root``."""
    return path.stem if path == root else path.relative_to(root).with_suffix("").as_posix()


class Recording(Exportable, ABC):
    """One episode of somebody's data set; nothing is read before it is asked for.

    A recording can be pickled and read in another process.

    Attributes:
        path: the file or the folder.
        number: of the recording in its file or data set.
    """

    LAYOUT: ClassVar[str]
    """Name of the layout, for people."""

    TARGET: ClassVar[str] = VIDEOS
    """What recordings of the kind are packed as unless something else is asked for: their own kind of files."""

    _settled: Colours | None = None
    """The order of colours, once somebody settled it: a user, or all recordings that lie together."""

    def __init__(self, path: Path, number: int = 0):
        self.path = Path(path)
        self.number = number

    def __str__(self) -> str:
        """How messages name it."""
        return str(self.path)

    def name(self, root: Path) -> str:
        """Its name among the recordings found at ``root``: the path from there, without suffix."""
        return relative_name(self.path, root)

    @property
    def notes(self) -> list[str]:
        """What a user must know about how commands, cameras and times were understood, which are read for it.

        Raises:
            DamagedFile: as :attr:`motion` and :attr:`cameras`.
        """
        motion = self.motion
        return [*(() if motion is None else motion.notes), *self._camera_notes()]

    @property
    def state_notes(self) -> list[str]:
        """What a user must know about how the state was understood, which is read for it."""
        found = self._checked_state()
        return [] if found is None else list(found.notes)

    @property
    @abstractmethod
    def cameras(self) -> list[RecordedCamera]:
        """Sorted by name; none where the recording holds numbers only."""

    @property
    def frames(self) -> int:
        """How many frames it has; of the camera that has most where they differ, of the commands without a camera."""
        if not self.cameras:
            motion = self.motion
            return 0 if motion is None else len(motion.values)
        return max(camera.frames for camera in self.cameras)

    @property
    def motion(self) -> Motion | None:
        """What the robot was told; None where the recording holds pictures only. Not kept, as :attr:`state`: the
        numbers of a data set's thousands of recordings fill the memory.

        Raises:
            DamagedFile: a command is no finite number, or there are not as many as pictures; names the camera.
        """
        found = self._read_commands()
        if found is None:
            return None
        self._check("action", found.values)
        grippers = tuple(column for column, name in enumerate(found.names) if "gripper" in name)
        return Motion(found.values, found.names, found.notes, grippers=grippers or act_grippers(found.values.shape[1]))

    @property
    def state(self) -> NDArray[np.float64] | None:
        """(T, D) what was measured of the robot; None where the recording does not say.

        Raises:
            DamagedFile: as :attr:`motion`.
        """
        found = self._checked_state()
        return None if found is None else found.values

    @cached_property
    def state_names(self) -> list[str]:
        """Names of the D numbers of a state, ``joint_0``… where the recording does not say; none without a state. They
        are kept, unlike the numbers."""
        found = self._checked_state()
        return [] if found is None else found.all_names()

    @cached_property
    def action_names(self) -> list[str]:
        """Names of the numbers of a command, as :attr:`state_names`."""
        motion = self.motion
        return [] if motion is None else motion.all_names()

    @property
    def files(self) -> list[Path]:
        """The files that it is read from, sorted or in a fixed order."""
        return [self.path]

    @property
    def fps(self) -> float | None:
        """Frames per second; None where the recording does not say."""
        return None

    @property
    def task(self) -> str | None:
        """The instruction that the robot followed; None where the recording does not say."""
        return None

    @property
    def robot(self) -> str | None:
        """Name of the robot; None where the recording does not say."""
        return None

    @property
    def randomisation(self) -> str | None:
        """What was drawn for it, as JSON text; None where nobody says."""
        return None

    @property
    def subtasks(self) -> list[SubtaskSpan]:
        """Parts of the task in order; none where the recording does not say."""
        return []

    @property
    def colours(self) -> Colours | None:
        """In which order the stored pictures have red and blue; None where there is no question."""
        return self._settled

    @property
    def other_streams(self) -> Sequence[MeasuredStream]:
        """Streams that 8-bit videos cannot hold: depth, labels."""
        return ()

    @property
    def commanded(self) -> range | None:
        """The frames that have a command, and are exported; None for all."""
        return range(self.frames - self.SPARE_PICTURES) if self.SPARE_PICTURES else None

    def require_rgb(self, cameras: Collection[str]) -> None:
        """Nothing, if a video in RGB keeps what these cameras show.

        Raises:
            UnknownName: there is no such camera.
            UsageError: one shows depth or grey, and the layout says so.
        """
        for name in cameras:
            self.camera(name)

    @abstractmethod
    def pictures(self, camera: str, indices: Sequence[int] | None = None) -> NDArray[np.uint8]:
        """(N, H, W, 3) uint8 RGB at increasing ``indices`` (None: all), whatever way they are stored.

        Raises:
            UnknownName: there is no such camera.
            DamagedFile: a picture cannot be read, or is not as large as the first.
        """

    def with_colours(self, colours: Colours) -> Self:
        """The same, with another order of red and blue in its stored pictures.

        Raises:
            UsageError: a user asks for what cannot be of such a recording.
        """
        other = copy(self)
        other._settled = colours
        return other

    def swapped(self, camera: str) -> bool:
        """Whether red and blue have changed places in the camera's pictures as they are stored.

        Raises:
            UnknownName: there is no such camera.
        """
        self.camera(camera)
        return self.colours is not None and self.colours.swapped

    def put_back_swapped(self, camera: str) -> bool:
        """Check whether red and blue change places in PNG files that replace the stored pictures: where they had, and
        where only a mark said that they had not, which PNG cannot carry. So readers of the layout see the same.

        Raises:
            UnknownName: there is no such camera.
        """
        return self.swapped(camera)

    def camera(self, name: str) -> RecordedCamera:
        """The camera of that name.

        Raises:
            UnknownName: there is none.
        """
        for one in self.cameras:
            if one.name == name:
                return one
        raise UnknownName("camera", name, [one.name for one in self.cameras])

    def _camera_notes(self) -> list[str]:
        return [note for camera in self.cameras for note in camera.notes]

    @abstractmethod
    def _read_commands(self) -> Columns | None:
        """What the robot was told, unchecked."""

    def _read_state(self) -> Columns | None:
        """What was measured of the robot, unchecked."""
        return None

    def _checked_state(self) -> Columns | None:
        found = self._read_state()
        if found is not None:
            self._check("state", found.values)
        return found

    def _check(self, what: str, values: NDArray[np.float64]) -> None:
        """Raise DamagedFile where numbers are not finite or not one row for each picture."""
        bad = np.argwhere(~np.isfinite(values))
        if len(bad):
            raise DamagedFile(
                f"{self}: the {what} of frame {bad[0][0]} holds NaN or infinity",
                hint=f"leave the episode out, or mend the {what}",
            )
        for camera in self.cameras:
            if camera.frames - self.SPARE_PICTURES != len(values):
                raise DamagedFile(
                    f"{self}: {camera.name} has {camera.frames} pictures, the {what} {len(values)} rows"
                    + (f", not {self.SPARE_PICTURES} fewer" if self.SPARE_PICTURES else ""),
                    hint="frames are missing; leave the episode out",
                )
