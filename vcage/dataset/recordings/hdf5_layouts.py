"""HDF5 files: RoboTwin's two layouts, that of ACT, and our own episodes.

RoboTwin's first layout: ``observation/<camera>/rgb`` holds JPEG as fixed-length bytes, made with OpenCV from RGB arrays
and so with red and blue swapped (https://github.com/robotwin-Platform/RoboTwin/issues/438); ``joint_action`` the
commands. Its second: ``vision/<camera>/colors`` and the groups ``state`` and ``action``. ACT's: ``/action``,
``/observations/qpos`` and ``/observations/images/<camera>``, arrays or JPEG.
"""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import h5py
import numpy as np
from numpy.typing import NDArray

from vcage.dataset.hdf5 import SCHEMA
from vcage.dataset.recordings.encoded import decode_picture, looks_swapped, storage_of, to_rgb
from vcage.dataset.recordings.recording import Camera, Motion, Recording, act_grippers, stacked
from vcage.errors import DamagedFile

LOOKED_AT = 5
"""Pictures of the first camera that say whether colours are swapped."""


@contextmanager
def damage(path: Path) -> Iterator[None]:
    """Turn what a broken file makes h5py raise into :class:`DamagedFile`."""
    try:
        yield
    except (OSError, KeyError, RuntimeError) as error:
        raise DamagedFile(
            f"{path} is damaged: {error}", hint="it may be cut off: copy or record it again, or leave it out"
        ) from error


class Hdf5Recording(Recording):
    """What the layouts have in common; each says where its pictures and its commands are."""

    PICTURES: ClassVar[str]
    """Pattern of the keys of its pictures; its group is the camera's name."""

    SWAPPED: ClassVar[bool | None] = False
    """Whether red and blue of encoded pictures are swapped; None asks the colours."""

    @cached_property
    def cameras(self) -> list[Camera]:
        with damage(self.path), h5py.File(self.path) as file:
            found: dict[str, h5py.Dataset] = {}

            def look(key: str, item: h5py.Dataset | h5py.Group) -> None:
                match = re.fullmatch(self.PICTURES, key)
                if match and isinstance(item, h5py.Dataset):
                    found[match[1]] = item

            file.visititems(look)
            return [self._camera(name, found[name]) for name in sorted(found)]

    @cached_property
    def motion(self) -> Motion | None:
        with damage(self.path), h5py.File(self.path) as file:
            found = self._motion(file)
        return found and found.require_finite(str(self.path))

    def pictures(self, camera: str, indices: Sequence[int] | None = None) -> NDArray[np.uint8]:
        key = self.camera(camera).key
        with damage(self.path), h5py.File(self.path) as file:
            dataset = file[key]
            wanted = range(len(dataset)) if indices is None else indices
            pictures = [_picture(dataset, index, f"{self.path}:{key}[{index}]") for index in wanted]
        swapped = self.camera(camera).storage != "raw" and self._swapped
        return stacked([picture[..., ::-1] if swapped else picture for picture in pictures], f"{self.path}:{key}")

    @abstractmethod
    def _motion(self, file: h5py.File) -> Motion | None:
        """What the robot was told, as the open file says."""

    def _camera(self, name: str, dataset: h5py.Dataset) -> Camera:
        what = f"{self.path}:{dataset.name}"
        if len(dataset) == 0:
            raise DamagedFile(f"{what} holds no frame", hint="leave the episode out")
        first = _picture(dataset, 0, f"{what}[0]")
        storage = storage_of(_bytes(dataset, 0), f"{what}[0]") if _is_encoded(dataset) else "raw"
        size = dataset.id.get_storage_size()
        if h5py.check_vlen_dtype(dataset.dtype) is not None:
            size = sum(len(dataset[index]) for index in range(len(dataset)))
        return Camera(name, dataset.name.lstrip("/"), len(dataset), first.shape[1], first.shape[0], storage, size)

    @cached_property
    def _swapped(self) -> bool:
        if self.SWAPPED is False:
            return False
        camera = self.cameras[0]
        with damage(self.path), h5py.File(self.path) as file:
            dataset = file[camera.key]
            some = np.unique(np.linspace(0, camera.frames - 1, LOOKED_AT).astype(int))
            seen = looks_swapped([_picture(dataset, int(index), camera.key) for index in some])
        swapped = bool(self.SWAPPED) if seen is None else seen
        if swapped:
            self.notes.append("red and blue were swapped in its JPEGs and are put back")
        return swapped


