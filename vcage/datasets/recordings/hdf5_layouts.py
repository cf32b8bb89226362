"""HDF5 files that hold one recording: RoboTwin's two layouts, that of ACT, and our own episodes.

RoboTwin's first layout: ``observation/<camera>/rgb`` holds JPEG as fixed-length bytes, made with OpenCV from RGB arrays
and so with red and blue swapped (https://github.com/robotwin-Platform/RoboTwin/issues/438); ``joint_action`` the
commands, which it takes for the state too. Its second: ``vision/<camera>/colors`` and the groups ``state`` and
``action``. ACT's: ``/action``, ``/observations/qpos`` and ``/observations/images/<camera>``, arrays or JPEG.

Any of them may be packed: its pictures lie in videos beside the file (:mod:`vcage.datasets.packed`).
"""

from __future__ import annotations

import json
import re
from abc import abstractmethod
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import h5py
import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import DamagedFile
from vcage.base.videos import codec_name, decode, frame_rate
from vcage.datasets.hdf5 import SCHEMA
from vcage.datasets.picture_datasets import (
    VLEN,
    picture_channels,
    picture_kind,
    picture_storage,
    stored_picture,
)
from vcage.datasets.picture_links import Link, find_links, read_link
from vcage.datasets.recordings.encoded import looks_swapped, told_of_channels
from vcage.datasets.recordings.hdf5_columns import columns, table
from vcage.datasets.recordings.recording import Camera, Columns, Recording, stacked

LOOKED_AT = 5
"""Pictures of a camera that say whether colours are swapped."""

CHUNK_CACHE = 64 << 20
"""Bytes of decompressed chunks that are kept: those of arrays often span many pictures."""

ENCODED = ("jpeg", "png")

ARM_PARTS = ("left_arm", "left_gripper", "right_arm", "right_gripper")
"""RoboTwin's datasets of a robot's joints, in the order of its ``vector``, which holds them all."""

COLOURS = "jpeg_colours"
"""Attribute of files that say whether red and blue are ``swapped`` in their encoded pictures, or ``true``."""

ATTRIBUTES = ("fps", "instruction", "robot", "state_names", COLOURS)


@contextmanager
def damage(path: Path, *, writing: bool = False) -> Iterator[None]:
    """Turn what a broken file makes h5py raise into :class:`DamagedFile`.

    Args:
        path: the file that is read.
        writing: whether another is written meanwhile; what the system refuses, which has a number, may be its fault.
    """
    try:
        yield
    except (OSError, KeyError, RuntimeError) as error:
        if writing and isinstance(error, OSError) and error.errno:
            raise
        raise DamagedFile(
            f"{path} is damaged: {error}", hint="it may be cut off: copy or record it again, or leave it out"
        ) from error


