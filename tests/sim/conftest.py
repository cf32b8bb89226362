"""Small objects made of boxes, and worlds with them; one rendered world serves all tests of a session."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from vcage.base.geometry import Pose
from vcage.schema.asset import PhysicalModel
from vcage.schema.robot import Robot
from vcage.schema.scene import SceneTemplate
from vcage.sim.bodies import Body
from vcage.sim.cameras import shoot
from vcage.sim.robots import load_robot, load_template
from vcage.sim.world import World

TABLE_TOP = 0.74


def boxes_model(
    folder: Path, name: str, boxes: list[np.ndarray], colour: tuple[int, int, int], mass: float
) -> PhysicalModel:
    """An object whose solid parts are ``boxes``, each (2, 3)."""
    parts = [trimesh.creation.box(bounds=bounds) for bounds in boxes]
    hulls = []
    for i, part in enumerate(parts):
        hulls.append(str(folder / f"{name}-{i}.obj"))
        part.export(hulls[-1])
    mesh = trimesh.util.concatenate(parts)
    mesh.visual = trimesh.visual.TextureVisuals(
        material=trimesh.visual.material.PBRMaterial(baseColorFactor=[*colour, 255])
    )
    visual = folder / f"{name}.glb"
    visual.write_bytes(mesh.export(file_type="glb"))
    lower, upper = ([float(x) for x in corner] for corner in mesh.bounds)
    return PhysicalModel(visual=str(visual), hulls=hulls, lower=lower, upper=upper, mass=mass, friction=1.0)


@pytest.fixture(scope="session")
def models(tmp_path_factory: pytest.TempPathFactory) -> dict[str, PhysicalModel]:
    """A 4 cm cube, a bar with a lug at +x, and an open tray."""
    folder = tmp_path_factory.mktemp("models")
    w, d, h, t = 0.1, 0.07, 0.05, 0.005
    tray = [
        [(-w, -d, 0), (w, d, t)],
        [(-w, -d, t), (-w + t, d, h)],
        [(w - t, -d, t), (w, d, h)],
        [(-w + t, -d, t), (w - t, -d + t, h)],
        [(-w + t, d - t, t), (w - t, d, h)],
    ]
    bar = [[(-0.06, -0.01, 0), (0.06, 0.01, 0.02)], [(0.04, 0.01, 0), (0.06, 0.03, 0.02)]]
    return {
        "cube": boxes_model(folder, "cube", [[(-0.02, -0.02, 0), (0.02, 0.02, 0.04)]], (200, 40, 30), 0.05),
        "bar": boxes_model(folder, "bar", bar, (30, 60, 200), 0.1),
        "tray": boxes_model(folder, "tray", tray, (190, 150, 90), 0.3),
    }


@pytest.fixture(scope="session")
def template() -> SceneTemplate:
    return load_template("table")


@pytest.fixture(scope="session")
def robot() -> Robot:
    return load_robot("dual_panda")


@pytest.fixture(scope="session")
def bodies(models: dict[str, PhysicalModel]) -> dict[str, Body]:
    """The three objects, at rest on the table, apart from each other."""
    return {
        "cube": Body(models["cube"], Pose.from_yaw([0.2, -0.05, TABLE_TOP], 0.3)),
        "tray": Body(models["tray"], Pose.from_yaw([0.0, 0.1, TABLE_TOP], 0.0)),
        "bar": Body(models["bar"], Pose.from_yaw([-0.25, -0.05, TABLE_TOP], 1.0)),
    }


@pytest.fixture
def world(template: SceneTemplate, bodies: dict[str, Body], robot: Robot) -> World:
    return World(template.table, bodies, robot)


@pytest.fixture(scope="session")
def rendered(template: SceneTemplate, bodies: dict[str, Body], robot: Robot) -> World:
    """A world that draws; tests put it into the state that they need."""
    world = World(template.table, bodies, robot, render=True)
    shoot(world, template.top_camera)
    return world
