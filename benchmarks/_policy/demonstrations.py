"""Episodes as a policy is trained on them: the same frames, their pictures from one encoding or another.

Pictures are made small by averaging areas, the same way for all encodings: two cores train on nothing larger, and it
averages away a part of the encoder's effect on the pictures, for every encoding alike.
"""

from __future__ import annotations

import logging
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks._compression_formats import LEROBOT
from vcage.base.files import RunFolder, atomic_path, read_json, sha256_file, write_json
from vcage.base.videos import decode
from vcage.datasets.reader import EpisodeReader
from vcage.runs.accepted import accepted_episodes
from vcage.schema.compression import Compression
from vcage.schema.episodes import Episode

logger = logging.getLogger(__name__)

Encoding = Literal["raw", "ours", "lerobot"]
"""As rendered; as ``compress`` left it; and LeRobot's default, AV1 with CRF 30 and a GOP of 2."""

Videos = Mapping[tuple[str, str], Path]
"""File of an episode and name of a camera → the video."""

ENCODINGS: tuple[Encoding, ...] = get_args(Encoding)


@dataclass(frozen=True)
class View:
    """Input of a policy: names of cameras, and the height and width of the pictures, pixels."""

    cameras: tuple[str, ...]
    height: int
    width: int


@dataclass(frozen=True)
class Demonstrations:
    """All frames of some episodes, one episode after the other: F frames, C cameras, D numbers of a state.

    Args:
        pictures: (F, C, H, W, 3) uint8 RGB.
        states: (F, D) float32, measured: radians, grippers from 0 closed to 1 open.
        actions: (F, D) float32, commanded, in the same units.
        ends: (E,) the frame behind the last of each episode.
        grippers: columns of a state that are of grippers.
        bytes: that the pictures of these cameras take in this encoding, at their full size.
    """

    pictures: NDArray[np.uint8]
    states: NDArray[np.float32]
    actions: NDArray[np.float32]
    ends: NDArray[np.int64]
    grippers: tuple[int, ...]
    bytes: int

    def __len__(self) -> int:
        return len(self.states)

    def chunk(self, frames: NDArray[np.int64], length: int) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
        """The next actions from each of (N,) frames on, (N, length, D); and (N, length), if of the episode.

        Behind its end the last action of the episode is repeated.
        """
        last = self.ends[np.searchsorted(self.ends, frames, side="right")] - 1
        wanted = frames[:, None] + np.arange(length)
        return self.actions[np.minimum(wanted, last[:, None])], wanted <= last[:, None]


def load(run: RunFolder, episodes: int, encoding: Encoding, view: View) -> Demonstrations:
    """The first episodes of a run that count.

    Their small pictures are stored once beside the run and read from there.
    """
    chosen = accepted_episodes(run)[:episodes]
    name = f"{encoding}-{len(chosen)}-{view.height}x{view.width}-{'-'.join(view.cameras)}"
    source = run.compression if encoding == "ours" else run.episodes
    path = run.root.parent / "pictures" / f"{run.root.name}-{name}-{sha256_file(source)[:12]}.npy"
    if not path.exists():
        logger.info("%s: pictures of %d episodes, %s", run.root.name, len(chosen), encoding)
        _make(run, chosen, encoding, view, path)
    data = [_numbers(run, episode) for episode in chosen]
    states, actions, grippers = zip(*data, strict=True)
    return Demonstrations(
        pictures=np.load(path, mmap_mode="r"),
        states=np.concatenate(states),
        actions=np.concatenate(actions),
        ends=np.cumsum([len(one) for one in states]),
        grippers=grippers[0],
        bytes=read_json(path.with_suffix(".json"))["bytes"],
    )


def small(picture: NDArray[np.uint8], view: View) -> NDArray[np.uint8]:
    """A picture in the size of a view, areas averaged."""
    return np.asarray(cv2.resize(picture, (view.width, view.height), interpolation=cv2.INTER_AREA), np.uint8)


def _numbers(run: RunFolder, episode: Episode) -> tuple[NDArray[np.float32], NDArray[np.float32], tuple[int, ...]]:
    with EpisodeReader(run.root / str(episode.file)) as reader:
        data = reader.episode
    return data.qpos.astype(np.float32), data.action.astype(np.float32), tuple(data.grippers)


def _make(run: RunFolder, chosen: Sequence[Episode], encoding: Encoding, view: View, path: Path) -> None:
    found, total = [], 0
    videos = _videos(run) if encoding == "ours" else {}
    for episode in chosen:
        of_cameras = []
        for camera in view.cameras:
            frames, stored = _decoded(run, episode, camera, encoding, videos)
            of_cameras.append([small(picture, view) for picture in frames])
            total += stored
        found.append(np.stack(of_cameras, axis=1))
    write_json(path.with_suffix(".json"), {"bytes": total})
    with atomic_path(path) as part:  # after its figures: an existing file is complete
        np.save(part, np.concatenate(found))


def _videos(run: RunFolder) -> Videos:
    streams = Compression.read(run.compression).streams
    return {(stream.episode, stream.camera): run.root / stream.file for stream in streams}


def _decoded(
    run: RunFolder, episode: Episode, camera: str, encoding: Encoding, videos: Videos
) -> tuple[NDArray[np.uint8], int]:
    """(T, H, W, 3) uint8 RGB pictures of an episode as they come back from an encoding, and its bytes."""
    if encoding == "ours":
        return _of_file(videos[str(episode.file), camera])
    frames, fps = _raw(run, episode, camera)
    if encoding == "raw":
        return frames, frames.nbytes
    with tempfile.TemporaryDirectory() as folder:
        video = Path(folder) / "video.mp4"
        LEROBOT.write(frames, fps, video)
        return _of_file(video)


def _of_file(video: Path) -> tuple[NDArray[np.uint8], int]:
    return decode(video), video.stat().st_size


def _raw(run: RunFolder, episode: Episode, camera: str) -> tuple[NDArray[np.uint8], float]:
    """The pictures as they were rendered, and frames per second."""
    with EpisodeReader(run.root / str(episode.file)) as reader:
        return reader.images(camera)[:], reader.episode.fps
