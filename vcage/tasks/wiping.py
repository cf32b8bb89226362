"""Tools with a pad: the ways of one over the flat top of an object, and the part of it that is wiped."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from vcage.base.geometry import Pose
from vcage.goals.thresholds import THRESHOLDS
from vcage.objects.openings import Opening
from vcage.schema.asset import FunctionalPoint
from vcage.sim.bodies import Body
from vcage.sim.collision import first_near
from vcage.tasks.scene_objects import SceneObject


@dataclass(frozen=True)
class WipingSettings:
    """Tops that are wiped, and the way of a pad over one.

    Args:
        rim_m: a deeper place is no flat top: between the walls of a breakfast tray, 3.3 cm high, hands have no room.
        least_way_m: a shorter way from one end of a top to the other is no wiping that anybody sees.
        level_rad: a top that leans more is not wiped.
        pad_m: what lies at most this much higher than the lowest point of a tool belongs to its pad.
        cell_m: edge of the cells that a top is divided into.
        margin_m: distance of the pad from the edge of a top: what is held comes some millimetres beside.
        low_rim_m: finger tips pass over a lower rim.
        fingers_m: room that each finger needs beside the tool where the rim is higher.
        spare_share: share of a top by which a way wipes more than must be wiped.
        lanes_share: distance between neighbouring lanes, as a share of the width of the pad.
        above_m: the pad over the top before it comes down.
        clearance_m: least distance of the held tool from all other objects.
    """

    rim_m: float = 0.03
    least_way_m: float = 0.04
    level_rad: float = float(np.radians(5))
    pad_m: float = 0.002
    cell_m: float = 0.005
    margin_m: float = 0.004
    low_rim_m: float = 0.008
    fingers_m: float = 0.023
    spare_share: float = 0.05
    lanes_share: float = 0.9
    above_m: float = 0.03
    clearance_m: float = 0.01


SETTINGS = WipingSettings()


@dataclass(frozen=True)
class Pad:
    """The lower side of a tool, in its frame.

    Args:
        middle: (3,) of a rectangle, metres.
        half: (2,) half the size of that.
        closing: (2,) share of each axis along which fingers close on the tool.
    """

    middle: np.ndarray
    half: np.ndarray
    closing: np.ndarray

    @classmethod
    def of(cls, tool: SceneObject) -> Pad | None:
        """The pad of a tool; None where it has none."""
        faces = tool.asset.annotation.faces_of("pad")
        if not faces:
            return None
        corners = np.concatenate([piece.vertices for piece in tool.asset.pieces])
        low = faces[0].position[2]
        flat = corners[corners[:, 2] <= low + SETTINGS.pad_m, :2]
        lower, upper = flat.min(axis=0), flat.max(axis=0)
        closing = np.abs([point.closing[:2] for point in tool.asset.annotation.carrying_points]).max(axis=0, initial=0)
        return cls(np.append((lower + upper) / 2, low), (upper - lower) / 2, closing)

    def fingers(self, depth: float) -> list[np.ndarray]:
        """(2,) room to leave for fingers between the pad and a rim of a height, in the order to try: a rim that leans
        outwards needs none."""
        beside = SETTINGS.fingers_m * self.closing
        return [beside, 0 * beside] if depth > SETTINGS.low_rim_m else [0 * beside]


def flat_top(thing: SceneObject) -> Opening | None:
    """The largest flat place of an object on which a pad has room, in its frame; None where there is none."""
    points = [point for point in thing.asset.annotation.functional_points if _faces_up(point)]
    found = [thing.asset.opening(point, standing=point.holds == "in") for point in points]
    level = [one for one in found if one.depth <= SETTINGS.rim_m]
    return max(level, key=lambda one: one.size[0] * one.size[1], default=None)


def _faces_up(point: FunctionalPoint) -> bool:
    """True for a place of the body that is open upwards."""
    return point.link is None and not point.sideways


def cells_of(thing: SceneObject) -> np.ndarray:
    """(n, 3) middles of the cells of an object's flat top, in its frame; none without one."""
    top = flat_top(thing)
    if top is None:
        return np.zeros((0, 3))
    counts = np.maximum(np.round(np.array(top.size) / SETTINGS.cell_m), 1).astype(int)
    axes = [
        middle + size * ((np.arange(count) + 0.5) / count - 0.5)
        for middle, size, count in zip(top.centre, top.size, counts, strict=True)
    ]
    x, y = np.meshgrid(*axes, indexing="ij")
    return np.stack([x.ravel(), y.ravel(), np.full(x.size, top.floor)], axis=1)


