"""The clips of the compression benchmark: the cameras of the rendered episodes, and some as real cameras see them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from benchmarks._compression_episodes import RECIPES, SPARSE_FPS, Recipe, episode_path
from benchmarks._compression_noise import RealCamera
from vcage.datasets.reader import EpisodeReader
from vcage.video.keyframes import keyframes
from vcage.video.search import held_out_frames

Kind = Literal["rendered", "sparse", "noisy"]

HIGH, LEFT, RIGHT = "cam_high", "cam_left_wrist", "cam_right_wrist"
"""The camera that stands above the table, and those on the wrists, which move."""

VIEWS = (HIGH, RIGHT, RIGHT, HIGH, LEFT, LEFT, RIGHT, HIGH, HIGH, RIGHT, LEFT, HIGH)
"""Camera of each episode's rendered clip: that above the table, or on a wrist of the arm that does more."""

UNSEEN = 7
"""Step of the held-out frames; another than the search has, and none of those that its guard has seen."""

SPARSE = (0, 2, 4, 5)
"""Numbers of the episodes of which there is a clip with few frames per second as well."""

QUICK_FRAMES = 48

WELL_LIT, DIM = 6000.0, 1500.0
"""Electrons of a white pixel, of a small sensor indoors."""

NOISY = ((2, HIGH, WELL_LIT), (3, LEFT, DIM), (8, RIGHT, WELL_LIT), (10, HIGH, DIM))
"""Number of the episode, camera and light of the clips that real cameras record."""


@dataclass(frozen=True)
class Film:
    """A clip in memory.

    Args:
        frames: (T, H, W, 3) uint8 RGB.
        fps: frames per second.
        keyframes: indices of the frames on which the search judges, increasing.
        held_out: indices of the other frames that are scored, increasing.
    """

    frames: NDArray[np.uint8]
    fps: float
    keyframes: list[int]
    held_out: list[int]


@dataclass(frozen=True)
class Clip:
    """One camera of one episode.

    Args:
        recipe: of the episode.
        camera: name of the robot's camera.
        sensor: what records the pictures in place of the renderer; None for the renders themselves.
        length: only so many frames from the start; None for all.
    """

    recipe: Recipe
    camera: str
    sensor: RealCamera | None = None
    length: int | None = None

    @property
    def kind(self) -> Kind:
        if self.sensor is not None:
            return "noisy"
        return "sparse" if self.recipe.fps == SPARSE_FPS else "rendered"

    @property
    def name(self) -> str:
        short = "" if self.length is None else f"-{self.length}"
        return f"{self.kind}-{self.recipe.name}-{self.camera}{short}"

    def load(self) -> Film:
        """Its pictures, the episode being made where it is not in the cache.

        Raises:
            NoRenderer: nothing here can draw.
            DamagedFile: the episode in the cache is broken.
        """
        with EpisodeReader(episode_path(self.recipe)) as reader:
            episode = reader.episode
            frames = reader.images(self.camera)[: self.length]
        if self.sensor is not None:
            frames = self.sensor.film(frames)
        seen = keyframes(episode.action[: self.length], episode.grippers)
        guarded = held_out_frames(len(frames), seen)
        return Film(frames, episode.fps, seen, held_out_frames(len(frames), [*seen, *guarded], UNSEEN))


def clips(quick: bool) -> list[Clip]:
    """The rendered clips, one of each episode (:data:`VIEWS`), some at few frames per second (:data:`SPARSE`), and the
    noisy ones (:data:`NOISY`).

    Args:
        quick: the beginnings of two rendered clips, one of them of a moving camera.
    """
    length = QUICK_FRAMES if quick else None
    rendered = [Clip(recipe, camera, length=length) for recipe, camera in zip(RECIPES, VIEWS, strict=True)]
    if quick:
        return rendered[:2]
    sparse = [Clip(replace(RECIPES[i], fps=SPARSE_FPS), VIEWS[i]) for i in SPARSE]
    return rendered + sparse + [Clip(RECIPES[i], camera, RealCamera(light, seed=i)) for i, camera, light in NOISY]
