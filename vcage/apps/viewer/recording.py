"""A recording of others: what its cameras saw, and what is known of its robot."""

from __future__ import annotations

from functools import partial

from vcage.apps.viewer.blueprint import ABOUT, Contents
from vcage.apps.viewer.footage import log_pictures
from vcage.apps.viewer.log import Clock, Journal, entity
from vcage.apps.viewer.motion import log_motion
from vcage.apps.viewer.summary import about_recording
from vcage.base.progress import Progress
from vcage.datasets.recordings.recording import Recording

CAMERAS = "cameras"


def log_recording(
    journal: Journal, recording: Recording, fps: float | None, pictures: bool, progress: Progress
) -> Contents:
    """Write a recording into one of Rerun's.

    Args:
        fps: frames per second, for a recording that does not say; without, it has no times but only frames.
        pictures: whether to write these too.

    Raises:
        DamagedFile: a picture or a number cannot be read.
    """
    cameras = recording.cameras
    clock = Clock.steady(recording.frames, recording.fps or fps)
    plots = log_motion(journal, clock, recording)
    shown: dict[str, str] = {}
    for number, camera in enumerate(cameras if pictures else []):
        progress(camera.name, number, len(cameras))
        where = shown[camera.name] = entity(CAMERAS, camera.name)
        log_pictures(journal, where, clock.at(range(camera.frames)), partial(recording.pictures, camera.name))
    journal.always(ABOUT, about_recording(recording, clock))
    return Contents(recording.frames, shown, plots)
