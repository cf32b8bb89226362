"""The setting of an episode: its world, its critic, and the response to a failure."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from vcage.schema.episodes import Accept, Verdict
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Subtask
from vcage.sim.state import WorldState
from vcage.sim.world import World
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.slots import Slot
from vcage.tasks.task import Asked

OnFailure = Literal["resample", "abort"]

PicturesByCamera = Mapping[str, np.ndarray]
"""Camera name → (H, W, 3) uint8."""

Seen = Mapping[str, PicturesByCamera]
"""Pictures ``before`` and ``after`` a sub-task, at the ``moment`` that tells most, of wiping and shaking at a
``later`` one too, and, where something is put back, of the ``start`` of the episode."""


@dataclass(frozen=True)
class Setting:
    """The world, the critic and the rules of an episode.

    Args:
        build: makes the world of the episode's start, robot at home, physics only.
        objects: by id, with their geometry.
        slots: id of a sub-task → where it puts its object.
        photograph: pictures of a state for a sub-task with some goals; at the moment also from an arm's wrist.
        judge: the critic's verdict on a question about a sub-task and the pictures.
        accept: the judges whose yes a sub-task needs.
        on_failure: the response to a failed sub-task.
        retries: further attempts per sub-task, when resampling.
        fps: frames per second of the recording.
        start: arm → offset of each joint from home at the start of the episode, radians; at home where not given.
    """

    build: Callable[[], World]
    objects: Mapping[str, SceneObject]
    slots: Mapping[str, Slot]
    photograph: Callable[[WorldState, Sequence[Goal], str | None], PicturesByCamera]
    judge: Callable[[Asked, Subtask, Seen], Verdict]
    accept: Accept
    on_failure: OnFailure
    retries: int
    fps: int
    start: Mapping[str, Sequence[float]] = field(default_factory=dict)


def begin(world: World, offsets: Mapping[str, Sequence[float]]) -> WorldState:
    """Let a new world come to rest and put its arms where the episode begins; the state before they leave home.

    Args:
        world: of the start of an episode, the robot at home.
        offsets: arm → offset of each joint from home, radians; at home where not given.
    """
    world.settle()
    rested = world.state()
    for name, offset in offsets.items():
        world.arms[name].reset(offset)
    return rested
