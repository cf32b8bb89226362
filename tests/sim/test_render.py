"""The light of ``assets/shaders``, against its formulas in plain numbers."""

from __future__ import annotations

import numpy as np
import pytest
import sapien

from vcage.base.geometry import Camera, look_at
from vcage.schema.scene import Table
from vcage.sim.appearance import Appearance
from vcage.sim.cameras import observe, shoot
from vcage.sim.world import World

TABLE = Table()


def srgb(light: np.ndarray) -> np.ndarray:
    return 255 * np.clip(light, 0, 1) ** (1 / 2.2)


def upward_light(look: Appearance, to_camera: np.ndarray, material: sapien.render.RenderMaterial) -> np.ndarray:
    """(3,) linear RGB that a surface which faces up sends to the camera."""
    base, metallic, roughness = np.array(material.base_color[:3]), material.metallic, material.roughness
    to_light = -np.array(look.light_direction) / np.linalg.norm(look.light_direction)
    between = (to_light + to_camera) / np.linalg.norm(to_light + to_camera)
    alpha2, k = roughness**4, (roughness + 1) ** 2 / 8
    spread = (between[2] ** 2 * (alpha2 - 1) + 1) ** 2
    hidden = (to_light[2] * (1 - k) + k) * (to_camera[2] * (1 - k) + k)
    tilt = to_camera @ between
    straight = 0.08 * material.specular * (1 - metallic) + base * metallic
    fresnel = straight + (1 - straight) * 2 ** ((-5.55473 * tilt - 6.98316) * tilt)
    shine = fresnel * alpha2 / (4 * np.pi * spread * hidden)
    return np.array(look.ambient) * base + np.array(look.light_colour) * to_light[2] * (
        base * (1 - metallic) / np.pi + shine
    )


def table_top(world: World) -> sapien.render.RenderMaterial:
    shown = [entity.find_component_by_type(sapien.render.RenderBodyComponent) for entity in world.scene.entities]
    names = [entity.name for entity in world.scene.entities]
    body = next(body for body, name in zip(shown, names, strict=True) if body is not None and name == "table")
    return body.render_shapes[0].parts[0].material


@pytest.mark.parametrize("eye", [(0.0, 0.3, 1.0), (0.4, 0.7, 0.4)])
@pytest.mark.parametrize(("metallic", "roughness", "specular"), [(0, 0.7, 0), (0, 0.3, 0.5), (1, 0.5, 0.5), (1, 1, 0)])
def test_a_surface_in_the_light_is_as_bright_as_the_model_of_light_says(metallic, roughness, specular, eye):
    look = Appearance(shadows=False)
    world = World(TABLE, {}, appearance=look, render=True)
    material = table_top(world)
    material.metallic, material.roughness, material.specular = metallic, roughness, specular
    point = np.array([0.0, 0.0, TABLE.height])
    expected = srgb(upward_light(look, np.array(eye) / np.linalg.norm(eye), material))
    picture = shoot(world, Camera(33, 33, 0.01, look_at(point + eye, point)))
    assert picture[16, 16] == pytest.approx(expected, abs=1.0)


def test_a_shadow_has_the_ambient_light_alone():
    look = Appearance(light_direction=(0.0, 0.0, -1.0))
    camera = Camera(33, 33, 0.3, look_at([1.2, -1.2, 0.3], [0, 0, 0], up=(0, 0, 1)))  # the floor below the table
    picture = shoot(World(TABLE, {}, appearance=look, render=True), camera)
    assert picture[16, 16] == pytest.approx(srgb(np.array(look.ambient) * look.floor_colour), abs=1.0)


def test_a_shadow_grows_light_towards_its_edge_and_nowhere_else():
    look = Appearance(light_direction=(0.0, 0.0, -1.0))
    world = World(TABLE, {}, appearance=look, render=True)
    edge = TABLE.centre[0] + TABLE.size[0] / 2
    camera = Camera(101, 5, 0.01, look_at([edge, 0, 0.4], [edge, 0, 0], up=(0, 1, 0)))
    brightness = shoot(world, camera)[2].mean(axis=1)
    assert (np.diff(brightness) >= 0).all() and len(np.unique(brightness)) > 5


def test_the_sky_is_as_bright_as_the_light_from_everywhere():
    look = Appearance()
    camera = Camera(16, 12, 0.5, look_at([0, 0, 2], [0, 0.1, 3]))
    shot = observe(World(TABLE, {}, appearance=look, render=True), camera)
    assert np.isinf(shot.depth).all() and not shot.segmentation.any()
    assert np.abs(shot.picture - srgb(np.array(look.ambient))).max() <= 0.5