class Hdf5Recording(Recording):
    """What the layouts have in common; each says where its pictures, its commands and its state are."""

    PICTURES: ClassVar[str]
    """Pattern of the keys of its pictures; its group is the camera's name."""

    SWAPPED: ClassVar[bool | None] = False
    """Whether red and blue of encoded pictures are swapped where neither the file nor the colours say; None does not
    know either, and False does not ask them."""

    agreed: bool | None = None
    """Whether colours are swapped in the recordings that lie beside it, see :func:`agree_on_colours`."""

    @cached_property
    def cameras(self) -> list[Camera]:
        with self._file() as file:
            found = self._picture_datasets(self._part(file))
            return [self._camera(name, found[name]) for name in sorted(found)]

    @property
    def fps(self) -> float | None:
        found = self._attributes.get("fps")
        if isinstance(found, np.number) and found > 0:
            return float(found)
        videos = self.videos
        return frame_rate(next(iter(videos.values()))) if videos else None

    @property
    def files(self) -> list[Path]:
        return [self.path, *sorted(set(self.videos.values()))]

    @property
    def task(self) -> str | None:
        return self._text("instruction")

    @property
    def robot(self) -> str | None:
        return self._text("robot")

    @cached_property
    def videos(self) -> dict[str, Path]:
        """Key → the video beside the file that holds its pictures; none where the file holds them itself."""
        with self._file() as file:
            return {key: link.video(self.path) for key, link in find_links(self._part(file)).items()}

    def pictures(self, camera: str, indices: Sequence[int] | None = None) -> NDArray[np.uint8]:
        key = self.camera(camera).key
        what = f"{self.path}:{key}"
        with self._file() as file:
            link = read_link(file[key])
            if link is None:
                wanted = range(len(file[key])) if indices is None else indices
                found = stacked([stored_picture(file[key], index, what) for index in wanted], what)
        if link is not None:
            return decode(link.video(self.path), indices)
        return found[..., ::-1] if self.swapped(camera) else found

    def swapped(self, camera: str) -> bool:
        return self.camera(camera).storage in ENCODED and self._swapped

    def _part(self, file: h5py.File) -> h5py.Group:
        """Where the recording is in the open file."""
        return file

    def _picture_datasets(self, part: h5py.Group) -> dict[str, h5py.Dataset]:
        """Camera → its pictures, or the link to them."""
        found: dict[str, h5py.Dataset] = {}

        def look(key: str, item: h5py.Dataset | h5py.Group) -> None:
            match = re.fullmatch(self.PICTURES, key)
            if match and isinstance(item, h5py.Dataset):
                found[match[1]] = item

        part.visititems(look)
        return found

    def _camera(self, name: str, dataset: h5py.Dataset) -> Camera:
        key = dataset.name.lstrip("/")
        link = read_link(dataset)
        if link is not None:
            return _packed_camera(name, key, link, self.path)
        what = f"{self.path}:{dataset.name}"
        if not dataset.shape or len(dataset) == 0:
            raise DamagedFile(f"{what} holds no frame", hint="leave the episode out")
        height, width = stored_picture(dataset, 0, what).shape[:2]
        channels = picture_channels(dataset, what)
        self.notes += told_of_channels(channels, name)
        size = dataset.id.get_storage_size()
        if picture_kind(dataset) == VLEN:
            size = sum(len(dataset[index]) for index in range(len(dataset)))
        return Camera(name, key, len(dataset), width, height, picture_storage(dataset, what), size, channels)

    @contextmanager
    def _file(self) -> Iterator[h5py.File]:
        with damage(self.path), h5py.File(self.path, rdcc_nbytes=CHUNK_CACHE) as file:
            yield file

    @cached_property
    def _attributes(self) -> dict[str, Any]:
        """Those attributes of the file that are understood, if they are one number or text."""
        with self._file() as file:
            values = {name: file.attrs[name] for name in ATTRIBUTES if name in file.attrs}
        return {name: value for name, value in values.items() if np.ndim(value) == 0}

    def _text(self, name: str) -> str | None:
        found = self._attributes.get(name)
        return found if isinstance(found, str) else None

    @property
    def says_colours(self) -> bool:
        """Whether it is known without a look at them if the colours of encoded pictures are swapped."""
        encoded = any(camera.storage in ENCODED for camera in self.cameras)
        return self.SWAPPED is False or not encoded or COLOURS in self._attributes

    @cached_property
    def _swapped(self) -> bool:
        if self.SWAPPED is False:
            return False
        said = self._attributes.get(COLOURS)
        swapped = said == "swapped"
        if said is None:
            seen = self.looks_swapped() if self.agreed is None else self.agreed
            swapped = bool(self.SWAPPED) if seen is None else seen
        if swapped:
            self.notes.append("red and blue were swapped in its JPEGs and are put back")
        return swapped

    def looks_swapped(self) -> bool | None:
        """What the colours of the first camera with encoded pictures say; None where they do not."""
        camera = next(camera for camera in self.cameras if camera.storage in ENCODED)
        some = np.unique(np.linspace(0, camera.frames - 1, LOOKED_AT).astype(int))
        with self._file() as file:
            what = f"{self.path}:{camera.key}"
            return looks_swapped([stored_picture(file[camera.key], int(index), what) for index in some])

    def _read_commands(self) -> Columns | None:
        with self._file() as file:
            return self._commands(self._part(file))

    def _read_state(self) -> Columns | None:
        with self._file() as file:
            return self._measured(self._part(file))

    @abstractmethod
    def _commands(self, part: h5py.Group) -> Columns | None:
        """What the robot was told, as the recording's part of the open file says."""

    @abstractmethod
    def _measured(self, part: h5py.Group) -> Columns | None:
        """What was measured of the robot, as the recording's part of the open file says."""


