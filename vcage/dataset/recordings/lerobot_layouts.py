"""The episodes of a LeRobot data set, v2.1 and v3.0: https://huggingface.co/docs/lerobot/lerobot-dataset-v3."""

from __future__ import annotations

import json
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import av
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from numpy.typing import NDArray

from vcage.dataset.recordings.encoded import decode_picture, storage_of
from vcage.dataset.recordings.recording import Camera, Motion, Recording, act_grippers, stacked
from vcage.errors import DamagedFile
from vcage.videos import decode

INFO = Path("meta/info.json")
PREFIX = "observation.images."
"""What LeRobot puts before the name of a camera."""

MEND = "the data set is damaged or not complete: fetch or export it again"


@dataclass(frozen=True)
class _Clip:
    """Where an episode's pictures of one camera are: from ``start`` on in a video that holds others too."""

    file: Path
    start: int


class LeRobotRecording(Recording):
    """One episode of a data set.

    Args:
        root: folder of the data set; it is the recording's path.
        info: its ``meta/info.json``.
        row: what the data set says of the episode.
    """

    def __init__(self, root: Path, info: Mapping[str, Any], row: Mapping[str, Any]):
        super().__init__(root)
        self._info, self._row = info, row
        self.index = int(row["episode_index"])

    @property
    def fps(self) -> float | None:
        return float(self._info["fps"])

    @cached_property
    def cameras(self) -> list[Camera]:
        keys = [key for key, feature in self._info["features"].items() if feature["dtype"] in ("video", "image")]
        return sorted((self._camera(key) for key in keys), key=lambda camera: camera.name)

    @cached_property
    def motion(self) -> Motion | None:
        if "action" not in self._frames.column_names:
            return None
        action = np.array(self._frames["action"].to_pylist(), np.float64)
        names = self._info["features"]["action"].get("names") or []
        names = names if isinstance(names, list) else [name for group in names.values() for name in group]
        named = tuple(column for column, name in enumerate(names) if "gripper" in str(name))
        return Motion(action, named or act_grippers(action.shape[1])).require_finite(self._what)

    def pictures(self, camera: str, indices: Sequence[int] | None = None) -> NDArray[np.uint8]:
        one = self.camera(camera)
        wanted = list(range(one.frames) if indices is None else indices)
        if self._info["features"][one.key]["dtype"] == "video":
            clip = self._clip(one.key)
            return decode(clip.file, [clip.start + index for index in wanted])
        stored = self._frames[one.key]
        return stacked(
            [
                decode_picture(self._stored(stored[index].as_py()), f"{self._what} {one.key}[{index}]")
                for index in wanted
            ],
            f"{self._what} {one.key}",
        )

    @property
    def _what(self) -> str:
        return f"{self.path} episode {self.index}"

    @cached_property
    def _frames(self) -> pa.Table:
        table = _table(self._data_file)
        return table.filter(pc.equal(table["episode_index"], self.index))

    def _camera(self, key: str) -> Camera:
        feature, frames = self._info["features"][key], int(self._row["length"])
        height, width = feature["shape"][:2] if feature["names"][0] != "channels" else feature["shape"][1:]
        if feature["dtype"] == "image":
            data = [self._stored(value) for value in self._frames[key].to_pylist()]
            storage, size = storage_of(data[0], f"{self._what} {key}[0]"), sum(map(len, data))
        else:
            facts = {**feature.get("video_info", {}), **feature.get("info", {})}
            storage, size = str(facts.get("video.codec", "video")), self._video_bytes(key)
        return Camera(key.removeprefix(PREFIX), key, frames, width, height, storage, size)

    def _stored(self, value: Mapping[str, Any]) -> bytes:
        data = value.get("bytes")
        return data if data is not None else (self.path / str(value["path"])).read_bytes()

    @property
    @abstractmethod
    def _data_file(self) -> Path:
        """The table that holds the episode's frames."""

    @abstractmethod
    def _clip(self, key: str) -> _Clip:
        """Where the pictures of a camera are."""

    @abstractmethod
    def _video_bytes(self, key: str) -> int:
        """What the pictures of a camera take; a share of a video that holds other episodes too."""


