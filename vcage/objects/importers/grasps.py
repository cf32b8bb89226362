"""Search for grasps from above, for objects without annotated contact points.

The shape is known by its convex pieces. A try closes the fingers along x or y at a place of a grid and is kept when the
material fits between them, and neither the fingers on their way down nor the palm above meet anything. How large hand
and fingers are is the robot's (:class:`vcage.schema.robot.Gripper`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.objects.convex import Convex
from vcage.objects.openings import grasped_width, material_along
from vcage.schema.asset import ContactPoint
from vcage.schema.robot import Gripper


@dataclass(frozen=True)
class GraspSearchSettings:
    """Settings of the search for grasps from above.

    Args:
        min_width_m: of the material between the fingers.
        finger_room_m: how much wider than the material the fingers open at least.
        palm_room_m: clearance under the palm.
        best_depth_m: of a grasp under the top of the material.
        min_depth_m: of a grasp under the top of the material.
        step_m: distance between tries, across.
        level_m: distance between tries, in height.
        spacing_m: distance between the points that sample a shape's surface.
    """

    min_width_m: float = 0.008
    finger_room_m: float = 0.01
    palm_room_m: float = 0.001
    best_depth_m: float = 0.025
    min_depth_m: float = 0.005
    step_m: float = 0.006
    level_m: float = 0.003
    spacing_m: float = 0.0025


SETTINGS = GraspSearchSettings()

AXES = {"fingers left and right": (1.0, 0.0, 0.0), "fingers front and back": (0.0, 1.0, 0.0)}


@dataclass(frozen=True)
class GraspFromAbove:
    """One way to grasp a shape from above.

    Args:
        name: how the fingers lie.
        position: point between the finger tips, in the object frame, metres.
        closing: axis along which they close.
        width: of the material between them, metres.
    """

    name: str
    position: np.ndarray
    closing: np.ndarray
    width: float


def widest(gripper: Gripper) -> float:
    """Return the largest width of material that fits between the fingers, metres."""
    return gripper.max_width - SETTINGS.finger_room_m


def contact_points_from_above(pieces: Sequence[Convex], gripper: Gripper) -> list[ContactPoint]:
    """At most four contact points from above: the best of each closing axis, then another of each."""
    surface = surface_points(pieces)
    per_axis = [_apart(grasps_along(pieces, surface, name, gripper), gripper.finger_width) for name in AXES]
    found = [grasps[rank] for rank in (0, 1) for grasps in per_axis if rank < len(grasps)]
    return [
        ContactPoint(
            id=number,
            name=grasp.name,
            position=tuple(float(x) for x in grasp.position.round(4)),
            approach=(0.0, 0.0, -1.0),
            closing=tuple(float(x) for x in grasp.closing),
        )
        for number, grasp in enumerate(found)
    ]


def grasps_along(pieces: Sequence[Convex], surface: np.ndarray, name: str, gripper: Gripper) -> list[GraspFromAbove]:
    """Grasps that close along one of :data:`AXES`: near the middle and a little under the top come first.

    Args:
        pieces: the shape.
        surface: (n, 3) points all over the pieces, for detecting obstacles.
        name: of the axis.
        gripper: what grasps.
    """
    closing = np.array(AXES[name])
    across = 1 - int(np.argmax(closing))
    lower, upper = surface.min(axis=0), surface.max(axis=0)
    middle = (lower + upper) / 2
    found: list[GraspFromAbove] = []
    for v in _grid(lower[across] + SETTINGS.step_m, upper[across] - SETTINGS.step_m):
        for z in np.arange(lower[2] + gripper.tip_depth + 0.001, upper[2], SETTINGS.level_m):
            start = middle.copy()
            start[across], start[2] = v, z
            found += _on_line(pieces, start, closing, name, widest(gripper))
    costs = [(_cost(surface, grasp, middle, gripper.finger_width), grasp) for grasp in found]
    costs = [(cost, grasp) for cost, grasp in costs if np.isfinite(cost)]
    ordered = [grasp for _, grasp in sorted(costs, key=lambda pair: (pair[0], tuple(pair[1].position)))]
    return [grasp for grasp in ordered if is_free(surface, grasp, gripper) and _is_steady(pieces, grasp)]


def _on_line(
    pieces: Sequence[Convex], start: np.ndarray, closing: np.ndarray, name: str, widest: float
) -> list[GraspFromAbove]:
    """Every stretch of material on a line, and all of them together, that fits between the fingers."""
    stretches = material_along(pieces, start, closing)
    if len(stretches) > 1:
        stretches = [*stretches, (stretches[0][0], stretches[-1][1])]
    return [
        GraspFromAbove(name, start + closing * (begin + end) / 2, closing, end - begin)
        for begin, end in stretches
        if SETTINGS.min_width_m <= end - begin <= widest
    ]


def _cost(surface: np.ndarray, grasp: GraspFromAbove, middle: np.ndarray, finger_width: float) -> float:
    """Metres off the middle, and off the best depth under the top of the material there; infinite at its very top."""
    near = np.abs(surface[:, :2] - grasp.position[:2]).max(axis=1) < max(finger_width, grasp.width) / 2
    top = surface[near, 2].max() if near.any() else grasp.position[2]
    if top - grasp.position[2] < SETTINGS.min_depth_m:
        return np.inf
    aside = np.linalg.norm(grasp.position[:2] - middle[:2])
    return round(float(aside + abs(top - SETTINGS.best_depth_m - grasp.position[2])), 4)


def _is_steady(pieces: Sequence[Convex], grasp: GraspFromAbove) -> bool:
    """True if the material has the measured width (gaps may hide some), and about the same over a finger's width."""
    position, across = grasp.position.round(4), np.cross([0.0, 0.0, 1.0], grasp.closing)
    widths = [grasped_width(pieces, position + side * across, grasp.closing) for side in (0, -0.006, 0.006)]
    return abs(widths[0] - grasp.width) < 0.002 and all(abs(width - grasp.width) < 0.012 for width in widths)


