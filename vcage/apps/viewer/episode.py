"""An episode of ours with everything that is inside it."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import numpy as np

from vcage.apps.viewer.arms import log_robot
from vcage.apps.viewer.blueprint import ABOUT, Contents
from vcage.apps.viewer.footage import compressed_videos, log_pictures, log_video
from vcage.apps.viewer.log import Clock, Journal, entity
from vcage.apps.viewer.marks import log_segments
from vcage.apps.viewer.motion import log_joints, log_parts
from vcage.apps.viewer.objects import WORLD, log_objects, log_table
from vcage.apps.viewer.sdk import rr
from vcage.apps.viewer.summary import about_episode
from vcage.base.geometry import Pose
from vcage.base.progress import Progress
from vcage.datasets.episode import CameraTrack, EpisodeData
from vcage.datasets.reader import EpisodeReader
from vcage.schema.scene import Scene

Footage = Literal["stored", "compressed", "none"]
"""Which pictures: those in the episode, the videos that ``compress`` made of them, or none."""

IMAGE_PLANE = 0.1
"""How far from a camera its picture is drawn in the 3D scene, metres."""


def log_episode(journal: Journal, path: Path, footage: Footage, progress: Progress) -> Contents:
    """Write an episode file into a Rerun recording.

    Raises:
        MissingStage, DamagedFile, SchemaMismatch: see :class:`vcage.datasets.reader.EpisodeReader` and
            :func:`vcage.apps.viewer.footage.compressed_videos`.
    """
    with EpisodeReader(path) as reader:
        episode = reader.episode
        clock = Clock(np.arange(episode.frames), episode.timestamp)
        journal.always(ABOUT, about_episode(path, episode))
        _log_scene(journal, clock, episode, path)
        plots = [
            *log_segments(journal, clock, episode),
            *log_joints(journal, clock, episode),
            *log_parts(journal, clock, episode),
        ]
        cameras = _log_cameras(journal, clock, episode)
        if footage != "none":
            _log_footage(journal, clock, cameras, reader, footage, progress)
    shown = {} if footage == "none" else cameras
    return Contents(episode.frames, shown, plots, scene=True, segments=len(episode.segments))


def _log_scene(journal: Journal, clock: Clock, episode: EpisodeData, path: Path) -> None:
    scene = _scene(episode, path)
    journal.always(WORLD, rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    if scene is not None:
        log_table(journal, scene.table)
    log_objects(journal, clock, episode, scene)
    log_robot(journal, clock, episode, str(episode.meta["robot"]))


def _scene(episode: EpisodeData, path: Path) -> Scene | None:
    """The scene that travels in the episode, if it is one of ours."""
    data = episode.meta.get("scene")
    ours = isinstance(data, dict) and data.get("schema") == Scene.SCHEMA
    return Scene.parse(data, path) if ours else None


def _log_cameras(journal: Journal, clock: Clock, episode: EpisodeData) -> dict[str, str]:
    """Camera → entity, with its lens and its way through the scene."""
    entities = {}
    for name, camera in episode.cameras.items():
        where = entities[name] = entity(WORLD, "cameras", name)
        journal.always(where, _lens(camera))
        journal.path(where, clock, [Pose.from_matrix(matrix).inverse() for matrix in camera.extrinsics])
    return entities


def _lens(camera: CameraTrack) -> rr.Pinhole:
    return rr.Pinhole(
        image_from_camera=camera.intrinsics,
        resolution=[camera.width, camera.height],
        camera_xyz=rr.ViewCoordinates.RDF,
        image_plane_distance=IMAGE_PLANE,
    )


def _log_footage(
    journal: Journal, clock: Clock, cameras: dict[str, str], reader: EpisodeReader, footage: Footage, progress: Progress
) -> None:
    videos = compressed_videos(reader.path) if footage == "compressed" else {}
    for number, (name, where) in enumerate(cameras.items()):
        progress(name, number, len(cameras))
        if name in videos:
            log_video(journal, where, clock, videos[name])
        else:
            log_pictures(journal, where, clock, reader.images(name).__getitem__)
