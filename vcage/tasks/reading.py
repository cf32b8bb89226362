"""Scanners and bar codes: the poses at which one reads the other, and the test for it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from vcage.base.geometry import Pose
from vcage.goals.thresholds import THRESHOLDS
from vcage.schema.asset import Face
from vcage.sim.bodies import Body
from vcage.sim.collision import first_near
from vcage.tasks.scene_objects import SceneObject


@dataclass(frozen=True)
class HoldingSettings:
    """Distances and turns at which a code and a window are held before each other.

    Args:
        distances_m: between a window and the code before it, in the order to try them.
        aside_m: farther beside its axis nothing is held on purpose: a hand comes some millimetres beside.
        turns_deg: angles of a code and a window away from facing each other, in the order to try them.
        reserve_turns_deg: the same, which no plan counts on. What is read may have been put down some degrees beside
            its heading, where a wrist at its limit does not reach the other angles any more: on aloha_agilex, 1 degree
            was too much. Codes are read up to 30 degrees.
        over_table_m: clearance of the held object above the table.
        raises_m: heights above the axis at which things are held, in the order to try them: on the axis, or clear of
            what the other lies on.
        clearances_m: distances of the held object from all others, in the order to try them: it sways between the
            fingers, and a hand in motion is some millimetres behind.
    """

    distances_m: tuple[float, ...] = (0.04, 0.055, 0.03)
    aside_m: float = 0.025
    turns_deg: tuple[float, ...] = (0.0, 20.0, -20.0)
    reserve_turns_deg: tuple[float, ...] = (25.0, -25.0)
    over_table_m: float = 0.006
    raises_m: tuple[float, ...] = (0.0, 0.02)
    clearances_m: tuple[float, ...] = (0.015, 0.008)


SETTINGS = HoldingSettings()


_OTHER = {"code": "reader", "reader": "code"}


def reads(one: SceneObject, other: SceneObject) -> bool:
    """True where one of two objects has a window that reads a bar code of the other."""
    return any(_sees(one, a, other, b) for a, b in _pairs(one, other))


def reading_poses(
    mover: SceneObject,
    still: SceneObject,
    support: float,
    rise: float = 0.0,
    turns_deg: Sequence[float] = SETTINGS.turns_deg,
) -> Iterator[Pose]:
    """Poses in the world, upright as now, with a face of ``mover`` before one of ``still``.

    Args:
        mover: the held object.
        still: the resting object; codes and windows that face up or down are left out.
        support: z of the table top, metres.
        rise: height above the axis, metres.
        turns_deg: angles away from facing each other, in the order to try them.
    """
    for aside, (mine, theirs) in product(np.radians(turns_deg), list(_pairs(mover, still))):
        normal = still.pose.rotation() @ np.asarray(theirs.axis)
        outward = mover.pose.rotation() @ np.asarray(mine.axis)
        if abs(normal[2]) > np.sin(THRESHOLDS.code_slant_rad) or abs(outward[2]) > np.sin(THRESHOLDS.code_slant_rad):
            continue
        turn = aside + np.arctan2(-normal[1], -normal[0]) - np.arctan2(outward[1], outward[0])
        rotation = Pose.from_yaw([0, 0, 0], turn) * Pose(q=mover.pose.q)
        offset = rotation.apply(mine.position)
        # On the axis of the scanner, whichever of the two it is: turned or not, the code is not beside it.
        out = normal if theirs.kind == "reader" else -rotation.apply(mine.axis)
        low = float(mover.moved(rotation).aabb[0, 2])
        for distance in SETTINGS.distances_m:
            x, y, z = still.pose.apply(theirs.position) + distance * out - offset
            pose = Pose([x, y, max(z + rise, support + SETTINGS.over_table_m - low)], rotation.q)
            if _sees(mover.moved(pose), mine, still, theirs, SETTINGS.aside_m):
                yield pose


def free_reading_poses(
    mover: SceneObject,
    still: SceneObject,
    others: Sequence[SceneObject],
    support: float,
    turns_deg: Sequence[float] = SETTINGS.turns_deg,
) -> Iterator[list[Pose]]:
    """Yield the poses of :func:`reading_poses` that have room around them, in groups: first those with most room.

    Args:
        mover, still, support, turns_deg: as there.
        others: all other objects, where they are.
    """
    bodies = {o.id: Body(o.asset.model, o.pose, o.joints) for o in others}
    for clearance, rise in product(SETTINGS.clearances_m, SETTINGS.raises_m):
        poses = reading_poses(mover, still, support, rise, turns_deg)
        if free := [pose for pose in poses if _near(mover, pose, bodies, clearance) is None]:
            yield free


def in_the_way(
    mover: SceneObject, still: SceneObject, others: Sequence[SceneObject], support: float
) -> SceneObject | None:
    """One of the other objects that leave no room for any pose of :func:`reading_poses`; None where there is no pose.

    Args: as of :func:`free_reading_poses`.
    """
    bodies = {o.id: Body(o.asset.model, o.pose, o.joints) for o in others}
    poses = [pose for rise in SETTINGS.raises_m for pose in reading_poses(mover, still, support, rise)]
    near = {_near(mover, pose, bodies, SETTINGS.clearances_m[-1]) for pose in poses}
    return next((o for o in others if o.id in near), None)


def _near(mover: SceneObject, pose: Pose, others: Mapping[str, Body], clearance: float) -> str | None:
    """The id of an object that a held one at a pose is nearer to than a clearance, metres."""
    return first_near(Body(mover.asset.model, pose, mover.joints), others, clearance)


def _pairs(one: SceneObject, other: SceneObject) -> Iterator[tuple[Face, Face]]:
    """Faces of two objects, one of which reads the other."""
    for a in one.asset.annotation.faces:
        for b in other.asset.annotation.faces:
            if b.kind == _OTHER.get(a.kind):
                yield a, b


def _sees(one: SceneObject, a: Face, other: SceneObject, b: Face, beside: float = THRESHOLDS.code_aside_m) -> bool:
    reader, code = ((one, a), (other, b)) if a.kind == "reader" else ((other, b), (one, a))
    out = reader[0].pose.rotation() @ np.asarray(reader[1].axis)
    back = code[0].pose.rotation() @ np.asarray(code[1].axis)
    between = code[0].pose.apply(code[1].position) - reader[0].pose.apply(reader[1].position)
    along = float(between @ out)
    aside = float(np.linalg.norm(between - along * out))
    return (
        0 < along <= THRESHOLDS.code_away_m
        and aside <= beside
        and -float(out @ back) >= np.cos(THRESHOLDS.code_slant_rad)
    )
