"""Scanners and bar codes: the poses at which one reads the other, and the test for it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from vcage.base.geometry import Pose
from vcage.goals.thresholds import THRESHOLDS
from vcage.schema.asset import Face
from vcage.tasks.scene_objects import SceneObject


@dataclass(frozen=True)
class HoldingSettings:
    """Distances and turns at which a code and a window are held before each other.

    Args:
        distances_m: between a window and the code before it, in the order to try them.
        aside_m: farther beside its axis nothing is held on purpose: a hand comes some millimetres beside.
        turns_deg: angles of a code and a window away from facing each other, in the order to try them.
        over_table_m: clearance of the held object above the table.
    """

    distances_m: tuple[float, ...] = (0.04, 0.055, 0.03)
    aside_m: float = 0.025
    turns_deg: tuple[float, ...] = (0.0, 20.0, -20.0)
    over_table_m: float = 0.006


SETTINGS = HoldingSettings()


_OTHER = {"code": "reader", "reader": "code"}


def reads(one: SceneObject, other: SceneObject) -> bool:
    """True where one of two objects has a window that reads a bar code of the other."""
    return any(_sees(one, a, other, b) for a, b in _pairs(one, other))


def reading_poses(mover: SceneObject, still: SceneObject, support: float) -> Iterator[Pose]:
    """Poses in the world, upright as now, with a face of ``mover`` before one of ``still``.

    Args:
        mover: the held object.
        still: the resting object; codes and windows that face up or down are left out.
        support: z of the table top, metres.
    """
    for aside, (mine, theirs) in product(np.radians(SETTINGS.turns_deg), list(_pairs(mover, still))):
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
            pose = Pose([x, y, max(z, support + SETTINGS.over_table_m - low)], rotation.q)
            if _sees(mover.moved(pose), mine, still, theirs, SETTINGS.aside_m):
                yield pose


def _pairs(one: SceneObject, other: SceneObject) -> Iterator[tuple[Face, Face]]:
    """Faces of two objects, one of which reads the other."""
    for a in one.asset.annotation.faces:
        for b in other.asset.annotation.faces:
            if b.kind == _OTHER[a.kind]:
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
