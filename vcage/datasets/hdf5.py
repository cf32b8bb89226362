"""Write an episode as HDF5, names as in ACT and robomimic, with all facts for a reader inside.

Layout (schema ``vcage.episode/1``; T frames, D numbers in a state)::

    /timestamp (T,)  /observations/{qpos,qvel} (T, D)
    /action (T, D)              targets at the next frame: action t leads from frame t to frame t + 1
    /observations/images/<camera> (T, H, W, 3) uint8 RGB; attribute sha256: of the pictures as they were recorded
    /cameras/<camera>/{intrinsics (3, 3), extrinsics (T, 4, 4)}   world → camera, OpenCV axes
    /objects/<id> (T, 7)        position and quaternion wxyz in the world
    /object_joints/<id> (T, n)  positions of the moving parts, metres or radians; only for objects that have any
    /drives/…                   commands to the arms at every physics step: vcage.datasets.stored_drives
    /robot_joints/<arm> (T, n)  all active joints of an arm, fingers too, so that a frame can be drawn again
    /subtasks/{id,text,start,end,arm,contact,attempts,verdict,truth}   one row per verified sub-task
    /meta/<name>                JSON text: instruction, seed, robot, scene, versions, providers…

Attributes of the file: schema, fps, colour, state_names, action_leads_to (``next frame``), and the instruction, task,
seed and robot again as plain values. Files of version 0.1.0 lack action_leads_to: their /action has the targets at the
frame itself, and readers shift it by a frame.
"""

from __future__ import annotations

import hashlib
import json
from collections import deque
from collections.abc import Iterable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import deflate
import h5py
import numpy as np
from numpy.typing import NDArray

from vcage.datasets.episode import EpisodeData, actions_of
from vcage.datasets.hdf5_files import new_hdf5
from vcage.datasets.stored_drives import write_drives

SCHEMA = "vcage.episode/1"
GZIP_LEVEL = 1
"""Of arrays of pictures."""


LEADS_TO, NEXT_FRAME = "action_leads_to", "next frame"
"""Attribute of a file whose actions are the targets at the next frame, and its value."""

RECORDED = "sha256"
"""Attribute of a camera's pictures, also where these were moved to a video: SHA-256 of the bytes of all that were
recorded, one after the other."""

TEXT = h5py.string_dtype("utf-8")
SEGMENT_TEXTS = ("subtask", "text", "arm")
SEGMENT_NUMBERS = ("start", "end", "contact", "attempts")


def write_episode(path: Path, episode: EpisodeData, frames: Iterable[Mapping[str, NDArray[np.uint8]]]) -> Path:
    """Write an episode atomically; the same episode gives the same bytes.

    Args:
        path: the ``.hdf5`` file.
        episode: everything but the pictures.
        frames: T mappings camera name → (H, W, 3) uint8 RGB, read one at a time.

    Raises:
        ValueError: a picture does not fit its camera, or there are not T of them.
        OutputFolderError, DiskFull: the file cannot be written.
    """
    with new_hdf5(path) as file:
        _write_attributes(file, episode)
        _write_arrays(file, episode)
        if episode.drives is not None:
            write_drives(file.create_group("drives"), episode.drives)
        _write_segments(file.create_group("subtasks"), episode)
        meta = file.create_group("meta")
        for name in sorted(episode.meta):
            text = json.dumps(episode.meta[name], ensure_ascii=False, sort_keys=True)
            meta.create_dataset(name, data=text, dtype=TEXT, track_times=False)
        _write_images(file.create_group("observations/images"), episode, frames)
    return Path(path)


def stored_actions(file: h5py.File, stored: NDArray[np.float64]) -> NDArray[np.float64]:
    """(T, D) the actions of an episode's file, from what is ``stored`` in it: targets at the next frame."""
    return stored if file.attrs.get(LEADS_TO) == NEXT_FRAME else actions_of(stored)


def _write_attributes(file: h5py.File, episode: EpisodeData) -> None:
    file.attrs["schema"] = SCHEMA
    file.attrs["fps"] = float(episode.fps)
    file.attrs["colour"] = "RGB"
    file.attrs[LEADS_TO] = NEXT_FRAME
    file.attrs["state_names"] = json.dumps(episode.state_names)
    for name in ("instruction", "robot"):
        file.attrs[name] = str(episode.meta[name])
    file.attrs["task"] = episode.task
    file.attrs["seed"] = int(episode.meta["seed"])