class LeRobotV21(LeRobotRecording):
    """A file per episode and camera."""

    LAYOUT: ClassVar[str] = "lerobot-v2.1"

    @property
    def _data_file(self) -> Path:
        return self._file("data_path")

    def _clip(self, key: str) -> _Clip:
        return _Clip(self._file("video_path", video_key=key), 0)

    def _video_bytes(self, key: str) -> int:
        return _size(self._clip(key).file)

    def _file(self, pattern: str, **names: str) -> Path:
        chunk = self.index // int(self._info["chunks_size"])
        return self.path / str(self._info[pattern]).format(episode_chunk=chunk, episode_index=self.index, **names)


class LeRobotV30(LeRobotRecording):
    """Many episodes in a file."""

    LAYOUT: ClassVar[str] = "lerobot-v3.0"

    @property
    def _data_file(self) -> Path:
        return self._file("data_path", "data")

    def _clip(self, key: str) -> _Clip:
        start = round(float(self._row[f"videos/{key}/from_timestamp"]) * float(self._info["fps"]))
        return _Clip(self._file("video_path", f"videos/{key}", video_key=key), start)

    def _video_bytes(self, key: str) -> int:
        file = self._clip(key).file
        clip = [float(self._row[f"videos/{key}/{end}_timestamp"]) for end in ("from", "to")]
        return round(_size(file) * min(1.0, (clip[1] - clip[0]) / max(_seconds(file), 1e-9)))

    def _file(self, pattern: str, prefix: str, **names: str) -> Path:
        numbers = {name: int(self._row[f"{prefix}/{name}"]) for name in ("chunk_index", "file_index")}
        return self.path / str(self._info[pattern]).format(**numbers, **names)


def open_lerobot(root: Path) -> list[LeRobotRecording]:
    """The episodes of a LeRobot data set, in order.

    Raises:
        DamagedFile: a file of it is missing or damaged, or it is of a version that is not known.
    """
    try:
        info = json.loads((root / INFO).read_text(encoding="utf-8"))
        version = str(info["codebase_version"])
    except (OSError, ValueError, KeyError) as error:
        raise DamagedFile(f"{root / INFO} cannot be read: {error}", hint=MEND) from error
    if version == "v2.1":
        return [LeRobotV21(root, info, row) for row in _lines(root / "meta/episodes.jsonl")]
    if version == "v3.0":
        tables = [_table(file) for file in sorted((root / "meta/episodes").rglob("*.parquet"))]
        return [LeRobotV30(root, info, row) for table in tables for row in table.to_pylist()]
    raise DamagedFile(
        f"{root} is a LeRobot data set of version {version}; v2.1 and v3.0 are known",
        hint="convert it with lerobot's own converter first",
    )


def _table(file: Path) -> pa.Table:
    try:
        return pq.read_table(file)
    except (OSError, pa.ArrowException) as error:
        raise DamagedFile(f"{file} cannot be read: {error}", hint=MEND) from error


def _lines(file: Path) -> list[dict[str, Any]]:
    try:
        return [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines() if line.strip()]
    except (OSError, ValueError) as error:
        raise DamagedFile(f"{file} cannot be read: {error}", hint=MEND) from error


def _size(file: Path) -> int:
    try:
        return file.stat().st_size
    except OSError as error:
        raise DamagedFile(f"{file} is missing", hint=MEND) from error


def _seconds(file: Path) -> float:
    try:
        with av.open(str(file)) as container:
            return float(container.duration or 0) / av.time_base
    except av.error.FFmpegError as error:
        raise DamagedFile(f"{file} is no video: {error}", hint=MEND) from error
