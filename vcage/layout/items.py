"""Items: objects of a table as placing, optimising and checks of sizes see them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vcage.base.geometry import Pose, footprint_half_size, rotation_2d
from vcage.layout.placement.free_region import TOLERANCE
from vcage.objects.asset import Asset
from vcage.objects.openings import Opening
from vcage.schema.robot import Robot
from vcage.schema.scene import ObjectRecord
from vcage.sim.joints import link_poses


@dataclass(frozen=True)
class HandClearance:
    """Clearance of a hand that comes straight down.

    Args:
        height: things lower than this pass under its palm, metres.
        gap: between the grasped object and higher ones, metres.
    """

    height: float
    gap: float


def hand_clearance(robot: Robot, lowest_grasp_m: float = 0.013, narrowest_m: float = 0.014) -> HandClearance:
    """Clearance of the largest of a robot's hands, to the micrometre.

    Args:
        robot: whose hands they are.
        lowest_grasp_m: height above the table of a gripper's origin when it closes at its lowest.
        narrowest_m: extent along the palm of the narrowest objects: the palm does not reach the table beside them.
    """
    grippers = [arm.gripper for arm in robot.arms.values()]
    below = min(gripper.finger_length for gripper in grippers)
    aside = max(max(gripper.palm_size) / 2 for gripper in grippers)
    return HandClearance(round(lowest_grasp_m + below, 6), round(aside - narrowest_m / 2, 6))


ANY_YAW = tuple(float(yaw) for yaw in np.radians(range(-180, 180, 15)))
"""Headings of an object that can be used from all sides, radians."""

FRONT_YAWS = tuple(float(yaw) for yaw in np.radians((-15, 0, 15)))
"""Headings of an object with moving parts: its front faces the robot."""


@dataclass(frozen=True)
class ItemSettings:
    """Settings of items and containers.

    Args:
        sweep_steps: positions of each joint at which the swept room is measured.
        fill_share: largest share of an opening's floor that contents may take.
        bare_m: a surface so little below its object's top is bare: objects on it may stick out on all sides.
        overhang_share: share of a bare surface that the middle of a wider object must be over, so that it cannot tip.
        distinct_cos: least |cos 2·yaw| at which an axis-aligned box tells the sides of the rectangle in it.
    """

    sweep_steps: int = 5
    fill_share: float = 0.9
    bare_m: float = 0.002
    overhang_share: float = 0.5
    distinct_cos: float = 0.25


ITEMS = ItemSettings()


@dataclass(frozen=True)
class TableItem:
    """An object that stands on a table, or in or on another one. Its rectangle is its room on the table.

    Args:
        id: its name in the result and in errors.
        size: (x, y, z) of its box at yaw 0, with the sweep of moving parts, metres.
        yaws: allowed headings, radians; of a placed content, relative to its container. Optimising
            turns nothing: the first is the present heading.
        target: (x, y) where its origin should stand in the world, when it is optimised.
        opening: what makes it a container, in its own frame, or None; its rim is infinitely high where things stand on
            it, not in it.
        inside: id of the container it lies in or on; when optimised, of the container the plan allows.
        allowed: (m, 2, 2) rectangles, one of which must contain the middle of its own (where an arm reaches it),
            None for anywhere; contents hold their container back by theirs.
        within: (m, 2, 2) rectangles, one of which must contain its whole rectangle when it is placed (a camera's view,
            see :func:`~vcage.layout.placement.view.view_rectangles`), None for anywhere. Where they make up a larger
            region they should be its maximal rectangles, so that an object across two of them counts as inside.
        hand: clearance of a hand that will grasp it, None for an object not to be grasped.
        fixed: True if it stays at its target, even if it touches other fixed items.
        centre: (x, y) of the rectangle's middle in the object's frame, metres.
        body: (2, 2) lower and upper corner of the object itself in its frame, by which relations are judged; the whole
            rectangle when left out.
        ceiling: height over the floor of its opening that contents may have, metres; None without a roof.
    """

    id: str
    size: tuple[float, float, float]
    yaws: tuple[float, ...] = (0.0,)
    target: tuple[float, float] = (0.0, 0.0)
    opening: Opening | None = None
    inside: str | None = None
    allowed: ArrayLike | None = None
    within: ArrayLike | None = None
    hand: HandClearance | None = None
    fixed: bool = False
    centre: tuple[float, float] = (0.0, 0.0)
    body: ArrayLike | None = None
    ceiling: float | None = None

    @property
    def yaw(self) -> float:
        """The heading that it has, radians."""
        return self.yaws[0]

    @property
    def body_size(self) -> np.ndarray:
        """(3,) of the object itself, metres."""
        if self.body is None:
            return np.array(self.size)
        return np.append(np.diff(np.asarray(self.body, dtype=np.float64), axis=0)[0], self.size[2])

    @property
    def room(self) -> Opening:
        """The opening of a container, which has one (:func:`vcage.layout.validation.check_items`)."""
        assert self.opening is not None, f"{self.id} has no opening"
        return self.opening

    @property
    def holds(self) -> str | None:
        """``in`` or ``on``, as things are put there; None where nothing can be."""
        if self.opening is None:
            return None
        return "on" if math.isinf(self.opening.rim) else "in"

    @property
    def bare(self) -> bool:
        """True if things stand on top of it, and nothing stands around them."""
        opening = self.opening
        return opening is not None and math.isinf(opening.rim) and opening.floor >= self.size[2] - ITEMS.bare_m

    def half_size(self, frame_yaw: float = 0.0) -> np.ndarray:
        """(2,) half size of its axis-aligned rectangle in a frame turned by ``frame_yaw``."""
        return footprint_half_size(self.size[:2], self.yaw - frame_yaw)

    def rectangle(self, frame_yaw: float = 0.0) -> np.ndarray:
        """(2, 2) its axis-aligned rectangle around its origin, in a frame turned by ``frame_yaw``."""
        return _rectangle(self.size[:2], self.centre, self.yaw - frame_yaw)

    def body_rectangle(self) -> np.ndarray:
        """(2, 2) the axis-aligned rectangle of the object itself around its origin, in the world's axes."""
        if self.body is None:
            return self.rectangle()
        lower, upper = np.asarray(self.body, dtype=np.float64)
        return _rectangle(upper - lower, (lower + upper) / 2, self.yaw)

    def pose(self, place: Placement, height: float) -> Pose:
        """Pose of the object with its rectangle at ``place`` on a support of that height, metres."""
        turned = Pose.from_yaw([place.x, place.y, height], place.yaw)
        return turned * Pose([-self.centre[0], -self.centre[1], 0.0])


