from __future__ import annotations

import numpy as np
import trimesh

from vcage.base.geometry import Camera, Pose, look_at
from vcage.schema.scene import Table
from vcage.sim import bodies
from vcage.sim.appearance import Appearance
from vcage.sim.bodies import Body
from vcage.sim.cameras import shoot
from vcage.sim.render import SEEN
from vcage.sim.robots import load_robot
from vcage.sim.world import World

TABLE, LOOK = Table(), Appearance(light_direction=(0.0, 0.0, -1.0))
ABOVE = Camera(64, 48, 0.5, look_at([0, 0, 2.0], [0, 0, TABLE.height], up=(0, 1, 0)))  # sees nothing but the table


def shapes(world):
    return world.scene.render_system.render_bodies[0].render_shapes


def test_the_shape_that_throws_the_shadow_of_an_arm_is_invisible():
    empty = shoot(World(TABLE, {}, appearance=LOOK, render=True), ABOVE).astype(int)
    world = World(TABLE, {}, load_robot("dual_panda"), LOOK, render=True)
    for body in world.scene.render_system.render_bodies:
        for shape, node in zip(body.render_shapes, body._internal_node.children, strict=True):
            if shape.name == SEEN:
                node.transparency = 1.0
    darker = empty - shoot(world, ABOVE)
    assert darker.min() == 0 and darker[0, 0].max() == 0 and (darker.max(axis=2) > 20).mean() > 0.02


def test_the_visible_shapes_of_an_arm_throw_no_shadow():
    world = World(TABLE, {}, load_robot("dual_panda"), LOOK, render=True)
    for body in world.scene.render_system.render_bodies:
        names = [shape.name for shape in body.render_shapes]
        thrown = [node.cast_shadow for node in body._internal_node.children]
        assert thrown == [name != SEEN for name in names]
        assert SEEN not in names or any(thrown)


def test_an_object_of_many_triangles_throws_the_shadow_of_its_hulls(models, tmp_path, monkeypatch):
    cube = models["cube"]
    fine = trimesh.creation.box(np.array(cube.upper) - np.array(cube.lower)).subdivide().subdivide().subdivide()
    fine.export(tmp_path / "fine.glb")
    body = Body(cube.model_copy(update={"visual": str(tmp_path / "fine.glb")}), Pose([0, 0, TABLE.height + 0.05]))
    hulls = World(TABLE, {"cube": body}, appearance=LOOK, render=True)
    monkeypatch.setattr(bodies, "SHADOW_SAVING", np.inf)
    itself = World(TABLE, {"cube": body}, appearance=LOOK, render=True)
    assert len(shapes(itself)) == 1 and len(shapes(hulls)) == 1 + len(cube.hulls)
    assert np.abs(shoot(hulls, ABOVE).astype(int) - shoot(itself, ABOVE)).max() <= 2
