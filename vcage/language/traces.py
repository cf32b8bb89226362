"""Paths of the gripper and of the moved object over a sub-task, as pixels of a camera's picture."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from vcage.base.folders import natural_key
from vcage.datasets.episode import CameraTrack, Segment
from vcage.datasets.lerobot.episode import EventRow
from vcage.goals.parts import part_words
from vcage.language.observed import ObservedEpisode, pixels_of
from vcage.language.settings import SETTINGS
from vcage.schema.subtasks import Subtask


def traces(observed: ObservedEpisode, subtasks: Mapping[str, Subtask]) -> Iterator[EventRow]:
    """Yield the paths of each sub-task: the gripper's from its first frame, and the object's from when it moves.

    A path leads from the row's frame to the end of the sub-task, projected into the picture of that frame, so a moving
    camera does not distort it. Of a path that leaves the picture or passes behind the camera, the longest piece in
    the picture is kept; a path that hardly moves in it is left out. A frame has the path in one camera; the next camera
    takes the next frame.

    Args:
        observed: the episode.
        subtasks: id → sub-task, which names the object that moves.
    """
    cameras = sorted(observed.recorded.episode.cameras, key=natural_key)
    for segment in observed.recorded.episode.segments:
        begin = segment.start
        for label, path in _paths(observed, segment, subtasks.get(segment.subtask)):
            first = (
                begin
                if begin == segment.start
                else max(begin, segment.start + _onset(path[segment.start : segment.end]))
            )
            begin = first + len(cameras)
            yield from _rows(observed, label, path, cameras, range(first, segment.end))


def _paths(
    observed: ObservedEpisode, segment: Segment, subtask: Subtask | None
) -> Iterator[tuple[str, NDArray[np.float64]]]:
    """Yield the label and (T, 3) path, metres, of the gripper and of the object or part that the sub-task moves."""
    if segment.arm in observed.kinematics:
        label = "gripper" if len(observed.kinematics) == 1 else f"{segment.arm} gripper"
        yield label, observed.gripper_paths[segment.arm]
    if subtask is None:
        return
    part = next((goal.part for goal in subtask.goals if goal.kind.acts_on is not None), None)
    name = subtask.object if part is not None else subtask.grasped or subtask.object
    path = _part_path(observed, name, part, segment.contact)
    if np.linalg.norm(path[segment.start : segment.end] - path[segment.start], axis=1).max() > SETTINGS.moved_m:
        label = observed.names.label(name)
        yield label if part is None else f"{part_words(part)} of the {label}", path


def _part_path(observed: ObservedEpisode, name: str, part: str | None, contact: int) -> NDArray[np.float64]:
    """(T, 3) centre of an object in the world, metres, or the point at which a part of it is grasped."""
    asset = observed.things[name].asset
    point = asset.bounds_of(part).mean(axis=0)
    grasped = [one for one in asset.annotation.contact_points if one.id == contact and one.link == part]
    if part is not None and grasped:
        point = np.array(grasped[0].position)
    return np.array([observed.thing_at(name, frame).part_pose(part).apply(point) for frame in range(observed.frames)])


def _onset(path: NDArray[np.float64]) -> int:
    """Return the last frame of an (n, 3) path before it has moved far enough to count."""
    moved = np.linalg.norm(path - path[0], axis=1) > SETTINGS.moved_m
    return max(0, int(moved.argmax()) - 1)


def _rows(
    observed: ObservedEpisode, label: str, path: NDArray[np.float64], cameras: Sequence[str], frames: range
) -> Iterator[EventRow]:
    for camera, frame in zip(cameras, frames, strict=False):
        points = trace(observed.recorded.episode.cameras[camera], frame, path[frame : frames.stop])
        if len(points) > 1 and np.ptp(points, axis=0).max() >= SETTINGS.path_px:
            content = json.dumps({"label": label, "point_format": "xy", "points": points}, sort_keys=True)
            yield EventRow(frame, camera, "trace", "assistant", content)


def trace(camera: CameraTrack, frame: int, path: NDArray[np.float64]) -> list[list[int]]:
    """Return column and row of points of a path's longest piece in a camera's picture, evenly spaced in time.

    Args:
        camera: of the picture.
        frame: of the picture.
        path: (n, 3) in the world, metres.
    """
    chosen = np.unique(np.linspace(0, len(path) - 1, SETTINGS.path_points).round().astype(int))
    pixels = pixels_of(camera, frame, path[chosen])
    within = np.all((pixels >= 0) & (pixels < [camera.width, camera.height]), axis=1)  # false for NaN
    pieces = [[*group] for inside, group in groupby(range(len(chosen)), key=lambda i: bool(within[i])) if inside]
    if not pieces:
        return []
    longest = max(pieces, key=lambda piece: float(np.linalg.norm(np.diff(pixels[piece], axis=0), axis=1).sum()))
    points = np.floor(pixels[longest]).astype(int).tolist()
    return [point for number, point in enumerate(points) if number == 0 or point != points[number - 1]]
