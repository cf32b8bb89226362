"""Drawings of a hand's fingers as the camera that it carries sees them."""

from __future__ import annotations

import functools

import numpy as np

from vcage.base.time_limit import undisturbed
from vcage.schema.robot import Robot
from vcage.schema.scene import Table
from vcage.sim.appearance import Appearance
from vcage.sim.cameras import robot_cameras, take
from vcage.sim.drawer import Drawing, drawing_of, set_visible
from vcage.sim.world import World

OPENINGS = 15
"""Number of openings at which the fingers are drawn."""


def finger_drawings(robot: Robot, arm: str, camera: str) -> tuple[Drawing, ...]:
    """Fingers alone in studio light, at openings from closed to wide open, as large as the camera's pictures (H, W).

    They hold wherever the arm is, for a camera where the robot's file puts it.

    Args:
        robot: whose fingers they are.
        arm: name of the arm that has them.
        camera: name of a camera that the hand of this arm carries.

    Raises:
        NoRenderer: nothing here can draw.
    """
    return _drawn(robot.model_dump_json(), arm, camera)


@functools.lru_cache(maxsize=8)
@undisturbed()
def _drawn(robot_json: str, arm: str, camera: str) -> tuple[Drawing, ...]:
    robot = Robot.model_validate_json(robot_json)
    world = World(Table(), {}, robot, Appearance(shadows=False), render=True)
    control, seen = world.arms[arm], robot_cameras(world)[camera]
    for entity in world.scene.entities:
        set_visible(entity, entity in control.fingers)
    found = []
    for opening in np.linspace(0.0, 1.0, OPENINGS):
        control.put_fingers(float(opening))
        found.append(drawing_of(take(world, seen)))
    return tuple(found)
