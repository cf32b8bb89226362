"""A variant of a foreign object in our terms, before it is written."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

import numpy as np
import trimesh

from vcage.base.errors import mismatch
from vcage.objects.convex import Convex
from vcage.objects.modelling.parts import BuiltObject, MovingPart
from vcage.schema.asset import ContactPoint, FunctionalPoint, Variant

Body = TypeVar("Body", BuiltObject, MovingPart)


@dataclass(frozen=True)
class Converted:
    """One variant.

    Args:
        variant: its entry in the annotation.
        built: its geometry, with the origin at the centre of the bottom.
        contacts, functionals: its points.
        description: a sentence about it; may be empty.
    """

    variant: Variant
    built: BuiltObject
    contacts: list[ContactPoint]
    functionals: list[FunctionalPoint]
    description: str = ""


def estimated_mass(
    volume_m3: float, decimals: int = 4, density_kg_m3: float = 400.0, range_kg: tuple[float, float] = (0.02, 1.0)
) -> float:
    """Estimate kilograms from the volume of the material.

    Args:
        decimals: to which they are rounded.
        density_kg_m3: household things are hollow, or of wood and plastic.
        range_kg: of the estimate: an arm can carry it.
    """
    return round(float(np.clip(density_kg_m3 * volume_m3, *range_kg)), decimals)


def total_volume(hulls: Sequence[trimesh.Trimesh]) -> float:
    """Add the volumes of a collision shape's pieces, m³."""
    return sum(abs(float(hull.volume)) for hull in hulls)


def check_scale(path: Path, built: BuiltObject, assumed: bool, smallest: float = 0.005, largest: float = 2.0) -> None:
    """Refuse an object that is too small or too large for a table: its scale is in another unit than metres.

    Args:
        path: of the file with the scale.
        assumed: whether the scale is not in it.
        smallest, largest: longest edge of an object that stands on a table, metres.

    Raises:
        SchemaMismatch: names the size.
    """
    edges = np.ptp(built.bounds, axis=0)
    if not smallest <= edges.max() <= largest:
        said = "missing, and at scale 1" if assumed else "with it"
        size = " × ".join(f"{x:.3g}" for x in edges)
        raise mismatch(path, "scale", f"{said} the object would measure {size} m; expected {smallest} … {largest} m")


def centred(built: BuiltObject) -> tuple[BuiltObject, np.ndarray]:
    """The object with its origin at the centre of the bottom, and where that was before (3,)."""
    origin = built.bottom_centre
    moving = [_moved_part(part, origin) for part in built.moving]
    return replace(_moved(built, origin), moving=moving), origin


def _moved_part(part: MovingPart, origin: np.ndarray) -> MovingPart:
    position = tuple(float(x) for x in np.asarray(part.joint.origin) - origin)
    return replace(_moved(part, origin), joint=part.joint.model_copy(update={"origin": position}))


def _moved(body: Body, origin: np.ndarray) -> Body:
    """The body with its geometry in a frame of that origin."""
    parts = [replace(part, vertices=part.vertices - origin) for part in body.parts]
    hulls = [trimesh.Trimesh(hull.vertices - origin, hull.faces, process=False) for hull in body.hulls]
    return replace(body, parts=parts, hulls=hulls)


def pieces_by_part(built: BuiltObject) -> dict[str | None, list[Convex]]:
    """The collision shape of the body (None) and of each moving part."""
    hulls = {None: built.hulls, **{part.name: part.hulls for part in built.moving}}
    return {name: [Convex.of(hull.vertices) for hull in pieces] for name, pieces in hulls.items()}