class ActEpisode(Hdf5Recording):
    """A file in the layout of ACT."""

    LAYOUT = "act"
    PICTURES = r"observations/images/([^/]+)"
    SWAPPED = None

    def _motion(self, file: h5py.File) -> Motion | None:
        if "action" not in file:
            return None
        action = file["action"][()].astype(np.float64)
        return Motion(action, act_grippers(action.shape[1]))


class VcageEpisode(ActEpisode):
    """An episode of ours."""

    LAYOUT = "vcage"
    SWAPPED = False

    @cached_property
    def fps(self) -> float | None:
        with damage(self.path), h5py.File(self.path) as file:
            return float(file.attrs["fps"])


class RoboTwinEpisode(Hdf5Recording):
    """RoboTwin's first layout."""

    LAYOUT = "robotwin"
    PICTURES = r"observation/([^/]+)/rgb"
    SWAPPED = True

    def _motion(self, file: h5py.File) -> Motion | None:
        group = file.get("joint_action")
        if group is None:
            return None
        names = [name for name in ("left_arm", "left_gripper", "right_arm", "right_gripper") if name in group]
        return _columns(group, names)


class RoboTwinVisionEpisode(Hdf5Recording):
    """RoboTwin's second layout."""

    LAYOUT = "robotwin-1.0"
    PICTURES = r"vision/([^/]+)/colors"
    SWAPPED = None

    def _motion(self, file: h5py.File) -> Motion | None:
        group = file.get("action", file.get("state"))
        if group is None:
            return None
        names: list[str] = []
        group.visititems(lambda key, item: names.append(key) if isinstance(item, h5py.Dataset) else None)
        return _columns(group, sorted(names))


LAYOUTS: tuple[type[Hdf5Recording], ...] = (RoboTwinEpisode, RoboTwinVisionEpisode, ActEpisode)


def open_hdf5(path: Path) -> Hdf5Recording:
    """The recording in an HDF5 file, by what the file holds.

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
        hint="known are RoboTwin's observation/<camera>/rgb and vision/<camera>/colors, and ACT's "
        "observations/images/<camera>",
    )


def _columns(group: h5py.Group, names: Sequence[str]) -> Motion | None:
    """The numbers of several datasets side by side; those named after a gripper are one."""
    columns: list[NDArray[np.float64]] = []
    grippers: list[int] = []
    for name in names:
        values = group[name][()]
        if values.dtype.kind not in "fiu" or values.ndim not in (1, 2):
            continue
        values = values.reshape(len(values), -1).astype(np.float64)
        first = sum(part.shape[1] for part in columns)
        if "gripper" in name:
            grippers += range(first, first + values.shape[1])
        columns.append(values)
    return Motion(np.concatenate(columns, axis=1), tuple(grippers)) if columns else None


def _is_encoded(dataset: h5py.Dataset) -> bool:
    return dataset.dtype.kind in "SO" or (dataset.dtype == np.uint8 and dataset.ndim == 2)


def _bytes(dataset: h5py.Dataset, index: int) -> bytes:
    value = dataset[index]
    return value if isinstance(value, bytes) else np.asarray(value, np.uint8).tobytes()


def _picture(dataset: h5py.Dataset, index: int, what: str) -> NDArray[np.uint8]:
    """(H, W, 3) as stored: encoded pictures as a reader of picture files shows them."""
    if _is_encoded(dataset):
        return decode_picture(_bytes(dataset, index), what)
    return to_rgb(dataset[index], what)
