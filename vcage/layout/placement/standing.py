"""How an object may stand on the table: which way it faces, and the room that its moving parts need."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vcage.base.geometry import Pose
from vcage.layout.placement.place import Placement
from vcage.objects.asset import Asset
from vcage.objects.openings import Opening
from vcage.sim.joints import link_poses

ANY_YAW = tuple(np.radians(range(-180, 180, 15)))
"""Headings of an object that can be used from all sides, radians."""

FRONT_YAWS = tuple(np.radians((-15, 0, 15)))
"""Headings of an object with moving parts: its front faces the robot."""

SWEEP_STEPS = 5
"""Positions of each joint that the swept room is measured at."""


@dataclass(frozen=True)
class Standing:
    """The rectangle that an object needs on the table, in its own frame.

    Args:
        centre: (2,) of the rectangle, metres.
        size: (2,) of the rectangle, metres; with the room that drawers, doors and lids sweep.
        yaws: headings that are allowed, radians.
    """

    centre: np.ndarray
    size: np.ndarray
    yaws: Sequence[float]

    def pose(self, spot: Placement, height: float) -> Pose:
        """Pose of the object whose rectangle lies at ``spot`` on a support of that height, metres."""
        turned = Pose.from_yaw([spot.x, spot.y, height], spot.yaw)
        return turned * Pose([-self.centre[0], -self.centre[1], 0.0])

    def local(self, opening: Opening) -> Opening:
        """An opening of the object, given in the object's frame, in the frame of its rectangle."""
        x, y = np.array(opening.centre) - self.centre
        return replace(opening, centre=(float(x), float(y)))


def standing(asset: Asset) -> Standing:
    """The room that an asset needs: its footprint, or with moving parts the footprint of all that they sweep."""
    if not asset.articulated:
        return Standing(np.zeros(2), asset.footprint, ANY_YAW)
    points = np.concatenate([asset.bounds[:, :2], *_swept(asset)])
    lower, upper = points.min(axis=0), points.max(axis=0)
    return Standing((lower + upper) / 2, upper - lower, FRONT_YAWS)


def _swept(asset: Asset) -> list[np.ndarray]:
    """(n, 2) corners of the moving parts, seen from above, while each joint goes through its range."""
    links = asset.model.links
    shares = np.linspace(0, 1, SWEEP_STEPS)
    corners = []
    for share in shares:
        joints = [(1 - share) * link.joint.lower + share * link.joint.upper for link in links]
        poses = link_poses(asset.model, joints)
        for link in links:
            corners += [poses[link.name].apply(piece.vertices)[:, :2] for piece in asset.pieces_of(link.name)]
    return corners