def _write_arrays(file: h5py.File, episode: EpisodeData) -> None:
    arrays = {
        "timestamp": episode.timestamp,
        "action": episode.action,
        "observations/qpos": episode.qpos,
        "observations/qvel": episode.qvel,
        **{f"objects/{name}": poses for name, poses in episode.object_poses.items()},
        **{f"object_joints/{name}": joints for name, joints in episode.object_joints.items()},
        **{f"robot_joints/{name}": joints for name, joints in episode.robot_joints.items()},
    }
    for name, camera in episode.cameras.items():
        arrays[f"cameras/{name}/intrinsics"] = camera.intrinsics
        arrays[f"cameras/{name}/extrinsics"] = camera.extrinsics
    file.create_group("objects")
    for name, array in arrays.items():
        # a checksum, so that a damaged file is noticed
        file.create_dataset(name, data=np.asarray(array, np.float64), fletcher32=True, track_times=False)


def _write_segments(group: h5py.Group, episode: EpisodeData) -> None:
    columns: dict[str, list[str]] = {name: [getattr(s, name) for s in episode.segments] for name in SEGMENT_TEXTS}
    columns["verdict"] = [s.verdict.model_dump_json() for s in episode.segments]
    columns["truth"] = [s.truth.model_dump_json() for s in episode.segments]
    columns["id"] = columns.pop("subtask")
    for name, texts in columns.items():
        group.create_dataset(name, (len(texts),), dtype=TEXT, data=texts, track_times=False)
    for name in SEGMENT_NUMBERS:
        numbers = np.array([getattr(s, name) for s in episode.segments], np.int64)
        group.create_dataset(name, data=numbers, track_times=False)


def _write_images(
    group: h5py.Group,
    episode: EpisodeData,
    frames: Iterable[Mapping[str, NDArray[np.uint8]]],
    workers: int = 2,
    most_waiting: int = 16,
) -> None:
    """Compress pictures in threads, with libdeflate in half of zlib's time, and store them in order.

    No more than ``most_waiting`` pictures wait for it, which bounds the memory of a stream of frames.
    """
    datasets = {
        name: group.create_dataset(
            name,
            (episode.frames, camera.height, camera.width, 3),
            np.uint8,
            chunks=(1, camera.height, camera.width, 3),
            compression="gzip",
            compression_opts=GZIP_LEVEL,
            track_times=False,
        )
        for name, camera in episode.cameras.items()
    }
    digests = {name: hashlib.sha256() for name in datasets}
    waiting: deque[tuple[str, int, Future[bytearray]]] = deque()

    def store(left: int) -> None:
        while len(waiting) > left:
            name, index, packed = waiting.popleft()
            datasets[name].id.write_direct_chunk((index, 0, 0, 0), packed.result())

    count = 0
    with ThreadPoolExecutor(workers) as pool:
        for count, pictures in enumerate(frames, start=1):
            _check_pictures(count - 1, pictures, episode)
            for name in datasets:
                data = np.ascontiguousarray(pictures[name]).tobytes()
                digests[name].update(data)
                waiting.append((name, count - 1, pool.submit(deflate.zlib_compress, data, GZIP_LEVEL)))
            store(most_waiting)
        store(0)
    for name, dataset in datasets.items():
        dataset.attrs[RECORDED] = digests[name].hexdigest()
    if count != episode.frames:
        raise ValueError(f"{count} frames were given for an episode of {episode.frames}")


def _check_pictures(index: int, pictures: Mapping[str, NDArray[Any]], episode: EpisodeData) -> None:
    if index >= episode.frames:
        raise ValueError(f"more than {episode.frames} frames were given")
    for name, camera in episode.cameras.items():
        picture = pictures.get(name)
        shape = (camera.height, camera.width, 3)
        if picture is None or picture.shape != shape or picture.dtype != np.uint8:
            found = "is missing" if picture is None else f"is {picture.shape} {picture.dtype}"
            raise ValueError(f"frame {index}: the picture of {name} {found}, expected {shape} uint8")
