"""Objects that the target picture does not show, or not surely: they keep their place from the plan."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from vcage.base.geometry import Pose, wrap_angle
from vcage.layout.intended import intended_layout
from vcage.layout.items import item_of
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

    Where the plan says something about an object that the source picture shows, it goes where the plan wants it beside
    those that were found; else it stays where it was. The note says which.

    Raises:
        UnknownName: there is no such robot as the scene's; hands need room where the plan puts something.
    """
    shown = set(np.unique(segmentation).tolist())
    subjects = {r.subject for r in plan.relations} & set(why) if plan else set()
    subjects = {name for name in subjects if scene.segmentation_ids.get(name, -1) in shown}
    planned: Mapping[str, Pose] = {}
    if plan and subjects:
        fixed = {o.id: o.pose.pose() for o in scene.objects if o.id not in subjects}
        fixed |= {name: _pose(scene.object(name), match) for name, match in found.items()}
        layout = intended_layout(scene, plan.relations, {o.id: item_of(o) for o in scene.objects}, fixed)
        planned = {name: layout.poses[name] for name in subjects}
    return {name: _kept(scene.object(name), reason, planned.get(name)) for name, reason in why.items()}


def _pose(record: ObjectRecord, match: Match) -> Pose:
    return Pose.from_yaw([*match.position, record.pose.position[2]], match.yaw)


def _kept(record: ObjectRecord, why: str, planned: Pose | None) -> Match:
    before = record.pose.pose()
    pose = planned or before
    turn = float(wrap_angle(pose.yaw - before.yaw))
    return Match(
        object=record.id,
        method="kept",
        similarity=None,
        confidence=0.0,
        box=None,
        position=(float(pose.p[0]), float(pose.p[1])),
        yaw=float(wrap_angle(before.yaw + turn)),
        turned=turn,
        ncc=None,
        note=f"{why}; " + ("put where the plan wants it" if planned else "kept where it was"),
    )
