"""A LeRobot data set with other videos: pictures are replaced, everything else stays as it is, bit for bit.

The description of the videos changes with them: ``features`` of ``meta/info.json``, and in v3.0 the columns
``videos/<key>/…`` of ``meta/episodes``. A camera whose pictures lie in the tables of frames, or in files that these
name, becomes one with videos: https://huggingface.co/docs/lerobot/lerobot-dataset-v3. All other files are copied.
"""

from __future__ import annotations

import glob
import re
import shutil
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import pyarrow as pa

from vcage.base.errors import UsageError
from vcage.base.files import atomic_folder, write_json
from vcage.base.folders import natural_path
from vcage.base.progress import Progress, silent
from vcage.base.text import listed
from vcage.datasets.lerobot import v3, v21
from vcage.datasets.lerobot.features import require_rgb, video_facts, video_info
from vcage.datasets.lerobot.meta import INFO, PER_EPISODE, data_set_info, episode_lengths, episode_tables
from vcage.datasets.lerobot.parquet import numbered, rewrite, texts_of
from vcage.datasets.lerobot.places import inside, is_own, own_files, placed

VIDEO_PATHS = {"v2.0": v21.VIDEO_PATH, "v2.1": v21.VIDEO_PATH, "v3.0": v3.VIDEO_PATH}
"""Paths of videos in a data set that had none."""

Videos = Mapping[str, Mapping[int, Path]]
"""Key of a camera's feature → number of an episode → its MP4."""


def require_whole(root: Path, episodes: Collection[int]) -> None:
    """Raise UsageError unless these are all episodes of a data set; names the missing ones.

    Raises:
        DamagedFile: its list of episodes cannot be read.
    """
    info = data_set_info(root)
    _require_all(root, info, episode_lengths(root, info), episodes)


def repack(
    root: Path, out: Path, videos: Videos, encodings: Mapping[str, Mapping[str, Any]], progress: Progress = silent
) -> Path:
    """Write a copy of a data set in which some cameras have other videos; it appears whole or not at all.

    In memory are the names of files, and one row group of a Parquet file without its pictures.

    Args:
        root: the data set, v2.0, v2.1 or v3.0; only read.
        out: the folder to write; an old one is replaced.
        videos: all episodes of every camera that changes. Other cameras keep their pictures.
        encodings: key of a camera's feature → facts about its encoding beyond those of its videos, such as
            ``{"video.crf": 18}``; None for facts in which they differ.
        progress: called for each video.

    Returns:
        ``out``.

    Raises:
        UsageError: a camera has no video of some episode, or shows depth or grey, which a video in RGB cannot keep.
        DamagedFile: a file of the data set is damaged, or a video does not show its episode's frames.
        DiskFull, OutputFolderError: the folder cannot be written.
    """
    work = _Repacking(Path(root), data_set_info(root), videos)
    info = work.new_info(encodings)
    with atomic_folder(Path(out)) as folder:
        work.copy_untouched(folder)
        work.write_tables(folder)
        work.write_videos(folder, progress)
        write_json(folder / INFO, info)
    return Path(out)


