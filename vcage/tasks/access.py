"""Access to a functional point from above, and the drawer or lid that must be opened first."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vcage.base.memory import remembered
from vcage.schema.asset import FunctionalPoint
from vcage.schema.goals import Goal, part_that
from vcage.schema.subtasks import Check
from vcage.sim.joints import link_poses
from vcage.tasks.scene_objects import SceneObject


@dataclass(frozen=True)
class AccessSettings:
    """Limits of access from above.

    Args:
        upright_share: least upward share of a functional point's axis: things are put there from above.
        cover_m: parts that are nearer above a functional point belong to its floor.
    """

    upright_share: float = 0.7
    cover_m: float = 0.01


SETTINGS = AccessSettings()


def access(receptacle: SceneObject, point: FunctionalPoint) -> Check:
    """Check that a functional point faces up, and that no closed drawer or lid covers it."""
    poses = link_poses(receptacle.asset.model, receptacle.joints)
    part = receptacle.pose * poses[point.link]
    upright = float((part.rotation() @ np.asarray(point.axis))[2])
    where = f"{point.name!r} of {receptacle.record.phrase}"
    if upright < SETTINGS.upright_share:
        message = f"{where} can only be reached from the side"
        return Check(name="way_free", passed=False, value=upright, limit=SETTINGS.upright_share, message=message)
    lid = closed_part(receptacle, point)
    if lid is not None:
        message = f"the {lid.replace('_', ' ')} of {receptacle.record.phrase} is closed"
        return Check(name="way_free", passed=False, message=message)
    return Check(name="way_free", passed=True, message=f"{where} is open at the top")


def open_to_a_hand(thing: SceneObject, part: str) -> list[Goal]:
    """Goals that must be true before a hand gets into a part: it is open, and drawers above it are closed."""
    return [Goal(subject=thing.id, relation="open", part=part), *shut_above(thing, part)]


def shut_above(thing: SceneObject, part: str) -> list[Goal]:
    """Goals that the drawers above a part are closed, so that none is open over it."""
    asset = thing.asset
    height = asset.bounds_of(part)[0, 2]
    above = [
        link.name for link in asset.model.links
        if part_that("open", link.name) and link.joint.kind == "slide" and asset.bounds_of(link.name)[0, 2] > height
    ]  # fmt: skip
    return [Goal(subject=thing.id, relation="closed", part=name) for name in above]


@remembered(256)
def headroom(receptacle: SceneObject, point: FunctionalPoint) -> float:
    """Largest height of an object over which the parts around the point can be closed, metres; infinite without any.

    The least height above the point's floor, over a grid of its opening, of all other parts when everything is at rest.
    """
    if not receptacle.asset.articulated:
        return np.inf
    opening = receptacle.asset.opening(point)
    across, along = (np.linspace(-0.4, 0.4, 5) * side for side in opening.size)
    least = np.inf
    for link in (None, *(link.name for link in receptacle.asset.model.links)):
        if link == point.link:
            continue
        for piece in receptacle.asset.pieces_of(link):
            for x in opening.centre[0] + across:
                for y in opening.centre[1] + along:
                    stretch = piece.interval(np.array([x, y, opening.floor]), np.array([0.0, 0.0, 1.0]))
                    if stretch is not None and stretch[1] > SETTINGS.cover_m:
                        least = min(least, max(stretch[0], 0.0))
    return float(least)


def closed_part(receptacle: SceneObject, point: FunctionalPoint) -> str | None:
    """The moving part to open first, or None: the point's own, or the one over it."""
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
            if stretch is not None and stretch[1] > SETTINGS.cover_m:
                return point.link or name
    return None
