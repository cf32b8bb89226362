"""Simulation of a recorded episode from the commands of its drives: bit for bit, on the same versions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from vcage.sim.drive_log import DriveLog
from vcage.sim.recording import StateLog
from vcage.sim.world import World


def resimulate(build: Callable[[], World], drives: DriveLog, fps: int, arms: Mapping[str, Sequence[float]]) -> StateLog:
    """The recording of the same episode.

    Args:
        build: makes the world of the episode's start.
        drives: the recorded commands.
        fps: frames per second of the recording.
        arms: start of an arm once all objects rest: offset of each joint from home, radians; home if not given.
    """
    world, log = build(), StateLog(fps)
    world.step(drives.settled)
    for name, offset in arms.items():
        world.arms[name].reset(offset)
    log.record(world)
    restarts = set(drives.restarts)
    for index in range(len(drives)):
        if world.steps in restarts:
            snapshot = world.snapshot()
            world = build()
            world.restore(snapshot)
            log.record(world)
        for name, rows in drives.rows.items():
            world.arms[name].drives = rows[index]
        world.step()
    return log