@dataclass(frozen=True)
class _Repacking:
    """A data set, its ``meta/info.json``, and its new videos."""

    root: Path
    info: Mapping[str, Any]
    videos: Videos

    def new_info(self, encodings: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
        """Return ``meta/info.json`` after checking that every video can replace its pictures."""
        features = dict(self.info["features"])
        lengths = episode_lengths(self.root, self.info)
        for key, own in self.videos.items():
            _require_all(self.root, self.info, lengths, own)
            require_rgb(key, features[key])
            infos = [video_info(own[episode], frames, float(self.info["fps"])) for episode, frames in lengths.items()]
            facts = {**infos[0], **encodings.get(key, {})}
            features[key] = _video_feature(features[key], {name: one for name, one in facts.items() if one is not None})
        info: dict[str, Any] = {**self.info, "video_path": self._video_pattern, "features": features}
        if "total_videos" in info:
            info["total_videos"] += len(self._in_tables) * len(lengths)
        return info

    def copy_untouched(self, folder: Path) -> None:
        """Copy unchanged files, byte for byte."""
        changing = self._changing()
        for file in own_files(self.root):
            if file not in changing:
                shutil.copyfile(self.root / file, _with_folder(folder / file))

    def write_tables(self, folder: Path) -> None:
        """Write the tables that held pictures, or hold the places of videos."""
        for file in self._frame_tables():
            rewrite(self.root / file, _with_folder(folder / file), without=self._in_tables)
        for file in self._episode_tables():
            rewrite(
                self.root / file,
                _with_folder(folder / file),
                change=partial(place_videos, info=self.info, keys=self.videos),
            )

    def write_videos(self, folder: Path, progress: Progress) -> None:
        """Copy the new videos to their places."""
        for key, own in self.videos.items():
            for number, (episode, video) in enumerate(sorted(own.items())):
                progress(f"writing {key}", number, len(own))
                shutil.copyfile(video, _with_folder(folder / self._video_place(key, episode)))

    @property
    def _in_tables(self) -> list[str]:
        """Changed cameras with pictures not in videos yet."""
        return [key for key in self.videos if self.info["features"][key]["dtype"] == "image"]

    @property
    def _video_pattern(self) -> str:
        return self.info.get("video_path") or VIDEO_PATHS[self.info["codebase_version"]]

    def _video_place(self, key: str, episode: int) -> Path:
        chunk = int(self.info["chunks_size"])
        names = {"episode_chunk": episode // chunk, "episode_index": episode, **numbered(episode, chunk)}
        return placed(self.root, "video_path", self._video_pattern, video_key=key, **names).relative_to(self.root)

    def _changing(self) -> set[Path]:
        """Return all rewritten or removed files."""
        frames = self._frame_tables()
        gone = {Path(text) for file in frames for key in self._in_tables for text in self._named_in(file, key)}
        old = {file for key in self.videos for file in self._matching("video_path", self._video_pattern, key)}
        return {INFO, *frames, *self._episode_tables(), *gone, *old}

    def _frame_tables(self) -> list[Path]:
        found = self._matching("data_path", self.info["data_path"]) if self._in_tables else ()
        return sorted(found, key=natural_path)

    def _episode_tables(self) -> list[Path]:
        return [] if self.info["codebase_version"] in PER_EPISODE else episode_tables(self.root)

    def _named_in(self, file: Path, key: str) -> Iterator[str]:
        """Yield picture files that a table of frames names; none where it holds the pictures themselves."""
        names = texts_of(self.root / file, key, "path")
        return (name for name in names if ".." not in Path(name).parts and (self.root / name).is_file())

    def _matching(self, field: str, pattern: str, key: str = "") -> Iterator[Path]:
        """Yield files at paths that a pattern of ``info.json`` gives any chunk and episode."""
        wild = re.sub(r"\{[^}]*\}", "*", pattern.replace("{video_key}", glob.escape(key)))
        found = self.root.glob(str(inside(wild, f"{self.root / INFO}: {field}")))
        return (file for path in found if is_own(file := path.relative_to(self.root)))


def _require_all(root: Path, info: Mapping[str, Any], there: Collection[int], given: Collection[int]) -> None:
    missing = sorted(set(there) - set(given))
    if missing:
        other = "v2.1" if info["codebase_version"] == "v3.0" else "v3.0"
        raise UsageError(
            f"{root} keeps the numbers of its episodes, so none can be left out; missing: {listed(missing, most=5)}",
            hint=f"repair or fetch them, or give --to lerobot-{other}, which renumbers the others",
            details={"missing": missing},
        )


def _video_feature(feature: Mapping[str, Any], facts: Mapping[str, Any]) -> dict[str, Any]:
    """Return a feature with these facts of its videos; its other facts stay."""
    where = "video_info" if "video_info" in feature and not feature.get("info") else "info"
    old = video_facts(feature).items()
    others = {name: value for name, value in old if not name.startswith("video.") and name != "has_audio"}
    rest = {name: value for name, value in feature.items() if name not in ("info", "video_info")}
    return {**rest, "dtype": "video", where: {**facts, **others}}


def _with_folder(path: Path) -> Path:
    """Return a path after making its folder."""
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def place_videos(rows: pa.Table, info: Mapping[str, Any], keys: Collection[str]) -> pa.Table:
    """Return rows of a v3.0 list with a video for each episode, numbered like the episode.

    Args:
        rows: with ``episode_index`` and ``length``; columns ``videos/<key>/…`` keep their types, or come.
        info: ``meta/info.json``.
        keys: features of the cameras with new videos.
    """
    places = [numbered(episode, int(info["chunks_size"])) for episode in rows["episode_index"].to_pylist()]
    lengths = rows["length"].to_pylist()
    columns = {
        "chunk_index": pa.array([place["chunk_index"] for place in places], pa.int64()),
        "file_index": pa.array([place["file_index"] for place in places], pa.int64()),
        "from_timestamp": pa.array([0.0] * len(lengths), pa.float64()),
        "to_timestamp": pa.array([length / float(info["fps"]) for length in lengths], pa.float64()),
    }
    for key in keys:
        for name, values in columns.items():
            rows = _with_column(rows, f"videos/{key}/{name}", values)
    return rows


def _with_column(rows: pa.Table, name: str, values: pa.Array) -> pa.Table:
    index = rows.schema.get_field_index(name)
    if index < 0:
        return rows.append_column(name, values)
    field = rows.schema.field(index)
    return rows.set_column(index, field, values.cast(field.type))