@dataclass(frozen=True)
class Placement:
    """A place of an object in the world.

    Args:
        x, y: its centre in the plane, metres.
        yaw: its heading, radians.
        z: height of its support above the table, metres; the floors of the containers that it lies in.
    """

    x: float
    y: float
    yaw: float
    z: float = 0.0


def _rectangle(size: Sequence[float], middle: Sequence[float], yaw: float) -> np.ndarray:
    """(2, 2) the axis-aligned rectangle around one of that size and middle, turned about the origin."""
    c, s = math.cos(yaw), math.sin(yaw)  # numbers, as arrays of two are slow and this is asked often
    (w, d), (x, y) = size, middle
    half_x, half_y = (abs(c) * w + abs(s) * d) / 2, (abs(s) * w + abs(c) * d) / 2
    x, y = c * x - s * y, s * x + c * y
    return np.array([[x - half_x, y - half_y], [x + half_x, y + half_y]])


def table_item(name: str, asset: Asset) -> TableItem:
    """The room of an asset: its footprint, with the sweep of its moving parts if it has any."""
    body, height = asset.bounds[:, :2], float(asset.size[2])
    if not asset.articulated:
        width, depth = (body[1] - body[0]).tolist()
        return TableItem(name, (width, depth, height), ANY_YAW, body=body)
    points = np.concatenate([body, *_swept(asset)])
    lower, upper = points.min(axis=0), points.max(axis=0)
    (width, depth), (x, y) = (upper - lower).tolist(), ((lower + upper) / 2).tolist()
    return TableItem(name, (width, depth, height), FRONT_YAWS, centre=(x, y), body=body)


def item_of(record: ObjectRecord) -> TableItem:
    """Return the item that a record alone describes, with the sides of its rectangle from the box around it.

    At 45 degrees boxes do not tell the sides apart, which are then taken to be equal.
    """
    lower, upper = np.array(record.aabb)
    yaw = record.pose.pose().yaw
    c, s = abs(np.cos(yaw)), abs(np.sin(yaw))
    x, y, z = upper - lower
    sides = np.full(2, (x + y) / 2 / (c + s))
    if abs(c * c - s * s) > ITEMS.distinct_cos:
        exact = np.array([c * x - s * y, c * y - s * x]) / (c * c - s * s)
        sides = exact if exact.min() > 0 else sides
    centre = rotation_2d(-yaw) @ ((lower + upper)[:2] / 2 - record.pose.position[:2])
    width, depth = (float(side) for side in sides)
    return TableItem(record.id, (width, depth, float(z)), ANY_YAW, centre=(float(centre[0]), float(centre[1])))


def _swept(asset: Asset) -> list[np.ndarray]:
    """(n, 2) corners of the moving parts, seen from above, while each joint goes through its range."""
    links = asset.model.links
    shares = np.linspace(0, 1, ITEMS.sweep_steps)
    corners = []
    for share in shares:
        joints = [(1 - share) * link.joint.lower + share * link.joint.upper for link in links]
        poses = link_poses(asset.model, joints)
        for link in links:
            corners += [poses[link.name].apply(piece.vertices)[:, :2] for piece in asset.pieces_of(link.name)]
    return corners


def centres_within(rectangles: np.ndarray, half: np.ndarray) -> np.ndarray:
    """(k, 2, 2) where the centre of a footprint of half size (2,) is when it lies in one of (m, 2, 2) rectangles."""
    found = np.stack([rectangles[:, 0] + half, rectangles[:, 1] - half], axis=1)
    found = found[np.all(found[:, 0] <= found[:, 1] + 2 * TOLERANCE, axis=1)]
    return np.stack([found.min(axis=1), found.max(axis=1)], axis=1)  # an exact fit may be inverted by the last bit
