"""RoboTwin's frames as contact points and functional points of ours.

Grasp frame (docs of RoboTwin): R_contact · [[0, 0, 1], [-1, 0, 0], [0, -1, 0]], so the gripper moves along -y of the
contact frame and its fingers close along -z. The z axis of a functional frame points into the target, and placing
brings the z axes of two objects together: on the receiving object it points down into the surface. A frame that
points out of its own object (a hammer's head, the foot of a block) is one by which the object itself is placed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.objects.colour_words import colour_word
from vcage.objects.convex import Convex
from vcage.objects.importers.converted import Converted, centred, check_scale, pieces_by_part
from vcage.objects.importers.robotwin_data import ModelData, RawPoint
from vcage.objects.modelling.parts import BuiltObject
from vcage.objects.points import SETTINGS as POINTS
from vcage.objects.points import outside_by, range_text
from vcage.schema.asset import ContactPoint, FunctionalPoint, Holds, Variant


@dataclass(frozen=True)
class SurfaceSettings:
    """Settings of the surface under a functional point, and of the walls around it.

    Args:
        vertical_cosine: from which an axis counts as vertical.
        max_below_m: how far below the point its surface may lie.
        max_above_m: how far above the point its surface may lie.
        min_headroom_m: free height over the floor of a receptacle.
        wall_heights_m: heights over the floor to search for walls.
        deep_m: objects lie 'in' a receptacle with walls of this height, 'on' others;
        steep_share: or with walls of this share of its width.
        directions: to search for walls.
    """

    vertical_cosine: float = 0.9
    max_below_m: float = 0.02
    max_above_m: float = 0.01
    min_headroom_m: float = 0.02
    wall_heights_m: tuple[float, ...] = (0.03, 0.02, 0.015, 0.01)
    deep_m: float = 0.03
    steep_share: float = 0.2
    directions: int = 8


SETTINGS = SurfaceSettings()


@dataclass(frozen=True)
class Placed:
    """A point in the object frame.

    Args:
        raw: as it was written.
        position: (3,) metres.
        rotation: (3, 3) of its frame.
        link: the moving part that it sits on, in our names.
    """

    raw: RawPoint
    position: np.ndarray
    rotation: np.ndarray
    link: str | None


def scaled_point(model: ModelData, raw: RawPoint, frame: np.ndarray, link: str | None) -> Placed:
    """A point of a variant whose scale is known.

    Args:
        frame: (4, 4) from the mesh's or link's frame, scaled, to the object frame.
    """
    local = raw.matrix.copy()
    local[:3, 3] *= model.scale
    world = frame @ local
    return Placed(raw, world[:3, 3], world[:3, :3], link)


def converted_variant(
    identifier: str,
    built: BuiltObject,
    model: ModelData,
    place: Callable[[Sequence[RawPoint], np.ndarray], list[Placed]],
) -> Converted:
    """A variant with its origin at the centre of the bottom, and with its points.

    Args:
        identifier: of the variant.
        built: its geometry in metres, wherever its origin lies.
        model: its annotation.
        place: brings points into the object frame, whose origin (3,) it is given.

    Raises:
        SchemaMismatch: the object is too small or too large for a table.
    """
    check_scale(model.file.path, built, model.scale_assumed)
    built, origin = centred(built)
    bounds = built.bounds
    return Converted(
        Variant(id=identifier, colour=colour_word([part for body in (built, *built.moving) for part in body.parts])),
        built,
        contact_points(place(model.contacts, origin), bounds, model),
        functional_points(place(model.functionals, origin), pieces_by_part(built), bounds, model),
        model.description,
    )


def contact_points(points: Sequence[Placed], bounds: np.ndarray, model: ModelData) -> list[ContactPoint]:
    """Grasps; one outside the object, or out of a hand's reach over the table, is left out with a warning.

    Args:
        bounds: (2, 3) of the object.
    """
    out = []
    for point in points:
        if outside_by(bounds, point.position) > POINTS.max_outside_m:
            model.file.warn(point.raw.field, f"lies outside the object: {range_text(bounds, point.position)}: left out")
            continue
        if why := _through_table(point, float(bounds[0, 2])):
            model.file.warn(point.raw.field, f"{why}: left out")
            continue
        out.append(
            ContactPoint(
                id=point.raw.index,
                name=point.raw.text or f"grasp {point.raw.index}",
                position=_vector(point.position),
                approach=_vector(_unit(-point.rotation[:, 1])),
                closing=_vector(_unit(-point.rotation[:, 2])),
                link=point.link,
            )
        )
    return out


def _through_table(point: Placed, table: float, min_finger_length_m: float = 0.037, max_depth_m: float = 0.001) -> str:
    """Why no hand reaches a grasp of an object that stands on the table; empty where one does.

    Args:
        table: its height, metres.
        min_finger_length_m: of the robots here, dual_panda has the shortest fingers; the palm lies behind them.
        max_depth_m: how far under the table a point may lie, as annotations are rounded.
    """
    height, up = float(point.position[2]) - table, float(-point.rotation[2, 1])
    if height < -max_depth_m:
        return f"lies {-height * 100:.1f} cm below the bottom, under the table"
    if height - max(up, 0.0) * min_finger_length_m < -max_depth_m:
        return f"is grasped from below, {height * 100:.1f} cm over the bottom: the hand would be under the table"
    return ""


def functional_points(
    points: Sequence[Placed], pieces: Mapping[str | None, Sequence[Convex]], bounds: np.ndarray, model: ModelData
) -> list[FunctionalPoint]:
    """Receptacles, each put on its surface; other frames are left out with a warning.

    Args:
        pieces: collision shape by moving part.
        bounds: (2, 3) of the object.
    """
    out = []
    for point in points:
        floor, complaint = _floor(point, pieces[point.link], bounds)
        if complaint:
            model.file.warn(point.raw.field, f"{complaint}: left out")
            continue
        position = np.array([*point.position[:2], floor])
        holds = kind_of_room(pieces[point.link], position)
        out.append(
            FunctionalPoint(
                id=point.raw.index,
                name=point.raw.text or ("inside" if holds == "in" else "top"),
                holds=holds,
                position=_vector(position),
                axis=_vector(_unit(-point.rotation[:, 2])),
                link=point.link,
            )
        )
    return out


def _floor(point: Placed, pieces: Sequence[Convex], bounds: np.ndarray) -> tuple[float, str]:
    """Height of the surface of a functional point, or why it is no receptacle."""
    under = point.position[2] < bounds[0, 2] - POINTS.max_below_m
    if under or outside_by(bounds, point.position) > POINTS.max_outside_m:
        return 0.0, f"lies under or outside the object: {range_text(bounds, point.position)}"
    into = point.rotation[2, 2]
    if into > -SETTINGS.vertical_cosine:
        upwards = into > SETTINGS.vertical_cosine
        way = "up and out of the object" if upwards else "sideways out of the object, as a tool's does"
        return 0.0, f"no receptacle: its z axis points {way}"
    spans = _material(pieces, point.position, (0.0, 0.0, 1.0))
    tops = [end for _, end in spans if -SETTINGS.max_below_m <= end <= SETTINGS.max_above_m]
    free = [t for t in tops if not any(end > t + 1e-4 and start < t + SETTINGS.min_headroom_m for start, end in spans)]
    if free:
        return float(point.position[2] + min(free, key=abs)), ""
    if any(start - SETTINGS.max_above_m <= 0 < end for start, end in spans):
        return 0.0, "no receptacle: it lies in or under the object's own material, as the frame of a foot does"
    return 0.0, f"no receptacle: no surface within {SETTINGS.max_below_m * 100:g} cm below it"


def kind_of_room(pieces: Sequence[Convex], position: np.ndarray) -> Holds:
    """'in' where walls rise all around over the floor point ``position``, 'on' elsewhere; a plate's rim is no wall."""
    angles = np.arange(SETTINGS.directions) * 2 * np.pi / SETTINGS.directions
    rays = np.stack([np.cos(angles), np.sin(angles), np.zeros(SETTINGS.directions)], axis=1)
    for height in SETTINGS.wall_heights_m:
        start = position + (0.0, 0.0, height)
        away = np.array([_first_hit(_material(pieces, start, ray)) for ray in rays])
        width = (away[: SETTINGS.directions // 2] + away[SETTINGS.directions // 2 :]).min()
        if np.isfinite(away).all() and (height >= SETTINGS.deep_m or height >= SETTINGS.steep_share * width):
            return "in"
    return "on"


def _first_hit(spans: Sequence[tuple[float, float]]) -> float:
    """Return the distance from a ray's origin to the first material; infinite where there is none."""
    return min((max(start, 0.0) for start, end in spans if end > 0), default=np.inf)


def _material(pieces: Sequence[Convex], origin: np.ndarray, axis: Sequence[float]) -> list[tuple[float, float]]:
    return [span for piece in pieces if (span := piece.interval(origin, axis)) is not None]


def same_points(a: Sequence[ContactPoint | FunctionalPoint], b: Sequence[ContactPoint | FunctionalPoint]) -> bool:
    """True if two variants can share their points: within 3 mm and 5 degrees."""
    return len(a) == len(b) and all(_same(x, y) for x, y in zip(a, b))


def _same(a: ContactPoint | FunctionalPoint, b: ContactPoint | FunctionalPoint) -> bool:
    axes = ("approach", "closing") if isinstance(a, ContactPoint) else ("axis",)
    alike = all(getattr(a, x, None) == getattr(b, x, None) for x in ("id", "link", "holds"))
    near = np.linalg.norm(np.subtract(a.position, b.position)) < 0.003
    return alike and bool(near) and all(np.dot(getattr(a, x), getattr(b, x)) > 0.996 for x in axes)


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector)


def _vector(values: np.ndarray) -> tuple[float, float, float]:
    x, y, z = (round(float(value), 6) + 0.0 for value in values)
    return x, y, z
