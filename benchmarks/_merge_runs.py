"""Run folders with many small episodes, made without a simulator: HDF5 and HEVC are real, their content is not."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vcage.base.files import RunFolder, sha256_file
from vcage.datasets.episode import CameraTrack, EpisodeData
from vcage.datasets.hdf5 import write_episode
from vcage.datasets.packed import write_packed
from vcage.datasets.packing.settings import CompressionSettings
from vcage.datasets.packing.writing import compression_record, link_to
from vcage.datasets.recordings.opening import open_hdf5
from vcage.runs.edits import seal
from vcage.runs.raw_pictures import accepted_files
from vcage.schema.base import PoseRecord, Provenance
from vcage.schema.compression import VideoStream
from vcage.schema.episodes import CriticCounts, Episode, Episodes
from vcage.schema.scene import ObjectRecord
from vcage.schema.subtasks import Chain
from vcage.video.codec import EncoderSettings, encode


@dataclass(frozen=True)
class RunSpec:
    """Content of a run.

    Args:
        seed: of the run; starts, motions and pictures depend on it.
        episodes: that are accepted.
        frames: of each.
        instruction: its task.
        robot: name of the robot.
        fps: frames per second.
        crf: of the videos.
        codec: of the videos.
        look: added to the brightness; nothing else depends on it.
        cameras: their names.
        width, height: of the pictures, pixels.
    """

    seed: int = 0
    episodes: int = 5
    frames: int = 20
    instruction: str = "Put the red block on the plate"
    robot: str = "dual_panda"
    fps: int = 10
    crf: int = 20
    codec: str = "hevc"
    look: int = 0
    cameras: tuple[str, ...] = ("cam_high", "cam_left_wrist")
    width: int = 64
    height: int = 48


def make_run(root: Path, spec: RunSpec = RunSpec()) -> RunFolder:
    """Write a run folder as ``collect`` and ``compress`` leave it."""
    run = RunFolder(root)
    episodes = [_episode(run, spec, index) for index in range(spec.episodes)]
    record = Episodes(
        provenance=Provenance(producer="collect", seed=spec.seed),
        instruction=spec.instruction,
        chains=[Chain(text=spec.instruction, subtasks=["place-block"])],
        episodes=episodes,
        attempts=spec.episodes,
        acceptance={},
        critic=CriticCounts.of([]),
    )
    seal(record, run.episodes)
    _compress(run, spec)
    return run


def _compress(run: RunFolder, spec: RunSpec) -> None:
    """Encode at a given CRF; no loss is judged, and no video decoded."""
    files, settings = accepted_files(run), CompressionSettings(crf=spec.crf, codec=spec.codec, effort="fast")
    inputs = {run.relative(path): sha256_file(path) for path in (run.episodes, *(file.path for file in files))}
    streams, packed = [], {}
    run.compression.parent.mkdir()
    for index, file in enumerate(files):
        own = []
        for camera in spec.cameras:
            video = run.compression.parent / f"{file.path.stem}.{camera}.mp4"
            video.write_bytes(_encoded(spec, _seam(spec, index, camera)))
            os.link(video, file.path.with_name(video.name))
            own.append(_stream(run, file.name, camera, video, spec))
        recording = open_hdf5(file.path)
        os.replace(
            write_packed(file.path, run.root / file.path.name, [link_to(recording, one) for one in own]), file.path
        )
        packed[file.name] = sha256_file(file.path)
        streams += own
    provenance = Provenance(producer="compress", seed=spec.seed, options=settings.options(), inputs=inputs)
    seal(compression_record(provenance, settings, streams, packed=packed), run.compression)


def _stream(run: RunFolder, episode: str, camera: str, video: Path, spec: RunSpec) -> VideoStream:
    settings, raw_bytes = EncoderSettings(codec=spec.codec), spec.frames * spec.height * spec.width * 3
    return VideoStream(
        episode=episode,
        camera=camera,
        file=run.relative(video),
        frames=spec.frames,
        bytes=video.stat().st_size,
        raw_bytes=raw_bytes,
        jpeg_bytes=raw_bytes,
        stored_bytes=raw_bytes,
        codec=spec.codec,
        pixel_format=settings.pixel_format,
        gop=settings.gop,
        crf=spec.crf,
        loss_max=0.0,
        loss_mean=0.0,
        held_out=None,
        keyframes=[],
        guarded=[],
        evaluations=[],
    )


def _episode(run: RunFolder, spec: RunSpec, index: int) -> Episode:
    """Write the file of an episode, and return its record."""
    file, rng = f"episodes/episode_{index:06d}.hdf5", np.random.default_rng([spec.seed, index])
    x, y = rng.uniform(-0.2, 0.2, 2).tolist()
    write_episode(run.root / file, _motion(spec, rng), _frames(spec, index))
    start = ObjectRecord(
        id="block",
        asset="block",
        variant="red",
        phrase="red block",
        role="content",
        pose=PoseRecord(position=(x, y, 0.74), quaternion=(1.0, 0.0, 0.0, 0.0)),
        aabb=((x - 0.02, y - 0.02, 0.74), (x + 0.02, y + 0.02, 0.78)),
    )
    return Episode(
        index=index,
        seed=spec.seed,
        accepted=True,
        reason="verified",
        file=file,
        frames=spec.frames,
        fps=spec.fps,
        objects=[start],
        subtasks=["place-block"],
    )


def _motion(spec: RunSpec, rng: np.random.Generator) -> EpisodeData:
    """Two arms of seven joints and a gripper each, which swing."""
    names = [f"{arm}_{part}" for arm in ("left", "right") for part in (*(f"joint_{n}" for n in range(1, 8)), "gripper")]
    time = np.arange(spec.frames) / spec.fps
    action = np.sin(time[:, None] * rng.uniform(0.5, 2, len(names)) + rng.uniform(0, 6, len(names)))
    track = CameraTrack(spec.width, spec.height, np.diag([50.0, 50.0, 1.0]), np.tile(np.eye(4), (spec.frames, 1, 1)))
    return EpisodeData(
        fps=spec.fps,
        timestamp=time,
        state_names=names,
        qpos=action - 0.01,
        qvel=np.gradient(action, 1 / spec.fps, axis=0),
        action=action,
        object_poses={"block": np.tile([0.0, 0.0, 0.74, 1.0, 0.0, 0.0, 0.0], (spec.frames, 1))},
        cameras=dict.fromkeys(spec.cameras, track),
        segments=[],
        meta={"instruction": spec.instruction, "seed": spec.seed, "robot": spec.robot},
    )


def _frames(spec: RunSpec, index: int) -> Iterator[dict[str, NDArray[np.uint8]]]:
    clips = {camera: _clip(spec, _seam(spec, index, camera)) for camera in spec.cameras}
    return ({camera: clip[frame] for camera, clip in clips.items()} for frame in range(spec.frames))


def _seam(spec: RunSpec, index: int, camera: str) -> int:
    """Column by which the pictures of a camera differ; there are as many clips as columns."""
    return (31 * spec.seed + 7 * index + spec.cameras.index(camera)) % spec.width


@lru_cache(1024)
def _encoding(seam: int, spec: RunSpec) -> bytes:
    return encode(_clip(spec, seam), spec.fps, EncoderSettings(codec=spec.codec), spec.crf)


def _encoded(spec: RunSpec, seam: int) -> bytes:
    """Return the video of a clip; few are encoded, since many episodes show the same."""
    return _encoding(seam, replace(spec, seed=0, episodes=0, instruction="", robot="", cameras=()))


def _clip(spec: RunSpec, seam: int) -> NDArray[np.uint8]:
    """(T, H, W, 3): a block crosses a floor with a seam."""
    clip = np.repeat(_floor(spec.width, spec.height)[None], spec.frames, axis=0) + np.uint8(spec.look)
    clip[:, :, seam] = 40
    for frame, picture in enumerate(clip):
        left = (4 + frame) % (spec.width - 16)
        picture[16:32, left : left + 16] = (200, 30, 40)
    return clip


@cache
def _floor(width: int, height: int) -> NDArray[np.uint8]:
    coarse = np.random.default_rng(0).uniform(60, 180, (height // 4, width // 4, 3))
    return np.kron(coarse, np.ones((4, 4, 1))).astype(np.uint8)
