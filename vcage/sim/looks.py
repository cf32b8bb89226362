"""Looks of episodes: sampled from ranges, and turned into appearances. The same record gives the same pictures."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from vcage.objects.colour_words import COLOUR_WORDS
from vcage.objects.surface_pictures import surface_picture
from vcage.schema.asset import PhysicalModel
from vcage.schema.base import Vec3
from vcage.schema.randomisation import (
    CameraRanges,
    CameraShift,
    ColourRanges,
    Light,
    LightRanges,
    Look,
    LookRanges,
    Surface,
    SurfaceRanges,
    Tint,
    Where,
)
from vcage.schema.robot import Robot, RobotCamera
from vcage.schema.scene import Scene
from vcage.sim.appearance import Appearance
from vcage.sim.cameras import placed
from vcage.sim.tints import HALVINGS, colours_of, truthful, weaker
from vcage.sim.world import World

UNNAMED_COLOUR_TINT = 0.25
"""Share of a tint for an object whose name has no colour: an apple keeps an apple's colours."""


def draw_look(
    ranges: LookRanges,
    scene: Scene,
    models: Mapping[str, PhysicalModel],
    robot: Robot,
    rng: np.random.Generator,
) -> Look:
    """Sample the look of one episode.

    Args:
        ranges: of all values.
        scene: with clutter.
        models: by object id.
        robot: its cameras are shifted.
        rng: source of every choice.

    Raises:
        UnknownName: a texture of the ranges does not exist.
    """
    lights, ambient = _lights(ranges.light, rng)
    return Look(
        lights=lights,
        ambient=ambient,
        surfaces=_surfaces(ranges.surfaces, scene.table.texture, rng),
        cameras=_cameras(ranges.cameras, scene, robot, rng),
        tints=_tints(ranges.colours, scene, models, rng),
    )


def _lights(ranges: LightRanges, rng: np.random.Generator) -> tuple[list[Light], Vec3]:
    warmth = rng.uniform(*ranges.warmth)
    strength, level = rng.uniform(*ranges.strength), rng.uniform(*ranges.ambient)
    lights = []
    for number in range(int(rng.integers(ranges.number[0], ranges.number[1] + 1))):
        heading, slant = np.radians(rng.uniform(*ranges.heading_deg)), rng.uniform(*ranges.slant)
        direction = np.array([slant * np.cos(heading), slant * np.sin(heading), -1.0])
        own = warmth if number == 0 else rng.uniform(*ranges.warmth)
        share = 1.0 if number == 0 else rng.uniform(*ranges.others)
        lights.append(
            Light(
                direction=_triple(direction / np.linalg.norm(direction)),
                colour=_triple(strength * share * np.array([1 + own, 1.0, 1 - own])),
                shadows=number == 0 and bool(rng.random() < ranges.shadows),
            )
        )
    return lights, _triple(level * np.array([1 + warmth / 3, 1.0, 1 - warmth / 3]))


def _surfaces(ranges: SurfaceRanges, own_table: str, rng: np.random.Generator) -> dict[Where, Surface]:
    table = Surface(texture=_one_of(ranges.table, rng) or own_table, colour=(1.0, 1.0, 1.0))
    room: dict[Where, Surface] = {}
    sides: tuple[tuple[Where, list[str], tuple[float, float]], ...] = (
        ("wall", ranges.wall, ranges.wall_tone),
        ("floor", ranges.floor, ranges.floor_tone),
    )
    for name, names, tone in sides:
        texture, grey, tint = _one_of(names, rng), rng.uniform(*tone), rng.uniform(*ranges.tint, size=3)
        room[name] = Surface(texture=texture, colour=_triple(tint if texture else grey * tint))
    return {"table": table, **room}


