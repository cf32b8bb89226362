"""Pictures of verdicts as collect stores them: attempt, moment and camera are read from their names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from vcage.base.errors import InputFileError
from vcage.base.files import RunFolder
from vcage.base.pictures import read_picture
from vcage.episodes.question import TOP
from vcage.episodes.store import background_name
from vcage.schema.episodes import Episodes
from vcage.schema.scene import Scene
from vcage.tasks.setting import Seen

_NAMED = re.compile(r"-(before|after|moment|start)-(\w+)\.png$")
"""Names of the pictures of a verdict: moment and camera."""


def by_moment(pictures: Sequence[Path], scene: Scene) -> Seen:
    """Read pictures by the moment and camera in their names.

    Raises:
        InputFileError: one cannot be read, has another kind of name, or has not the size of the top camera.
    """
    found: dict[str, dict[str, np.ndarray]] = {}
    for path in pictures:
        named = _NAMED.search(path.name)
        if named is None:
            raise InputFileError(
                f"{path} is not named as collect names the pictures of a verdict: field pictures",
                hint="put back what was written",
                maker="collect",
            )
        when, camera = named.groups()
        found.setdefault(when, {})[camera] = top_view(path, scene) if camera == TOP else read_picture(path)
    return found


def of_same_attempt(picture: Path) -> list[Path]:
    """Return all stored pictures of the same attempt; none if the name is not one of collect's."""
    named = _NAMED.search(picture.name)
    return sorted(picture.parent.glob(f"{picture.name[: named.start()]}-*.png")) if named else []


def scene_of(picture: Path, run: RunFolder) -> Scene:
    """Return the scene of the episode in a picture's name (``e000002-s0-…``), else the scene of the run."""
    scene, named = Scene.read(run.layout), re.match(r"e(\d+)-", picture.name)
    if named is None or not run.episodes.exists():
        return scene
    return next((e.scene(scene) for e in Episodes.read(run.episodes).episodes if e.index == int(named[1])), scene)


def empty_table_of(picture: Path, scene: Scene) -> np.ndarray | None:
    """Return the empty table in the light of a picture's episode; None if it is not stored."""
    episode = re.match(r"e(\d+)-", picture.name)
    empty = picture.parent.parent / background_name(int(episode[1])) if episode else picture
    return top_view(empty, scene) if episode and empty.exists() else None


def top_view(path: Path, scene: Scene) -> np.ndarray:
    """Read a picture of the scene's top camera: (H, W, 3) uint8 RGB."""
    picture, camera = read_picture(path), scene.top_camera
    height, width = picture.shape[:2]
    if (width, height) != (camera.width, camera.height):
        raise InputFileError(
            f"{path} is {width} x {height}, the run's top camera takes {camera.width} x {camera.height}",
            hint="give pictures as collect keeps them in episodes/critic",
        )
    return picture