class ActEpisode(Hdf5Recording):
    """A file in the layout of ACT."""

    LAYOUT = "act"
    PICTURES = r"observations/images/([^/]+)"
    SWAPPED = None

    def _commands(self, part: h5py.Group) -> Columns | None:
        return table(part, "action", self._names)

    def _measured(self, part: h5py.Group) -> Columns | None:
        return table(part, "observations/qpos", self._names)

    @property
    def _names(self) -> tuple[str, ...]:
        return ()


class VcageEpisode(ActEpisode):
    """An episode of ours."""

    LAYOUT = "vcage"
    SWAPPED = False

    @property
    def _names(self) -> tuple[str, ...]:
        return tuple(json.loads(self._attributes["state_names"]))


class RoboTwinEpisode(Hdf5Recording):
    """RoboTwin's first layout; ``joint_state`` beside ``joint_action`` is ours (:mod:`vcage.datasets.robotwin`)."""

    LAYOUT = "robotwin"
    PICTURES = r"observation/([^/]+)/rgb"
    SWAPPED = True

    def _commands(self, part: h5py.Group) -> Columns | None:
        return _joints(part.get("joint_action"))

    def _measured(self, part: h5py.Group) -> Columns | None:
        if "joint_state" in part:
            return _joints(part["joint_state"])
        found = _joints(part.get("joint_action"))
        if found is not None:
            note = "it holds no measured state; its commands are taken for it, as RoboTwin does"
            self.notes += [note] if note not in self.notes else []
        return found


class RoboTwinVisionEpisode(Hdf5Recording):
    """RoboTwin's second layout."""

    LAYOUT = "robotwin-1.0"
    PICTURES = r"vision/([^/]+)/colors"
    SWAPPED = None

    def _commands(self, part: h5py.Group) -> Columns | None:
        return columns(part.get("action", part.get("state")))

    def _measured(self, part: h5py.Group) -> Columns | None:
        return columns(part.get("state"))


LAYOUTS: tuple[type[Hdf5Recording], ...] = (RoboTwinEpisode, RoboTwinVisionEpisode, ActEpisode)


def open_hdf5(path: Path) -> Hdf5Recording:
    """The recording in an HDF5 file that holds one, by what the file holds.

    Raises:
        DamagedFile: it is no HDF5, is cut off, or holds no pictures in a layout that is known.
    """
    with damage(path), h5py.File(path) as file:
        ours = file.attrs.get("schema") == SCHEMA
        keys: list[str] = []
        file.visit(keys.append)
    layouts = (VcageEpisode,) if ours else LAYOUTS
    for layout in layouts:
        if any(re.fullmatch(layout.PICTURES, key) for key in keys):
            return layout(path)
    raise DamagedFile(
        f"{path} holds no pictures where a known layout has them (it has: {', '.join(keys[:8]) or 'nothing'})",
        hint="known are RoboTwin's observation/<camera>/rgb and vision/<camera>/colors, ACT's "
        "observations/images/<camera>, and robomimic's data/demo_<number>/obs/<camera>_image",
    )


def _packed_camera(name: str, key: str, link: Link, path: Path) -> Camera:
    """The camera of pictures that lie in a video."""
    video, stream = link.whole_video(path), link.stream
    return Camera(name, key, stream.frames, stream.width, stream.height, codec_name(video), video.stat().st_size)


def _joints(group: h5py.Group | None) -> Columns | None:
    """RoboTwin's numbers of a robot's joints."""
    return columns(group, ARM_PARTS) or columns(group, ("vector",))
