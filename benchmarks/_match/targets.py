"""The target picture of a case and its truth: things moved, drawn again, and changed as image models change them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks._match import changes
from benchmarks._match.drawing import photograph, target_look, visible_shares
from benchmarks._match.levels import Level
from benchmarks._match.scenes import Thing, scatter
from benchmarks._match.truth import Stranger, TrueObject
from benchmarks._match.views import Look, alike, library, symmetry
from vcage.base.geometry import Pose
from vcage.schema.scene import SceneTemplate
from vcage.sim.appearance import Appearance
from vcage.sim.cameras import Shot

LEAST_VISIBLE = 0.6
"""Share of an object's silhouette that must be seen in both pictures; hidden ones cannot be found."""

STRANGER_AREA = 0.02
"""Largest footprint of a stranger, m²: it comes on top of a table that is full already."""


@dataclass(frozen=True)
class Target:
    """The changed picture and what is true of it."""

    picture: np.ndarray
    objects: list[TrueObject]
    strangers: list[Stranger]
    changes: dict[str, Any]

    @classmethod
    def draw(
        cls, level: Level, template: SceneTemplate, things: list[Thing], looks: list[Look], rng: np.random.Generator
    ) -> Target | None:
        """The picture of the same things moved, changed as the level says; None when an object is hidden by another."""
        absent = things[int(rng.integers(len(things)))].id if level.stranger else None
        shown = [thing for thing in things if thing.id != absent]
        strangers = [_stranger(looks, rng)] if level.stranger else []
        everything = shown + strangers
        groups = _groups([thing.id for thing in everything], rng) if level.touching else []
        poses = scatter(everything, template.workspace, template.table, rng, groups)
        look, done = target_look(level, template, rng)
        shot = photograph(template, everything, poses, look)
        shares = visible_shares(shot, template, everything, poses)
        if min(shares.values()) < LEAST_VISIBLE:
            return None
        picture, more = _changed(level, template, everything, poses, shot, look, rng)
        objects = [_true_object(thing, poses.get(thing.id), shares.get(thing.id, 0.0)) for thing in things]
        added = [Stranger(name=f"{s.asset.name}/{s.asset.variant.id}", position=_xy(poses[s.id])) for s in strangers]
        return cls(picture, objects, added, {**done, **more, **({"touching": groups} if groups else {})})


def _xy(pose: Pose) -> tuple[float, float]:
    return round(float(pose.p[0]), 6), round(float(pose.p[1]), 6)


def _true_object(thing: Thing, pose: Pose | None, visible: float) -> TrueObject:
    order = symmetry((thing.asset.name, thing.asset.variant.id))
    if pose is None:
        return TrueObject(id=thing.id, present=False, symmetry=order, visible=0.0)
    return TrueObject(
        id=thing.id,
        present=True,
        position=_xy(pose),
        yaw=round(pose.yaw, 6),
        symmetry=order,
        visible=round(visible, 4),
    )


def _stranger(looks: list[Look], rng: np.random.Generator) -> Thing:
    """A small or medium object that the scene lacks and that looks unlike its objects."""
    others = [look for look in library().variants() if look not in looks]
    pool = [look for look in others if library().asset(*look).footprint.prod() < STRANGER_AREA]
    while True:
        drawn = pool[int(rng.integers(len(pool)))]
        if not any(drawn[0] == look[0] and alike(drawn, look) for look in looks):
            return Thing("stranger", library().asset(*drawn))


def _groups(ids: list[str], rng: np.random.Generator) -> list[list[str]]:
    """A third to two thirds of the objects in pairs, now and then in threes."""
    order = [ids[i] for i in rng.permutation(len(ids))]
    wanted = max(2, round(len(ids) * rng.uniform(1 / 3, 2 / 3)))
    groups: list[list[str]] = []
    while sum(map(len, groups)) < wanted and len(order) >= 2:
        size = 3 if len(order) >= 3 and rng.random() < 0.25 else 2
        groups.append([order.pop() for _ in range(size)])
    return groups


def _changed(
    level: Level,
    template: SceneTemplate,
    things: list[Thing],
    poses: Mapping[str, Pose],
    shot: Shot,
    look: Appearance,
    rng: np.random.Generator,
) -> tuple[np.ndarray, dict[str, Any]]:
    """The picture after all that the level asks for, in the order in which an image model would do it."""
    picture, done = shot.picture, {}
    camera = template.top_camera.camera()
    masks = {thing.id: shot.segmentation == value for value, thing in enumerate(things, start=1)}
    if level.light:
        heading = np.array([look.light_direction[0], -look.light_direction[1]])
        scale = camera.focal / (camera.pose.p[2] - template.table.height)
        heights = [(masks[thing.id], float(thing.asset.bounds[1, 2]) * scale) for thing in things]
        picture, more = changes.shade(picture, heights, shot.segmentation > 0, heading / np.linalg.norm(heading), rng)
        done |= more
    if level.warp:
        lifts = {thing.id: np.array([0, 0, thing.asset.bounds[1, 2] / 2]) for thing in things}
        centres = {name: camera.project(pose.p + lifts[name]) for name, pose in poses.items()}
        picture, more = changes.bend(picture, masks, centres, rng)
        done |= more
    if level.colour:
        picture, more = changes.drift_colours(picture, rng)
        done |= more
    if level.blur:
        picture, more = changes.soften(picture, rng)
        done |= more
    return picture, done
