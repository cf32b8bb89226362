"""HDF5 files that hold recordings: the common part of their layouts.

A layout says where its pictures, its commands and its state are. Any of them may be packed: its pictures lie in videos
beside the file (:mod:`vcage.datasets.packed`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, ClassVar, Self

import h5py
import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import DamagedFile, OversizedFile
from vcage.base.folders import natural_key, natural_path
from vcage.base.placeholders import require_fetched
from vcage.base.reading import read_json
from vcage.base.videos import codec_name, decode, frame_rate
from vcage.datasets.hdf5_contents import datasets_in, require_pictures_fit, require_utf8_text
from vcage.datasets.hdf5_files import read_hdf5
from vcage.datasets.picture_encoding import digests_beside
from vcage.datasets.picture_lengths import unknown_sizes
from vcage.datasets.picture_links import find_links, read_link
from vcage.datasets.recordings.clocks import Clocks, find_clocks
from vcage.datasets.recordings.columns import Columns, numbers_of
from vcage.datasets.recordings.hdf5_colours import COLOURS, Hdf5Colours
from vcage.datasets.recordings.passed_over import leftovers
from vcage.datasets.recordings.recording import HDF5
from vcage.datasets.recordings.streams import MeasuredStream, RecordedCamera, measured_stream, measured_streams
from vcage.datasets.recordings.success import stated_failure
from vcage.datasets.stored_pictures import (
    VLEN,
    picture_channels,
    picture_kind,
    picture_storage,
    stacked,
    stored_picture,
)

ATTRIBUTES = ("fps", "instruction", "task", "robot", "state_names", COLOURS)


class Hdf5Recording(Hdf5Colours):
    """A recording in an HDF5 file, alone or as one of many groups.

    Args:
        path: the file.
        part: name of its group, such as ``demo_0``; empty where the file holds one recording.
    """

    PICTURES: ClassVar[str]
    """Pattern of the keys of its pictures; its group is the camera's name."""

    PARTS: ClassVar[str] = ""
    """Group in which the groups of recordings lie, with a slash behind it."""

    COMMANDS: ClassVar[str] = ""
    """Key of the dataset or group of its commands."""

    LEFT_OUT: ClassVar[Mapping[str, str]] = {}
    """Pattern of the keys that an export leaves out → reason, where the layout knows better than their names say."""

    TARGET = HDF5

    def __init__(self, path: Path, part: str = ""):
        super().__init__(path, int(part.rpartition("_")[2]) if part else 0)
        self.part = part

    def __str__(self) -> str:
        return f"{self.path}:{self.part}" if self.part else str(self.path)

    def name(self, root: Path) -> str:
        return f"{super().name(root)}.{self.part}" if self.part else super().name(root)

    @classmethod
    def found_in(cls, path: Path, file: h5py.File, keys: Collection[str]) -> list[Self]:
        """Return the recordings of this layout in a file; none where it has another.

        Args:
            path: the file.
            file: the same, open.
            keys: of everything in it.
        """
        return [cls(path)] if any(re.fullmatch(cls.PICTURES, key) for key in keys) else []

    @cached_property
    def cameras(self) -> list[RecordedCamera]:
        with self._file() as file:
            found = self._picture_datasets(self._part(file))
            names = [name for name in sorted(found, key=natural_key) if measured_stream(name, found[name]) is None]
            return [self._camera(name, found[name]) for name in names]

    @cached_property
    def other_streams(self) -> list[MeasuredStream]:
        with self._file() as file:
            places = {item.name.lstrip("/") for item in self._picture_datasets(self._part(file)).values()}
            return measured_streams(self._part(file), {camera.key for camera in self.cameras}, places)

    @property
    def fps(self) -> float | None:
        if self._stated_rate is not None:
            return self._stated_rate[0]
        found = self._attributes.get("fps")
        if isinstance(found, np.number) and found > 0:
            return float(found)
        videos = self.videos
        return frame_rate(next(iter(videos.values()))) if videos else None

    @property
    def _stated_rate(self) -> tuple[float, str] | None:
        """Frames per second by the layout's own description, and the place that states it."""
        return None

    @property
    def rate_guess(self) -> float | None:
        return self._clocks.rate

    def time_fault(self, target: str, fps: float) -> str | None:
        del target
        return self._clocks.fault(fps)

    @property
    def rate_hint(self) -> str:
        return "; ".join([super().rate_hint, *self._clocks.notes(None)])

    @property
    def failed(self) -> str | None:
        with self._file() as file:
            return stated_failure(self._part(file))

    @property
    def notes(self) -> list[str]:
        notes = super().notes + self._clocks.notes(self.fps)
        if self._stated_rate is not None:
            rate, place = self._stated_rate
            notes.append(f"its frame rate is {place}, {rate:g} Hz")
        return notes

    @property
    def files(self) -> list[Path]:
        return [self.path, *sorted(set(self.videos.values()), key=natural_path), *self.companions]

    @property
    def task(self) -> str | None:
        return self._text("instruction")

    @property
    def robot(self) -> str | None:
        return self._text("robot")

    @cached_property
    def videos(self) -> dict[str, Path]:
        """Key → the video beside the file that holds its pictures; empty where the file holds them itself."""
        with self._file() as file:
            return {key: link.video(self.path) for key, link in find_links(self._part(file)).items()}

    def pictures(self, camera: str, indices: Sequence[int] | None = None) -> NDArray[np.uint8]:
        key = self.camera(camera).key
        what = f"{self.path}:{key}"
        with self._file() as file:
            dataset = file[key]
            link = read_link(dataset)
            if link is None:
                wanted = range(len(dataset)) if indices is None else indices
                found = stacked([stored_picture(dataset, index, what) for index in wanted], what)
                return found[..., ::-1] if self.swapped(camera) else found
        return decode(link.video(self.path), indices)

    def left_out(self) -> dict[str, str]:
        with self._file() as file:
            return leftovers(self._part(file), self._used_keys(), self.LEFT_OUT)

    def _used_keys(self) -> set[str]:
        """Return keys of the datasets that an export uses: pictures, commands and state, from the root of the file."""
        numbers = (self._read_commands(), self._read_state())
        used = {source for found in numbers if found is not None for source in found.sources}
        return used | {camera.key for camera in self.cameras}

    @cached_property
    def _clocks(self) -> Clocks:
        """The times of its pictures; empty without pictures."""
        cameras = {camera.key for camera in self.cameras}
        with self._file() as file:
            part = self._part(file)
            return find_clocks(part, self.frames, cameras, self.SPARE_PICTURES) if cameras else Clocks((), {})

    def _part(self, file: h5py.File) -> h5py.Group:
        """Return the group of the recording in the open file."""
        return file[f"{self.PARTS}{self.part}"] if self.part else file

    def _picture_datasets(self, part: h5py.Group) -> dict[str, h5py.Dataset]:
        """Return camera → its pictures, or the link to them."""
        return {re.sub(self.PICTURES, r"\1", key): one for key, one in datasets_in(part, self.PICTURES).items()}

    def _camera(self, name: str, dataset: h5py.Dataset) -> RecordedCamera:
        key, link = dataset.name.lstrip("/"), read_link(dataset)
        if link is not None:
            video, stream = link.whole_video(self.path), link.stream
            size = video.stat().st_size
            return RecordedCamera(name, key, stream.frames, stream.width, stream.height, codec_name(video), size)
        what = f"{self.path}:{dataset.name}"
        if not dataset.shape or len(dataset) == 0:
            raise DamagedFile(f"{what} holds no frame", hint="leave the episode out")
        require_pictures_fit(dataset)
        height, width = stored_picture(dataset, 0, what).shape[:2]
        channels = picture_channels(dataset, what)
        size = dataset.id.get_storage_size()
        if picture_kind(dataset) == VLEN:
            size = sum(len(dataset[index]) for index in range(len(dataset)))
        return RecordedCamera(name, key, len(dataset), width, height, picture_storage(dataset, what), size, channels)

    @contextmanager
    def _file(self) -> Iterator[h5py.File]:
        # decompressed chunks are cached: those of arrays often span many pictures
        with read_hdf5(self.path, rdcc_nbytes=64 << 20) as file:
            yield file

    @cached_property
    def _attributes(self) -> dict[str, Any]:
        """The understood attributes of the file, if they are one number or text."""
        with self._file() as file:
            values = {name: file.attrs[name] for name in ATTRIBUTES if name in file.attrs}
            for name, value in values.items():
                require_utf8_text(file, name, value)
        return {name: value for name, value in values.items() if np.ndim(value) == 0}

    def _text(self, name: str) -> str | None:
        found = self._attributes.get(name)
        return found if isinstance(found, str) else None

    def _camera_notes(self) -> list[str]:
        with self._file() as file:
            keys = [camera.key for camera in self.cameras if read_link(file[camera.key]) is None]
            digests = digests_beside(file, [camera.key for camera in self.cameras])
            sizes = unknown_sizes(file, keys)
        note = f"{', '.join(digests)}: made of the pictures as they are, and not true of those of the videos"
        stays = f"{', '.join(sizes)}: like sizes of the pictures, in no known form, so that decompressing changes none"
        return super()._camera_notes() + [note] * bool(digests) + [stays] * bool(sizes)

    def _read_commands(self) -> Columns | None:
        with self._file() as file:
            return self._commands(self._part(file))

    def _read_state(self) -> Columns | None:
        with self._file() as file:
            return self._measured(self._part(file))

    def _commands(self, part: h5py.Group) -> Columns | None:
        """Return the commands in the recording's part of the open file."""
        return numbers_of(part, self.COMMANDS)

    def _measured(self, part: h5py.Group) -> Columns | None:
        """Return the measured state in the recording's part of the open file."""
        raise NotImplementedError


