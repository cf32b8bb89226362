"""Check the points of an annotation against the model, which the schema alone cannot."""

from __future__ import annotations

import logging
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from vcage.base.errors import DamagedFile, SchemaMismatch, mismatch
from vcage.base.placeholders import require_fetched
from vcage.objects.asset import Asset
from vcage.schema.asset import IMPORTED, Annotation

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class PointSettings:
    """Limits of a point's distance from the model.

    Args:
        max_outside_m: of the bounding box: a grasp may hold only an edge.
        max_below_m: how far a receiving surface may lie below the object's bottom.
    """

    max_outside_m: float = 0.02
    max_below_m: float = 0.001


SETTINGS = PointSettings()

GLB_HEADER = struct.Struct("<4sII")
"""Magic, version and length of a binary glTF file."""


def check_points(asset: Asset, path: Path) -> None:
    """Check an annotation against its model.

    Args:
        asset: with its model.
        path: of its ``asset.json``, which the complaint names.

    Raises:
        SchemaMismatch: the model has no extent, or a point names no part or lies off the object; names the field,
            the value, and the expected one.
    """
    _check_extent(asset, path)
    parts = [link.name for link in asset.model.links]
    for kind in ("contact_points", "functional_points"):
        for i, point in enumerate(getattr(asset.annotation, kind)):
            if point.link is not None and point.link not in parts:
                expected = f"one of {', '.join(parts)}" if parts else "none, for no part of it moves"
                raise _misfit(asset, path, f"{kind}.{i}.link", f"{point.link!r}; expected {expected}")
            if outside_by(asset.bounds, point.position) > SETTINGS.max_outside_m:
                raise _misfit(
                    asset,
                    path,
                    f"{kind}.{i}.position",
                    f"the point lies outside the object: {range_text(asset.bounds, point.position)}",
                )
    for i, point in enumerate(asset.annotation.functional_points):
        if point.position[2] < asset.bounds[0, 2] - SETTINGS.max_below_m:
            text = f"the point lies {-point.position[2]:.3g} m under the table; expected a height from 0"
            raise _misfit(asset, path, f"functional_points.{i}.position", text)


def check_meshes(asset: Asset) -> None:
    """Read all collision pieces, and the first bytes of the visual meshes: whole files would take too long.

    For imports the pictures' sizes are read too, as others may have changed them since.

    Raises:
        DamagedFile: a mesh of the model does not load.
        OversizedFile: a texture is too large to be read.
    """
    for visual in (asset.model.visual, *(link.visual for link in asset.model.links)):
        require_fetched(Path(visual))
        try:
            with open(visual, "rb") as handle:
                magic, _, length = GLB_HEADER.unpack(handle.read(GLB_HEADER.size))
            whole = magic == b"glTF" and length == Path(visual).stat().st_size
        except (OSError, struct.error) as error:
            raise _broken(visual, str(error)) from error
        if not whole:
            raise _broken(visual, "expected a whole binary glTF file")
        if asset.annotation.source in IMPORTED:
            from vcage.objects.mesh_files import report_unseen_textures  # imports trimesh, which is slow

            report_unseen_textures(Path(visual), logger.warning)
    for link in (None, *(link.name for link in asset.model.links)):
        asset.pieces_of(link)  # reads them


def check_size(annotation: Annotation, variant: str, path: Path) -> None:
    """Check the target size of a package's model before it is scaled.

    Args:
        variant: id.
        path: of the ``asset.json``, which the complaint names.

    Raises:
        SchemaMismatch: an edge is not longer than 0; names the field.
    """
    for i, entry in enumerate(annotation.variants):
        size = entry.package.size if entry.id == variant and entry.package is not None else None
        for axis, edge in enumerate(size or ()):
            if edge <= 0:
                field = f"variants.{i}.package.size.{axis}"
                raise _complaint(path, field, f"got {edge:g}; expected a length above 0, metres", variant)


def outside_by(bounds: np.ndarray, position: ArrayLike) -> float:
    """Return the distance of a point from a box (2, 3), metres; 0 inside."""
    position = np.asarray(position, dtype=np.float64)
    return float(np.linalg.norm(np.maximum(bounds[0] - position, 0) + np.maximum(position - bounds[1], 0)))


def range_text(bounds: np.ndarray, position: ArrayLike) -> str:
    """Describe a point and its expected range, for an error."""
    value = ", ".join(f"{x:.3f}" for x in np.asarray(position))
    ranges = ", ".join(
        f"{lower - SETTINGS.max_outside_m:.3f} … {upper + SETTINGS.max_outside_m:.3f}" for lower, upper in bounds.T
    )
    return f"got ({value}); expected within ({ranges}) m"


def _check_extent(asset: Asset, path: Path) -> None:
    if asset.size.min() > 0:
        return
    name = f"variants.{[v.id for v in asset.annotation.variants].index(asset.variant.painted or asset.variant.id)}"
    size = ", ".join(f"{x:g}" for x in asset.size)
    raise _misfit(asset, path, name, f"the model measures ({size}) m; expected edge lengths above 0")


def _broken(path: str, reason: str) -> DamagedFile:
    return DamagedFile(
        f"{path} is not a mesh that loads: {reason}",
        hint="delete the folder it lies in; it is made again on demand, an imported object by importing it again",
    )


def _misfit(asset: Asset, path: Path, field: str, message: str) -> SchemaMismatch:
    return _complaint(path, field, message, asset.variant.id)


def _complaint(path: Path, field: str, message: str, variant: str) -> SchemaMismatch:
    hint = "fix the field, or the model that it was measured on"
    return mismatch(path, field, f"{message} (variant {variant!r})", hint, variant=variant)
