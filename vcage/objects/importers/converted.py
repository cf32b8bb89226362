"""A variant of a foreign object in our terms, before it is written."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import trimesh

from vcage.objects.convex import Convex
from vcage.objects.importers.robotwin_data import mismatch
from vcage.objects.modelling.parts import BuiltObject, MovingPart, Part
from vcage.schema.asset import ContactPoint, FunctionalPoint, Variant


@dataclass(frozen=True)
class EstimateSettings:
    """Limits and estimates for objects whose files do not say.

    Args:
        density_kg_m3: of an object without a mass: household things are hollow, or of wood and plastic.
        edge_range_m: the longest edge of an object that stands on a table.
        min_mass_kg: of an estimated mass.
        max_mass_kg: of an estimated mass: an arm can carry it.
    """

    density_kg_m3: float = 400.0
    edge_range_m: tuple[float, float] = (0.005, 2.0)
    min_mass_kg: float = 0.02
    max_mass_kg: float = 1.0


SETTINGS = EstimateSettings()


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


def estimated_mass(volume_m3: float, decimals: int = 4) -> float:
    """Estimate kilograms from the volume of the material, rounded to some decimals."""
    mass = SETTINGS.density_kg_m3 * volume_m3
    return round(float(np.clip(mass, SETTINGS.min_mass_kg, SETTINGS.max_mass_kg)), decimals)


def total_volume(hulls: Sequence[trimesh.Trimesh]) -> float:
    """Add the volumes of a collision shape's pieces, m³."""
    return sum(abs(float(hull.volume)) for hull in hulls)


def check_scale(path: Path, built: BuiltObject, assumed: bool) -> None:
    """Refuse an object that is too small or too large for a table: its scale is in another unit than metres.

    Args:
        path: of the file with the scale.
        assumed: whether the scale is not in it.

    Raises:
        SchemaMismatch: names the size.
    """
    edges = np.ptp(built.bounds, axis=0)
    smallest, largest = SETTINGS.edge_range_m
    if not smallest <= edges.max() <= largest:
        said = "missing, and at scale 1" if assumed else "with it"
        size = " × ".join(f"{x:.3g}" for x in edges)
        raise mismatch(path, "scale", f"{said} the object would measure {size} m; expected {smallest} … {largest} m")


def centred(built: BuiltObject) -> tuple[BuiltObject, np.ndarray]:
    """The object with its origin at the centre of the bottom, and where that was before (3,)."""
    origin = built.bottom_centre
    moving = [_moved_part(part, origin) for part in built.moving]
    parts, hulls = _moved(built.parts, built.hulls, origin)
    return replace(built, parts=parts, hulls=hulls, moving=moving), origin


def _moved_part(part: MovingPart, origin: np.ndarray) -> MovingPart:
    parts, hulls = _moved(part.parts, part.hulls, origin)
    position = tuple(float(x) for x in np.asarray(part.joint.origin) - origin)
    return replace(part, parts=parts, hulls=hulls, joint=part.joint.model_copy(update={"origin": position}))


def _moved(
    parts: Sequence[Part], hulls: Sequence[trimesh.Trimesh], origin: np.ndarray
) -> tuple[list[Part], list[trimesh.Trimesh]]:
    solids = [trimesh.Trimesh(hull.vertices - origin, hull.faces, process=False) for hull in hulls]
    return [replace(part, vertices=part.vertices - origin) for part in parts], solids


def pieces_by_part(built: BuiltObject) -> dict[str | None, list[Convex]]:
    """The collision shape of the body (None) and of each moving part."""
    return {None: _for_measuring(built.hulls), **{part.name: _for_measuring(part.hulls) for part in built.moving}}


def _for_measuring(hulls: Sequence[trimesh.Trimesh]) -> list[Convex]:
    return [Convex.of(hull.vertices) for hull in hulls]
