"""Rendering of a recorded episode in any appearance: states are set, never stepped."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Camera
from vcage.sim.cameras import robot_cameras, shoot
from vcage.sim.recording import StateLog
from vcage.sim.state import WorldState
from vcage.sim.world import World


@dataclass(frozen=True)
class RenderedFrame:
    """The pictures of one moment.

    Args:
        pictures: (H, W, 3) uint8 by camera name.
        cameras: with their poses at that moment.
    """

    pictures: dict[str, np.ndarray]
    cameras: dict[str, Camera]


def render_state(world: World, state: WorldState, names: Sequence[str] | None = None) -> RenderedFrame:
    """Show a state in a rendered world and take the pictures of the robot's cameras (all, or those named).

    Args:
        world: made with ``render=True``.
        state: of the same objects and robot.
        names: of the cameras; all when not given.
    """
    world.set_state(state)
    cameras = {name: camera for name, camera in robot_cameras(world).items() if names is None or name in names}
    return RenderedFrame({name: shoot(world, camera) for name, camera in cameras.items()}, cameras)


def render_log(world: World, log: StateLog, names: Sequence[str] | None = None) -> Iterator[RenderedFrame]:
    """The frames of a log, in order, each with the pictures of the robot's cameras.

    Args:
        world: made with ``render=True`` from the same objects and robot as the recorded one.
        names: of the cameras; all of the robot's when not given.
    """
    for frame in log.frames:
        yield render_state(world, frame.world_state(), names)


def camera_paths(world: World, states: Iterable[WorldState]) -> dict[str, list[Camera]]:
    """The robot's cameras with their poses in each state, without drawing; any world with the same robot serves."""
    paths: dict[str, list[Camera]] = {}
    for state in states:
        world.set_state(state)
        for name, camera in robot_cameras(world).items():
            paths.setdefault(name, []).append(camera)
    return paths
