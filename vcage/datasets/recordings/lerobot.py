"""The episodes of a LeRobot data set, v2.0, v2.1 and v3.0: https://huggingface.co/docs/lerobot/lerobot-dataset-v3."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from vcage.base.errors import DamagedFile, UsageError
from vcage.base.folders import natural_key, natural_path
from vcage.base.pictures import picture_header
from vcage.base.placeholders import require_fetched
from vcage.base.videos import decode
from vcage.datasets.lerobot.episode import ACTION, STATE
from vcage.datasets.lerobot.features import CAMERA, OF_SUBTASKS, number_names, other_columns, require_rgb, video_facts
from vcage.datasets.lerobot.language import LANGUAGE
from vcage.datasets.lerobot.meta import data_set_info, episode_rows
from vcage.datasets.lerobot.parquet import MEND, read_table
from vcage.datasets.lerobot.places import inside, own_file, own_files, placed
from vcage.datasets.recordings.colours import Colours
from vcage.datasets.recordings.columns import Columns
from vcage.datasets.recordings.lerobot_rows import OUTCOME, Clip, TimedRows
from vcage.datasets.recordings.lerobot_sizes import file_size, picture_size, video_seconds
from vcage.datasets.recordings.lerobot_times import Share, shares
from vcage.datasets.recordings.other_streams import MeasuredStream, measured_file
from vcage.datasets.recordings.recording import RecordedCamera, Recording
from vcage.datasets.stored_pictures import channels_of, decode_picture, stacked, storage_of


class LeRobotRecording(TimedRows, Recording):
    """One episode of a data set.

    Args:
        root: folder of the data set; it is the recording's path.
        info: its ``meta/info.json``.
        row: what the data set says of the episode.
        shares: key of a camera → the episode's part of a video that holds several.
    """

    def __init__(
        self, root: Path, info: Mapping[str, Any], row: Mapping[str, Any], shares: Mapping[str, Share] | None = None
    ):
        super().__init__(root, int(row["episode_index"]))
        self._info, self._row, self._shares = info, row, shares or {}
        self._placed: dict[str, tuple[Sequence[int], str]] = {}

    def __str__(self) -> str:
        return f"{self.path} episode {self.number}"

    def name(self, root: Path) -> str:
        return f"episode_{self.number:06d}"

    @property
    def fps(self) -> float | None:
        return float(self._info["fps"])

    @property
    def task(self) -> str | None:
        return "; ".join(self._row.get("tasks") or ()) or None

    @property
    def robot(self) -> str | None:
        return self._info.get("robot_type")

    @property
    def frames(self) -> int:
        return int(self._row["length"])

    @property
    def notes(self) -> list[str]:
        never = f"no episode of its data set has a true {OUTCOME}, so nobody seems to have recorded that"
        return super().notes + [never] * (not self._labelled)

    def left_out(self) -> dict[str, str]:
        features = self._info["features"]
        measured = {stream.key for stream in self.other_streams}
        names = [name for name in other_columns(features) if features[name]["dtype"] != "image" or name in measured]
        words = [name for name in OF_SUBTASKS if name in features]
        parts = dict.fromkeys(words, "parts of the task are not taken over by another version")
        return dict.fromkeys(names, "another version is written with state, action and cameras alone") | parts

    def with_colours(self, colours: Colours) -> Self:
        if colours.swapped:
            raise UsageError(
                f"{self.path} is a LeRobot data set, whose pictures and their statistics are RGB",
                hint="leave --colours out, or change the recordings that it was made of",
            )
        return self

    def require_rgb(self, cameras: Collection[str]) -> None:
        for camera in cameras:
            key = self.camera(camera).key
            require_rgb(key, self._info["features"][key])

    @cached_property
    def cameras(self) -> list[RecordedCamera]:
        measured = {stream.key for stream in self.other_streams}
        keys = [key for key in (*self._keys_of("video"), *self._keys_of("image")) if key not in measured]
        return sorted((self._camera(key) for key in keys), key=lambda camera: natural_key(camera.name))

    @cached_property
    def other_streams(self) -> list[MeasuredStream]:
        keys = sorted(self._keys_of("image"), key=natural_key)
        found = [measured_file(key, self._stored(self._column(key)[0].as_py())) for key in keys]
        return [stream for stream in found if stream is not None]

    @property
    def files(self) -> list[Path]:
        """The data set's own description, and the episode's table and videos."""
        described = [self.path / file for file in own_files(self.path, Path("meta"))]
        videos = {self._clip(key).file for key in self._keys_of("video")}
        return [*described, self._data_file, *sorted(videos, key=natural_path)]

    def pictures(self, camera: str, indices: Sequence[int] | None = None) -> NDArray[np.uint8]:
        one = self.camera(camera)
        wanted = list(range(one.frames) if indices is None else indices)
        if self._info["features"][one.key]["dtype"] == "video":
            frames, _ = self._frames_in_video(one.key)
            return decode(self._clip(one.key).file, [frames[index] for index in wanted])
        stored = self._column(one.key)
        what = f"{self} {one.key}"
        return stacked(
            [decode_picture(self._stored(stored[index].as_py()), f"{what}[{index}]") for index in wanted], what
        )

    def _camera_notes(self) -> list[str]:
        found = [(key, self._frames_in_video(key)[1]) for key in sorted(self._keys_of("video"), key=natural_key)]
        times = self._row_times.note
        notes = super()._camera_notes() + [times] * bool(times) + [f"{key}: {note}" for key, note in found if note]
        for camera in self.cameras:
            try:
                self.require_rgb([camera.name])
            except UsageError as error:
                notes.append(f"{error.message}: {error.hint}")
        return notes

    def _read_commands(self) -> Columns | None:
        return self._numbers(ACTION)

    def _read_state(self) -> Columns | None:
        return self._numbers(STATE)

    def _numbers(self, key: str) -> Columns | None:
        feature = self._info["features"].get(key)
        if feature is None:
            return None
        values = np.array(self._column(key).to_pylist(), np.float64)
        return Columns(values.reshape(len(values), -1), tuple(number_names(feature.get("names"))))

    def _keys_of(self, dtype: str) -> list[str]:
        """The features of a type."""
        return [key for key, feature in self._info["features"].items() if feature["dtype"] == dtype]

    def _column(self, key: str) -> pa.ChunkedArray:
        """A column of the episode's frames, of at least one."""
        found = read_table(self._data_file, [key], pc.field("episode_index") == self.number)[key]
        if len(found) == 0:
            raise DamagedFile(f"{self} holds no frame", hint="leave the episode out")
        if len(found) != self.frames:
            raise DamagedFile(f"{self} has {len(found)} frames in {self._data_file}, not {self.frames}", hint=MEND)
        return found

    def _camera(self, key: str) -> RecordedCamera:
        feature, frames = self._info["features"][key], self.frames
        height, width = picture_size(feature["shape"])
        name = key.removeprefix(CAMERA)
        if feature["dtype"] == "video":
            storage = str(video_facts(feature).get("video.codec", "video"))
            return RecordedCamera(name, key, frames, width, height, storage, self._video_bytes(key))
        stored = self._column(key)
        first = self._stored(stored[0].as_py())
        storage, channels = storage_of(first, f"{self} {key}[0]"), channels_of(first, f"{self} {key}[0]")
        size = sum(len(self._stored(value.as_py())) for value in stored)
        return RecordedCamera(name, key, frames, width, height, storage, size, channels)

    def _stored(self, value: Mapping[str, Any]) -> bytes:
        data = value.get("bytes")
        if data is not None:
            return data
        where = f"{self._data_file}: path"
        file = own_file(self.path, inside(str(value.get("path") or ""), where), where)
        require_fetched(file)
        picture_header(file)
        try:
            return file.read_bytes()
        except OSError as error:
            raise DamagedFile(f"{file} cannot be read: {error.strerror}", hint=MEND) from error

    @abstractmethod
    def _video_bytes(self, key: str) -> int:
        """What the pictures of a camera take; a share of a video that holds other episodes too."""


