"""What decimating the robot's visual meshes is worth: milliseconds for a frame of a full scene."""

from __future__ import annotations

import statistics
import time

import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.objects.library import Library
from vcage.schema.robot import Robot
from vcage.sim.bodies import Body
from vcage.sim.cameras import robot_cameras, shoot
from vcage.sim.robots import load_robot, load_template
from vcage.sim.world import World

OBJECTS = 8


def run(quick: bool) -> dict[str, float]:
    """Median wall time of a 320×240 frame of ``cam_high``, original and decimated meshes by turns.

    Args:
        quick: fewer frames.
    """
    robot = load_robot("dual_panda")
    original = _full_world(robot.model_copy(update={"visual_faces": 1.0}))
    decimated = _full_world(robot)
    camera = robot_cameras(decimated)["cam_high"]
    for world in (original, decimated):
        shoot(world, camera)  # shaders and meshes are loaded with the first picture
    times: dict[str, list[float]] = {"original": [], "decimated": []}
    for i in range(8 if quick else 40):
        times["original"].append(_milliseconds(original, camera, i))
        times["decimated"].append(_milliseconds(decimated, camera, i))
    before, after = (statistics.median(times[key]) for key in ("original", "decimated"))
    return {"ms_original": round(before, 2), "ms_decimated": round(after, 2), "ratio": round(before / after, 2)}


def _full_world(robot: Robot) -> World:
    """Both arms and :data:`OBJECTS` objects of the library on the table."""
    library = Library.load()
    names = library.names[:OBJECTS]
    places = [(x, y) for y in (-0.12, 0.1) for x in np.linspace(-0.4, 0.4, OBJECTS // 2)]
    table = load_template("table").table
    bodies = {
        name: Body(library.asset(name).model, Pose([x, y, table.height]))
        for name, (x, y) in zip(names, places, strict=True)
    }
    return World(table, bodies, robot, render=True)


def _milliseconds(world: World, camera: Camera, frame: int) -> float:
    """Time to move an arm a little and take a picture, as a replay does."""
    arm = next(iter(world.arms.values()))
    joints = arm.articulation.get_qpos()
    joints[0] = 0.01 * frame
    start = time.perf_counter()
    arm.articulation.set_qpos(joints)
    shoot(world, camera)
    return 1000 * (time.perf_counter() - start)
