"""The run folders below some folders, and which of them one data set can hold together."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Iterator
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import Any

from vcage.apps.run_episodes import first_recording
from vcage.base.errors import InputFileError
from vcage.base.files import RunFolder, whole
from vcage.base.folders import entries, real_path
from vcage.datasets.lerobot.features import CAMERA, number_names, video_facts, video_keys
from vcage.datasets.lerobot.meta import INFO, data_set_info
from vcage.datasets.recordings.recording import Recording
from vcage.runs.raw_pictures import accepted_files
from vcage.schema.compression import Compression
from vcage.schema.episodes import Episodes


@dataclass(frozen=True)
class Kind:
    """Facts that all episodes of one data set share.

    Args:
        robot: its name.
        fps: frames per second.
        codec: of the videos.
        cameras: (name, width, height) of each, sorted.
        numbers: names of the numbers of a state, and of an action.
    """

    robot: str
    fps: float
    codec: str
    cameras: tuple[tuple[str, int, int], ...]
    numbers: tuple[tuple[str, ...], tuple[str, ...]]

    @classmethod
    def of(cls, recording: Recording, codec: str) -> Kind:
        """Return that of an episode."""
        cameras = sorted((one.name, one.width, one.height) for one in recording.cameras)
        numbers = tuple(recording.state_names), tuple(recording.action_names)
        return cls(recording.robot or "unknown", float(recording.fps or 0), codec, tuple(cameras), numbers)

    @classmethod
    def of_data_set(cls, root: Path) -> Kind:
        """Return that of a data set of ours; raises :class:`DamagedFile`."""
        info = data_set_info(root)
        features: dict[str, Any] = info["features"]
        cameras = [(key.removeprefix(CAMERA), *features[key]["shape"][1::-1]) for key in video_keys(features)]
        codec = next((str(video_facts(features[key]).get("video.codec")) for key in video_keys(features)), "")
        names = [features.get(name, {}).get("names") for name in ("observation.state", "action")]
        state, action = (tuple(number_names(one)) for one in names)
        return cls(str(info.get("robot_type")), float(info["fps"]), codec, tuple(sorted(cameras)), (state, action))

    @property
    def name(self) -> str:
        """A folder's name for it, the same in every merge."""
        digest = hashlib.sha256(json.dumps(astuple(self)).encode()).hexdigest()[:6]
        return f"{self.robot}-{self.fps:g}fps-{len(self.cameras)}cameras-{self.codec}-{digest}"

    def differences(self, other: Kind) -> list[str]:
        """Name the facts in which another kind differs, with its own."""
        facts = ("robot", "fps", "codec", "cameras", "numbers")
        return [f"{fact} {getattr(other, fact)}" for fact in facts if getattr(self, fact) != getattr(other, fact)]


@dataclass(frozen=True)
class FoundRun:
    """A run folder.

    Args:
        root: its folder.
        name: from the folder that was given; data sets call it so, wherever they are moved.
        kind: of its episodes; None where none can be read.
        draw: number that is the same for every run of its instruction, robot and seed, evenly spread.
    """

    root: Path
    name: str
    kind: Kind | None
    draw: int


def run_folders(folders: Iterable[Path]) -> Iterator[tuple[Path, str]]:
    """Yield each run folder at or below some folders once, in natural order, and its name.

    A run folder is one with ``episodes/episodes.json``. Links to folders are not followed, neither hidden folders nor
    LeRobot data sets are looked into. A folder that cannot be read is yielded too: whoever reads it says why.
    """
    seen: set[str] = set()
    for given in folders:
        top = real_path(given)
        for root in _below(top):
            if (real := os.fspath(root)) not in seen:
                seen.add(real)
                yield root, (Path(top.name) / root.relative_to(top)).as_posix()


def _below(folder: Path) -> Iterator[Path]:
    try:
        found = (folder / "episodes" / "episodes.json").is_file()
        inside = [] if found or (folder / INFO).is_file() else entries(folder)
        folders = [path for path in inside if path.is_dir() and not path.is_symlink() and whole(path)]
    except (OSError, InputFileError):
        found, folders = True, []
    if found:
        yield folder
    for path in folders:
        yield from _below(path)


def look_at(root: Path, name: str) -> FoundRun | None:
    """Return a run folder with the kind of its episodes; None where no episode of it counts.

    Raises:
        InputFileError: its records cannot be read, or it was not compressed.
    """
    run = RunFolder(root)
    record, files = Episodes.read(run.episodes), accepted_files(run)
    if not files:
        return None
    codec = Compression.read(run.compression).encoding.codec
    recording = first_recording(files)
    kind = None if recording is None else _kind_of(recording, codec)
    facts = [record.instruction, "" if kind is None else kind.robot, record.episodes[0].seed]
    return FoundRun(root, name, kind, int(hashlib.sha256(json.dumps(facts).encode()).hexdigest()[:16], 16))


def _kind_of(recording: Recording, codec: str) -> Kind | None:
    try:
        return Kind.of(recording, codec)
    except InputFileError:  # it is named when its episodes are loaded
        return None
