"""Draw scenes: renders of tables, things on them, and the shares of things that a picture shows."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from typing import Any

import cv2
import numpy as np

from benchmarks._match.levels import Level
from benchmarks._match.scenes import Thing
from vcage.base.geometry import Pose
from vcage.objects.surface_pictures import SURFACES, surface_picture
from vcage.schema.scene import SceneTemplate
from vcage.sim.appearance import Appearance
from vcage.sim.bodies import Body
from vcage.sim.cameras import Shot, observe, shoot
from vcage.sim.robots import load_template
from vcage.sim.world import World

REPAINTED = 4
"""Table tops that are painted of each material beside the plain one."""


@functools.cache
def plain_look(texture: str) -> Appearance:
    """The look of a source picture: studio light and the template's own table."""
    return Appearance(table_texture=surface_picture("table", texture))


@functools.cache
def _repainted(texture: str, number: int) -> np.ndarray:
    """A table top of the same material with another grain."""
    return SURFACES["table"][texture](np.random.default_rng([len(texture), number]))


def photograph(template: SceneTemplate, things: Sequence[Thing], poses: Mapping[str, Pose], look: Appearance) -> Shot:
    """The view of the top camera; segmentation values are the places in ``things``, from 1."""
    bodies = {thing.id: Body(thing.asset.model, poses[thing.id]) for thing in things}
    return observe(World(template.table, bodies, appearance=look, render=True), template.top_camera)


@functools.cache
def background(template: str) -> np.ndarray:
    """(H, W, 3) top view of a template's empty table."""
    record = load_template(template)
    empty = World(record.table, {}, appearance=plain_look(record.table.texture), render=True)
    return shoot(empty, record.top_camera)


def visible_shares(
    shot: Shot, template: SceneTemplate, things: Sequence[Thing], poses: Mapping[str, Pose]
) -> dict[str, float]:
    """Share of each object's silhouette, the outline of its convex pieces, that the picture shows."""
    camera = template.top_camera.camera()
    shares = {}
    for value, thing in enumerate(things, start=1):
        outline = np.zeros((camera.height, camera.width), np.uint8)
        for piece in thing.asset.pieces:
            corners = camera.project(poses[thing.id].apply(piece.vertices)) - 0.5
            hull = np.asarray(cv2.convexHull(np.rint(corners).astype(np.int32)), dtype=np.int32)
            cv2.fillConvexPoly(outline, hull, (1,))
        shares[thing.id] = min(1.0, float((shot.segmentation == value).sum() / max(outline.sum(), 1)))
    return shares


def target_look(level: Level, template: SceneTemplate, rng: np.random.Generator) -> tuple[Appearance, dict[str, Any]]:
    """Light and table of the target picture, and its differences from the source."""
    done: dict[str, Any] = {}
    texture = plain_look(template.table.texture).table_texture
    if level.table:
        names = sorted(SURFACES["table"])
        name, number = names[int(rng.integers(len(names)))], int(rng.integers(REPAINTED))
        texture = _repainted(name, number)
        done["table"] = f"{name} {number}"
    if not level.light:
        return Appearance(table_texture=texture), done
    heading, slant = rng.uniform(-np.pi, np.pi), rng.uniform(0.25, 0.7)
    strength, warmth, ambient = rng.uniform(1.2, 1.9), rng.uniform(-0.1, 0.1), rng.uniform(0.35, 0.55)
    tint = np.array([1 + warmth, 1.0, 1 - warmth])
    done |= {"light_heading": round(heading, 3), "light_slant": round(slant, 3), "light_strength": round(strength, 3)}
    red, green, blue = (float(x) for x in strength * tint)
    around = [float(x) for x in ambient * (1 + (tint - 1) / 3)]
    look = Appearance(
        table_texture=texture,
        light_direction=(slant * np.cos(heading), slant * np.sin(heading), -1.0),
        light_colour=(red, green, blue),
        ambient=(around[0], around[1], around[2]),
    )
    return look, done