def _cameras(ranges: CameraRanges, scene: Scene, robot: Robot, rng: np.random.Generator) -> dict[str, CameraShift]:
    if ranges == CameraRanges():
        return {}
    objects = np.array([o.aabb for o in scene.objects]).reshape(-1, 2, 3).mean(axis=1)
    found = {}
    for name, camera in sorted(robot.cameras.items()):
        shift = rng.uniform(-ranges.shift, ranges.shift, 3)
        turn = rng.uniform(-ranges.turn_deg, ranges.turn_deg, 3)
        drawn = CameraShift(shift=_triple(shift), turn_deg=_triple(turn), fovy=float(rng.uniform(*ranges.fovy)))
        found[name] = _losing_none(drawn, camera, objects) if camera.arm is None else drawn
    return found


def _losing_none(drawn: CameraShift, camera: RobotCamera, objects: np.ndarray) -> CameraShift:
    """The shift, or the largest half, quarter, … of it under which a camera loses no visible object middle (n, 3).

    No shift at all if each of these loses one.
    """
    seen = objects[placed(camera).sees(objects)]
    for number in range(HALVINGS):
        share = 0.5**number
        less = CameraShift(
            shift=_triple(share * np.array(drawn.shift)),
            turn_deg=_triple(share * np.array(drawn.turn_deg)),
            fovy=1 + share * (drawn.fovy - 1),
        )
        if placed(camera, less).sees(seen).all():
            return less
    return CameraShift(shift=(0.0, 0.0, 0.0), turn_deg=(0.0, 0.0, 0.0), fovy=1.0)


def _tints(
    ranges: ColourRanges, scene: Scene, models: Mapping[str, PhysicalModel], rng: np.random.Generator
) -> dict[str, Tint]:
    if ranges == ColourRanges():
        return {}
    tints = {}
    for record in scene.objects:
        tint = Tint(
            hue_deg=float(rng.uniform(-ranges.hue_deg, ranges.hue_deg)),
            saturation=float(rng.uniform(*ranges.saturation)),
            lightness=float(rng.uniform(*ranges.lightness)),
        )
        if not COLOUR_WORDS & set(record.phrase.split()):
            tint = weaker(tint, UNNAMED_COLOUR_TINT)
        allowed = truthful(colours_of(models[record.id]), tint)
        if allowed is not None:
            tints[record.id] = allowed
    return tints


def _one_of(names: list[str], rng: np.random.Generator) -> str | None:
    return names[int(rng.integers(len(names)))] if names else None


def _triple(values: np.ndarray) -> Vec3:
    x, y, z = (float(v) for v in values)
    return x, y, z


# --- from the record to the appearance ------------------------------------------------------------------------


def appearance_of(look: Look) -> Appearance:
    """The appearance of a rendered world with this look.

    Raises:
        UnknownName: a texture of the look does not exist.
    """
    key, *others = look.lights
    pictures = {where: _picture(where, surface) for where, surface in look.surfaces.items()}
    return Appearance(
        table_texture=pictures["table"],
        table_colour=look.surfaces["table"].colour,
        wall_texture=pictures["wall"],
        wall_colour=look.surfaces["wall"].colour,
        floor_texture=pictures["floor"],
        floor_colour=look.surfaces["floor"].colour,
        light_direction=key.direction,
        light_colour=key.colour,
        shadows=key.shadows,
        further_lights=tuple((light.direction, light.colour) for light in others),
        ambient=look.ambient,
        tints=look.tints,
        cameras=look.cameras,
    )


def _picture(where: Where, surface: Surface) -> np.ndarray | None:
    """(H, W, 3) uint8 sRGB texture, its channels multiplied in linear light; None for a plain surface."""
    if surface.texture is None:
        return None
    levels = 255 * np.clip((np.arange(256)[:, None] / 255) ** 2.2 * np.array(surface.colour), 0, 1) ** (1 / 2.2)
    picture = surface_picture(where, surface.texture)
    return np.stack([levels[picture[..., i], i] for i in range(3)], axis=-1).round().astype(np.uint8)


def look_world(scene: Scene, models: Mapping[str, PhysicalModel], robot: Robot, look: Look) -> World:
    """The rendered world in which the recorded states of an episode are drawn.

    Args:
        scene: at the episode's start.
        models: by object id.
        robot: at the table.
        look: of the episode.
    """
    return World.of_scene(scene, models, robot, appearance_of(look), render=True)
