"""What a pick may take hold of and what a place can get at, on objects whose parts move."""

from __future__ import annotations

import numpy as np

from vcage.schema.asset import Annotation, ContactPoint, FunctionalPoint
from vcage.schema.subtasks import Check
from vcage.sim.joints import link_poses
from vcage.tasks.scene_objects import SceneObject

UPRIGHT = 0.7
"""Least share of a functional point's axis that points up: things are put there from above."""

COVER = 0.01
"""What is nearer above a functional point than this belongs to its floor, metres."""


def carrying_points(annotation: Annotation) -> list[ContactPoint]:
    """The contact points by which the object is carried: handles and buttons of moving parts are not among them."""
    return [point for point in annotation.contact_points if point.link is None and point.use == "grasp"]


def access(receptacle: SceneObject, point: FunctionalPoint) -> Check:
    """Whether a functional point is reached from above: it faces up, and no closed drawer or lid keeps it in."""
    poses = link_poses(receptacle.asset.model, receptacle.joints)
    part = receptacle.pose * poses[point.link]
    upright = float((part.rotation() @ np.asarray(point.axis))[2])
    where = f"{point.name!r} of {receptacle.record.phrase}"
    if upright < UPRIGHT:
        message = f"{where} can only be reached from the side"
        return Check(name="way_free", passed=False, value=upright, limit=UPRIGHT, message=message)
    lid = _closed_part(receptacle, point)
    if lid is not None:
        message = f"the {lid.replace('_', ' ')} of {receptacle.record.phrase} is closed"
        return Check(name="way_free", passed=False, message=message)
    return Check(name="way_free", passed=True, message=f"{where} is open at the top")


def _closed_part(receptacle: SceneObject, point: FunctionalPoint) -> str | None:
    """The moving part that must be opened first, or None: the point's own, or the one that lies over it."""
    model = receptacle.asset.model
    poses = link_poses(model, receptacle.joints)
    origin = (receptacle.pose * poses[point.link]).apply(point.position)
    for name, local in poses.items():
        if name == point.link:
            continue  # its own ceiling is the opening's business
        to_part = (receptacle.pose * local).inverse()
        start, up = to_part.apply(origin), to_part.rotation() @ [0.0, 0.0, 1.0]
        for piece in receptacle.asset.pieces_of(name):
            stretch = piece.interval(start, up)
            if stretch is not None and stretch[1] > COVER:
                return point.link or name
    return None