class LeRobotV21(LeRobotRecording):
    """A file per episode and camera."""

    LAYOUT = TARGET = "lerobot-v2.1"

    @property
    def _data_file(self) -> Path:
        return self._file("data_path")

    def _clip(self, key: str) -> Clip:
        return Clip(self._file("video_path", video_key=key), 0.0, Share(0, self.frames))

    def _video_bytes(self, key: str) -> int:
        file = self._clip(key).file
        video_seconds(file)  # which shows that it is a video
        return file_size(file)

    def _file(self, pattern: str, **names: int | str) -> Path:
        chunk = self.number // int(self._info["chunks_size"])
        names |= {"episode_chunk": chunk, "episode_index": self.number}
        return placed(self.path, pattern, self._info[pattern], **names)


class LeRobotV20(LeRobotV21):
    """The same with statistics of all episodes together."""

    LAYOUT = TARGET = "lerobot-v2.0"


class LeRobotV30(LeRobotRecording):
    """Many episodes in a file."""

    LAYOUT = TARGET = "lerobot-v3.0"

    @property
    def _data_file(self) -> Path:
        return self._file("data_path", "data")

    def _clip(self, key: str) -> Clip:
        begin = float(self._said(f"videos/{key}/from_timestamp"))
        return Clip(self._file("video_path", f"videos/{key}", video_key=key), begin, self._shares.get(key))

    def _video_bytes(self, key: str) -> int:
        file = self._clip(key).file
        clip = [float(self._said(f"videos/{key}/{end}_timestamp")) for end in ("from", "to")]
        return round(file_size(file) * min(1.0, (clip[1] - clip[0]) / max(video_seconds(file), 1e-9)))

    def _file(self, pattern: str, prefix: str, **names: str) -> Path:
        numbers = {name: int(self._said(f"{prefix}/{name}")) for name in ("chunk_index", "file_index")}
        return placed(self.path, pattern, self._info[pattern], **numbers, **names)

    def _said(self, name: str) -> Any:
        """What the list of episodes says of the episode."""
        value, listed = self._row.get(name), f"the list of episodes of {self.path}"
        if value is None:
            raise DamagedFile(f"{listed} does not say {name} of {self.number}", hint=MEND)
        if not (isinstance(value, int | float) and math.isfinite(value)):
            raise DamagedFile(f"{listed} says that {name} of {self.number} is {value!r}, not a number", hint=MEND)
        return value


