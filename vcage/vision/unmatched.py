"""Matches of objects that the edited picture does not show surely: the plan or the scene says where they stand."""

from __future__ import annotations

from collections.abc import Mapping

from vcage.base.geometry import Pose, wrap_angle
from vcage.layout.intended import intended_layout
from vcage.layout.items import item_of
from vcage.schema.matches import Match
from vcage.schema.plan import LayoutPlan, Plan
from vcage.schema.scene import ObjectRecord
from vcage.vision.observation import Observation


def stored_matches(
    observation: Observation, plan: LayoutPlan | Plan | None, found: Mapping[str, Match], reasons: Mapping[str, str]
) -> dict[str, Match]:
    """A match of the method "kept" for each object that was not found.

    An object goes where the plan wants it beside the found ones, if the source shows it and the plan has it as a
    subject; any other object stays where it was. The note says which.

    Args:
        observation: scene, and which objects the source shows.
        plan: relations that the layout shall have.
        found: matches by object id.
        reasons: object id → why it was not found.

    Raises:
        UnknownName: the scene's robot does not exist; the plan needs it to leave room for hands.
    """
    planned = _planned_poses(observation, plan, found, reasons)
    return {
        name: _stored(observation.scene.object(name), reason, planned.get(name)) for name, reason in reasons.items()
    }


def _planned_poses(
    observation: Observation, plan: LayoutPlan | Plan | None, found: Mapping[str, Match], reasons: Mapping[str, str]
) -> Mapping[str, Pose]:
    scene = observation.scene
    subjects = {r.subject for r in plan.relations} & set(reasons) & observation.shown if plan else set()
    if not plan or not subjects:
        return {}
    fixed = {o.id: o.pose.pose() for o in scene.objects if o.id not in subjects}
    for name, match in found.items():
        fixed[name] = Pose.from_yaw([*match.position, scene.object(name).pose.position[2]], match.yaw)
    layout = intended_layout(scene, plan.relations, {o.id: item_of(o) for o in scene.objects}, fixed)
    return {name: layout.poses[name] for name in subjects}


def _stored(record: ObjectRecord, reason: str, planned: Pose | None) -> Match:
    before = record.pose.pose()
    pose = planned or before
    turned = float(wrap_angle(pose.yaw - before.yaw))
    return Match(
        object=record.id,
        method="kept",
        similarity=None,
        confidence=0.0,
        box=None,
        position=(float(pose.p[0]), float(pose.p[1])),
        yaw=float(wrap_angle(before.yaw + turned)),
        turned=turned,
        ncc=None,
        note=f"{reason}; " + ("put where the plan wants it" if planned else "kept where it was"),
    )