def number_at(stated: Any, *names: str) -> float | None:
    """Return the positive finite number under nested keys of a JSON value; None where there is none."""
    for name in names:
        stated = stated.get(name) if isinstance(stated, dict) else None
    return float(stated) if isinstance(stated, int | float) and 0 < stated < math.inf else None


def read_beside(path: Path, max_bytes: int = 64 << 20) -> Any:
    """Return the content of a JSON file beside a recording; None where there is none, or a link in its place.

    Raises:
        DamagedFile: it was not fetched, is no regular file, or is not JSON.
        OversizedFile: it is too large.
        InputFileError: it may not be read.
    """
    if path.is_symlink() or not path.exists():
        return None
    require_fetched(path)
    stat = path.stat()
    if stat.st_size > max_bytes:
        raise OversizedFile(
            f"{path} has {stat.st_size:,} bytes; at most {max_bytes:,} are read", hint="leave its recordings out"
        )
    try:
        return _cached_content(path, stat.st_size, stat.st_mtime_ns)
    except DamagedFile as error:
        hint = "fix the file, or remove it and give with options what it says"
        raise DamagedFile(error.message, hint=hint, details=error.details) from error


@lru_cache(maxsize=8)
def _cached_content(path: Path, _size: int, _changed: int) -> Any:
    """Return the content of a file that describes many recordings, each of which reads it."""
    return read_json(path, nan=True)
