"""Objects that the target picture does not show, or not surely: they keep their place from the plan."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from vcage.base.errors import VcageError
from vcage.base.geometry import rotation_2d, wrap_angle
from vcage.models.rules.arrange import Placement, arrange
from vcage.models.rules.footprints import footprints
from vcage.schema.matches import Match
from vcage.schema.plan import LayoutPlan, Plan
from vcage.schema.scene import ObjectRecord, Scene


def kept(
    scene: Scene,
    plan: LayoutPlan | Plan | None,
    segmentation: np.ndarray,
    found: Mapping[str, Match],
    why: Mapping[str, str],
) -> dict[str, Match]:
    """A match that says "kept" for each object of ``why`` (object id → why it was not found).

    Where the plan says something about an object, it goes where the plan wants it beside those that were found; else
    it stays where it was. The note says which.
    """
    subjects = {r.subject for r in plan.relations} & set(why) if plan else set()
    planned: Mapping[str, Placement] = {}
    trouble = ""
    if plan and subjects:
        fixed = {m.object: _placement(scene.object(m.object), m) for m in found.values()}
        fixed |= {i: _standing(scene.object(i)) for i in why if i not in subjects}
        try:
            planned = arrange(scene, plan, footprints(scene, segmentation), fixed)
        except VcageError as error:
            trouble = f" (the plan gives it no place: {error})"
    return {
        i: _kept(scene.object(i), reason, planned.get(i) if i in subjects else None, trouble if i in subjects else "")
        for i, reason in why.items()
    }


def _centre(record: ObjectRecord) -> np.ndarray:
    return np.array(record.aabb)[:, :2].mean(axis=0)


def _placement(record: ObjectRecord, match: Match) -> Placement:
    """Where a match puts the centre of the object's box."""
    offset = _centre(record) - record.pose.position[:2]
    return Placement(np.array(match.position) + rotation_2d(match.turned) @ offset, match.turned)


def _standing(record: ObjectRecord) -> Placement:
    return Placement(_centre(record), 0.0)


def _kept(record: ObjectRecord, why: str, planned: Placement | None, trouble: str) -> Match:
    turn = planned.turn if planned else 0.0
    origin = np.array(record.pose.position[:2])
    if planned:
        origin = planned.centre + rotation_2d(turn) @ (origin - _centre(record))
    return Match(
        object=record.id,
        method="kept",
        similarity=None,
        confidence=0.0,
        box=None,
        position=(float(origin[0]), float(origin[1])),
        yaw=float(wrap_angle(record.pose.pose().yaw + turn)),
        turned=float(turn),
        ncc=None,
        note=f"{why}; " + ("put where the plan wants it" if planned else f"kept where it was{trouble}"),
    )