def is_free(surface: np.ndarray, grasp: GraspFromAbove, gripper: Gripper) -> bool:
    """True if the shape leaves free the places of fingers and palm of a gripper from above.

    Args:
        surface: (n, 3) points all over the shape.
        grasp: of it.
        gripper: what grasps; its frame's x lies across closing, its y along it.
    """
    across = np.cross([0.0, 0.0, 1.0], grasp.closing)
    offset = surface - grasp.position
    u, v, z = np.abs(offset @ grasp.closing), np.abs(offset @ across), offset[:, 2]
    palm_width, palm_length = gripper.palm_size
    palm = (u < palm_length / 2) & (v < palm_width / 2) & (z > gripper.finger_length - SETTINGS.palm_room_m)
    outside = (u > grasp.width / 2 + 0.002) & (u < grasp.width / 2 + gripper.finger_thickness)
    fingers = outside & (v < gripper.finger_width / 2) & (z > -gripper.tip_depth)
    return not bool(np.any(palm | fingers))


def surface_points(pieces: Sequence[Convex]) -> np.ndarray:
    """(n, 3) points on the edges and in the inside of the pieces, about ``spacing_m`` apart."""
    points = [piece.vertices for piece in pieces]
    for piece in pieces:
        a, b = piece.vertices[piece.edges[:, 0]], piece.vertices[piece.edges[:, 1]]
        count = int(np.ceil(np.linalg.norm(b - a, axis=1).max() / SETTINGS.spacing_m)) + 1
        share = np.linspace(0, 1, count)[:, None, None]
        ladder = a + share * (b - a)
        points.append(ladder.reshape(-1, 3))
        centre = piece.vertices.mean(axis=0)
        points += [centre + share * (ladder.reshape(-1, 3) - centre) for share in (0.35, 0.7)]
    together = np.concatenate(points)
    cells = ((together - together.min(axis=0)) / SETTINGS.spacing_m).round().astype(np.int64)
    return together[np.unique(cells @ np.array([1, 1 << 20, 1 << 40]), return_index=True)[1]]


def _apart(grasps: Sequence[GraspFromAbove], distance: float) -> list[GraspFromAbove]:
    """The first grasp and another at least so far from it, if there is one."""
    first = list(grasps[:1])
    others = [g for g in grasps[1:] if np.linalg.norm(g.position - first[0].position) >= distance]
    return first + others[:1]


def _grid(low: float, high: float) -> list[float]:
    """Places from ``low`` to ``high``, one of them in the middle."""
    middle, half = (low + high) / 2, max((high - low) / 2, 0.0)
    count = int(half / SETTINGS.step_m)
    return [middle + step * SETTINGS.step_m for step in range(-count, count + 1)]
