"""The table and its surroundings: floor, back wall, pedestals of the arms, and light."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vcage.objects.surface_pictures import SIDE
from vcage.schema.robot import Robot
from vcage.schema.scene import Table
from vcage.sim.appearance import Appearance, LinearColour
from vcage.sim.render import painted_material, plain_material

if TYPE_CHECKING:
    import sapien

THICKNESS = 0.04
"""Thickness of the table top, metres."""


@dataclass(frozen=True)
class RoomSettings:
    """Sizes of the surroundings.

    Args:
        table_friction: Coulomb coefficient of the table top.
        leg_half_m: half the width of a table leg.
        pedestal_half_m: half the width of the pedestal of an arm.
        floor_m: side of the floor and width of the wall.
        wall_behind_m: distance of the back wall from the table's centre; its shadow does not reach the table.
        wall_height_m: height of the wall.
        shadow_half_m: half the side of the square around the table that the shadow map covers.
        shadow_texels: of the shadow map along a side, 4.9 mm each. The shaders average three by three.
    """

    table_friction: float = 0.8
    leg_half_m: float = 0.025
    pedestal_half_m: float = 0.11
    floor_m: float = 10.0
    wall_behind_m: float = 2.5
    wall_height_m: float = 3.0
    shadow_half_m: float = 1.25
    shadow_texels: int = 512


ROOM = RoomSettings()


def add_table(scene: sapien.Scene, table: Table) -> None:
    """Add the solid, invisible table top."""
    import sapien

    component = sapien.physx.PhysxRigidStaticComponent()
    half = [table.size[0] / 2, table.size[1] / 2, THICKNESS / 2]
    material = sapien.physx.PhysxMaterial(ROOM.table_friction, ROOM.table_friction, 0.0)
    component.attach(sapien.physx.PhysxCollisionShapeBox(half, material))
    entity = sapien.Entity()
    entity.name = "table"
    entity.add_component(component)
    entity.pose = sapien.Pose([*table.centre, table.height - THICKNESS / 2])
    scene.add_entity(entity)


def add_surroundings(scene: sapien.Scene, table: Table, robot: Robot | None, appearance: Appearance) -> None:
    """Add all visible surroundings: table, floor, wall, pedestals, light.

    Args:
        scene: SAPIEN's, with a render system.
        table: its size and place.
        robot: whose arms need pedestals.
        appearance: colours, textures and light.
    """
    _add_visuals(scene, "table", _table_shapes(table, appearance))
    _add_visuals(scene, "room", _room_shapes(table, appearance))
    if robot is not None:
        _add_visuals(scene, "pedestals", _pedestal_shapes(robot))
    scene.set_ambient_light(list(appearance.ambient))
    scene.add_directional_light(
        list(appearance.light_direction),
        list(appearance.light_colour),
        shadow=appearance.shadows,
        position=[0.0, 0.0, table.height],
        shadow_scale=ROOM.shadow_half_m,
        shadow_near=-1.6,
        shadow_far=3.0,
        shadow_map_size=ROOM.shadow_texels,
    )
    for direction, colour in appearance.further_lights:
        scene.add_directional_light(list(direction), list(colour))


def _add_visuals(scene: sapien.Scene, name: str, shapes: list[sapien.render.RenderShape]) -> None:
    import sapien

    component = sapien.render.RenderBodyComponent()
    for shape in shapes:
        component.attach(shape)
    entity = sapien.Entity()
    entity.name = name
    entity.add_component(component)
    scene.add_entity(entity)


def _table_shapes(table: Table, appearance: Appearance) -> list[sapien.render.RenderShape]:
    (cx, cy), (w, d), top = table.centre, table.size, table.height
    edge = plain_material(_edge_colour(appearance))
    surface = _material(appearance.table_texture, appearance.table_colour, 0.7)
    shapes = [
        _rectangle([cx - w / 2, cy - d / 2, top], [w, 0, 0], [0, d, 0], surface),
        _box([cx, cy, top - THICKNESS / 2 - 0.001], [w / 2, d / 2, THICKNESS / 2 - 0.001], edge),
    ]
    legs, half = top - THICKNESS, ROOM.leg_half_m
    for x in (cx - w / 2 + 2 * half, cx + w / 2 - 2 * half):
        for y in (cy - d / 2 + 2 * half, cy + d / 2 - 2 * half):
            shapes.append(_box([x, y, legs / 2], [half, half, legs / 2], edge))
    return shapes


def _edge_colour(appearance: Appearance) -> list[float]:
    """The mean colour of the top, a little darker."""
    if appearance.table_texture is None:
        return [0.7 * c for c in appearance.table_colour]
    srgb = appearance.table_texture.reshape(-1, 3).mean(axis=0) / 255
    return [float(0.7 * c) for c in srgb**2.2]


def _room_shapes(table: Table, appearance: Appearance) -> list[sapien.render.RenderShape]:
    (cx, cy), size, height = table.centre, ROOM.floor_m, ROOM.wall_height_m
    floor = _material(appearance.floor_texture, appearance.floor_colour)
    wall = _material(appearance.wall_texture, appearance.wall_colour)
    behind = cy + ROOM.wall_behind_m
    return [
        _rectangle([cx - size / 2, behind - size, 0], [size, 0, 0], [0, size, 0], floor, (size / SIDE, size / SIDE)),
        _rectangle([cx - size / 2, behind, 0], [size, 0, 0], [0, 0, height], wall, (size / SIDE, height / SIDE)),
    ]


def _material(picture: np.ndarray | None, colour: LinearColour, roughness: float = 0.8) -> sapien.render.RenderMaterial:
    return plain_material(colour, roughness) if picture is None else painted_material(picture)


def _pedestal_shapes(robot: Robot) -> list[sapien.render.RenderShape]:
    dark = plain_material((0.05, 0.05, 0.055), roughness=0.5)
    shapes = []
    for arm in robot.arms.values():
        x, y, z = arm.base.position
        if z > 0.05:
            shapes.append(_box([x, y, z / 2], [ROOM.pedestal_half_m, ROOM.pedestal_half_m, z / 2], dark))
    return shapes


def _box(
    centre: list[float], half_size: list[float], material: sapien.render.RenderMaterial
) -> sapien.render.RenderShape:
    import sapien

    shape = sapien.render.RenderShapeBox(half_size, material)
    shape.local_pose = sapien.Pose(centre)
    return shape


def _rectangle(
    corner: list[float],
    u: list[float],
    v: list[float],
    material: sapien.render.RenderMaterial,
    times: tuple[float, float] = (1.0, 1.0),
) -> sapien.render.RenderShape:
    """The parallelogram from ``corner`` along ``u`` and ``v``, facing u × v; ``u`` is the picture's bottom edge.

    The picture is repeated ``times`` along each.
    """
    import sapien

    start, right, up = (np.asarray(x, dtype=np.float32) for x in (corner, u, v))
    normal = np.cross(right, up) / np.linalg.norm(np.cross(right, up))
    return sapien.render.RenderShapeTriangleMesh(
        vertices=np.stack([start, start + right, start + right + up, start + up]),
        triangles=np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32),
        normals=np.repeat(normal[None], 4, axis=0),
        uvs=np.array([[0, 1], [1, 1], [1, 0], [0, 0]], dtype=np.float32) * np.array(times, dtype=np.float32),
        material=material,
    )