def under_pad(tool: SceneObject, thing: SceneObject) -> np.ndarray:
    """Numbers of the cells of an object's flat top that lie under the pad of a tool and near to it."""
    pad = Pad.of(tool)
    if pad is None:
        return np.array([], int)
    seen = (tool.pose.inverse() * thing.pose).apply(cells_of(thing)) - pad.middle
    within = np.all(np.abs(seen[:, :2]) <= pad.half, axis=1) & (np.abs(seen[:, 2]) <= THRESHOLDS.wiped_gap_m)
    return np.flatnonzero(within)


def wiping_ways(tool: SceneObject, thing: SceneObject, above_m: float = SETTINGS.above_m) -> Iterator[list[Pose]]:
    """Ways of a tool over the flat top of an object: its poses where a straight stroke begins or ends, in order.

    The tool is turned least in the first of them; there is none where the pad does not fit on the top.

    Args:
        tool: the held object.
        thing: what it wipes.
        above_m: height of the pad over the top, metres.
    """
    pad, top = Pad.of(tool), flat_top(thing)
    if pad is None or top is None or thing.pose.rotation()[2, 2] < np.cos(SETTINGS.level_rad):
        return
    for quarter, turn in _turns(thing.pose.yaw - tool.pose.yaw):
        rotation = Pose.from_yaw([0, 0, 0], turn) * Pose(q=tool.pose.q)
        middle, raised = rotation.apply(pad.middle), np.array([0.0, 0.0, above_m])
        for fingers in pad.fingers(top.depth):
            half, beside = (way[::-1] if quarter % 2 else way for way in (pad.half, fingers))
            corners = _corners(np.array(top.size) / 2, SETTINGS.margin_m + beside, half)
            spots = [thing.pose.apply([*(np.array(top.centre) + corner), top.floor]) for corner in corners]
            way = [Pose(spot + raised - middle, rotation.q) for spot in spots]
            if way and np.linalg.norm(way[farthest(way)].p - way[0].p) >= SETTINGS.least_way_m:
                yield way


def _turns(turn: float) -> list[tuple[int, float]]:
    """A turn and those by further quarters: (number of quarters, turn of half a turn at most, rad), the least first."""
    turns = [turn + quarter * np.pi / 2 for quarter in range(4)]
    wrapped = [float((one + np.pi) % (2 * np.pi) - np.pi) for one in turns]
    return sorted(enumerate(wrapped), key=lambda one: abs(one[1]))


def _corners(top: np.ndarray, kept: np.ndarray, half: np.ndarray) -> list[np.ndarray]:
    """(2,) places of the middle of a pad at the ends of strokes to and fro, on the shorter way over all of a top.

    There are none where the pad does not fit, or wipes too little.

    Args:
        top: (2,) half the size of the top.
        kept: (2,) distance of the pad from each edge.
        half: (2,) half the size of the pad.
    """
    room = top - kept - half
    if room.min() < 0 or np.prod((room + half) / top) < THRESHOLDS.wiped_share + SETTINGS.spare_share:
        return []
    ways = []
    for along in (0, 1):
        across = 1 - along
        gap = 2 * half[across] * SETTINGS.lanes_share
        lanes = np.linspace(-room[across], room[across], 1 + int(np.ceil(2 * room[across] / gap)))
        lanes = np.repeat(lanes, 2) if len(lanes) == 1 else lanes  # to and fro
        found = [np.zeros(2) for _ in range(2 * len(lanes))]
        for number, (lane, end) in enumerate(product(lanes, (0, 1))):
            side = 1 if (number // 2 + end) % 2 else -1
            found[number][along], found[number][across] = side * room[along], lane
        ways.append(found)
    return min(ways, key=lambda way: float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum()))


def farthest(way: Sequence[Pose]) -> int:
    """The number of the pose on a way that is farthest from its first one."""
    return int(np.argmax([np.linalg.norm(pose.p - way[0].p) for pose in way]))


def free_wiping_ways(
    tool: SceneObject, thing: SceneObject, others: Sequence[SceneObject]
) -> tuple[list[list[Pose]], SceneObject | None]:
    """The ways of :func:`wiping_ways` with room around them; and what is in the way where there are none.

    Args:
        tool, thing: as there.
        others: all other objects, where they are.
    """
    bodies, in_the_way, free = {o.id: Body(o.asset.model, o.pose, o.joints) for o in others}, None, []
    for low, way in zip(wiping_ways(tool, thing, above_m=0.0), wiping_ways(tool, thing), strict=True):
        near = (
            first_near(Body(tool.asset.model, pose, tool.joints), bodies, SETTINGS.clearance_m) for pose in [*low, *way]
        )
        name = next(filter(None, near), None)
        if name is None:
            free.append(way)
        in_the_way = in_the_way or next((o for o in others if o.id == name), None)
    return free, None if free else in_the_way