class LeRobotV31(LeRobotV30):
    """The same with the sub-tasks in words."""

    LAYOUT = TARGET = "lerobot-v3.1"


def open_lerobot(root: Path) -> list[LeRobotRecording]:
    """The episodes of a LeRobot data set, in order; at least one.

    Raises:
        DamagedFile: what describes it is missing or damaged, or it is of a version that is not known.
    """
    info = data_set_info(root)
    episodes = _opened(root, info, episode_rows(root, info))
    if OUTCOME in info["features"] and len(episodes) > 1 and not any(one.succeeds() for one in episodes):
        for one in episodes:
            one.set_unlabelled()
    return episodes


def _opened(root: Path, info: Mapping[str, Any], rows: Sequence[Mapping[str, Any]]) -> list[LeRobotRecording]:
    """The episodes of these rows, in the class of the data set's version."""
    in_words = not set(LANGUAGE).isdisjoint(info["features"])
    old: dict[str, type[LeRobotRecording]] = {"v2.0": LeRobotV20, "v2.1": LeRobotV21}
    if info["codebase_version"] in old:
        return [old[info["codebase_version"]](root, info, row) for row in rows]
    kind = LeRobotV31 if in_words else LeRobotV30
    videos = [key for key, feature in info["features"].items() if feature["dtype"] == "video"]
    parts = {key: shares(rows, key, float(info["fps"])) for key in videos}
    return [kind(root, info, row, _own(parts, row["episode_index"])) for row in rows]


def _own(parts: Mapping[str, Mapping[int, Share]], episode: int) -> dict[str, Share]:
    """Camera → the part of its video that an episode has."""
    return {key: own[episode] for key, own in parts.items() if episode in own}
