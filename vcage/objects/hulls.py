"""Convex pieces for a fetched mesh: the collision shape that our own builders make by hand.

Connected parts of the mesh that are nearly convex become one piece each, if they are few. The rest goes through V-HACD,
which fills the mesh with small cubes and splits them until the pieces fit (Mamou 2016). Unlike a splitting of the mesh
itself it needs no closed surface, and it takes a second or two. Containers stay open, since the cubes fill walls and
not the room between them. The pieces are kept in the cache under the hash of the mesh.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np
import trimesh
import vhacdx
from scipy.spatial import ConvexHull, KDTree

from vcage.base.files import atomic_path, cache_path
from vcage.objects.convex import Convex


@dataclass(frozen=True)
class HullSettings:
    """Settings of the decomposition into convex pieces.

    Args:
        max_pieces: of one mesh.
        max_parts: a mesh of more connected parts is loose triangles rather than parts.
        max_corners: of one piece; PhysX takes at most 255.
        cubes: small cubes that fill the mesh; four times as many take four times as long for a hardly better
            fit.
        volume_error_percent: by which a piece may exceed its cubes before it is split again.
        nearly_convex_m: distance of a part's convex hull from its surface up to which the hull is used.
        min_thickness_m: flatter points are thickened to this, because a piece needs a volume.
        covered_m: how far a part may stand out of the other pieces to need no piece of its own.
        growth_m: by which each of several pieces grows: V-HACD leaves gaps of up to a millimetre between
            neighbours.
        foot_m: corners this near the table stand on it. A round object on a corner would never come to rest,
            and the pieces of V-HACD are uneven by as much.
    """

    max_pieces: int = 40
    max_parts: int = 200
    max_corners: int = 48
    cubes: int = 100_000
    volume_error_percent: float = 0.5
    nearly_convex_m: float = 0.0015
    min_thickness_m: float = 0.001
    covered_m: float = 0.0005
    growth_m: float = 0.0006
    foot_m: float = 0.001


SETTINGS = HullSettings()

_RECIPE = "/".join(map(str, (1, *astuple(SETTINGS)[:8])))
"""Part of the cache's key: the settings that decide the stored pieces; growth and foot are applied later."""


def convex_pieces(corners: np.ndarray) -> list[trimesh.Trimesh]:
    """Convex, watertight meshes whose union is about the solid of some triangles.

    Args:
        corners: (m, 3, 3) metres; the surface need not be closed.
    """
    digest = hashlib.sha256(_RECIPE.encode() + np.ascontiguousarray(corners.round(6)).tobytes()).hexdigest()
    path = cache_path("hulls", f"{digest[:32]}.npz")
    if not path.is_file():
        _save(_decomposed(corners), path)
    with np.load(path) as data:
        pieces = [data[name] for name in data.files]
    if len(pieces) > 1:
        bounds = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
        pieces = [_levelled(_grown(piece).clip(*bounds), bounds[0][2]) for piece in pieces]
    else:
        pieces = [_footed(piece) for piece in pieces]
    return [trimesh.convex.convex_hull(piece) for piece in pieces]


def _levelled(points: np.ndarray, lowest: float) -> np.ndarray:
    """Corners of a piece, those less than ``foot_m`` above the mesh's lowest point put down to it."""
    if points[:, 2].max() < lowest + 2 * SETTINGS.foot_m:
        return points
    heights = np.where(points[:, 2] < lowest + SETTINGS.foot_m, lowest, points[:, 2])
    return np.column_stack([points[:, :2], heights])


def _footed(points: np.ndarray) -> np.ndarray:
    """Corners of a piece with a flat foot, as wide as the piece is ``foot_m`` above its lowest point."""
    lowest = points[:, 2].min()
    foot = Convex.of(points).shadow(lowest, lowest + SETTINGS.foot_m)
    return np.concatenate([points, np.column_stack([foot, np.full(len(foot), lowest)])])


def _grown(points: np.ndarray) -> np.ndarray:
    """Move the corners of a piece outwards by ``growth_m``."""
    outwards = points - points.mean(axis=0)
    return points + SETTINGS.growth_m * outwards / np.maximum(np.linalg.norm(outwards, axis=1, keepdims=True), 1e-9)


def _save(pieces: Sequence[np.ndarray], path: Path) -> None:
    with atomic_path(path) as part, open(part, "wb") as handle:
        np.savez(handle, **{f"piece-{i:02d}": piece for i, piece in enumerate(pieces)})


def _decomposed(corners: np.ndarray) -> list[np.ndarray]:
    """Corners (k, 3) of each piece."""
    bounds = np.stack([corners.min(axis=(0, 1)), corners.max(axis=(0, 1))])
    parts = _connected(corners)
    nearly_convex = [len(parts) <= SETTINGS.max_parts and _is_nearly_convex(part) for part in parts]
    distinct = _distinct([part for part, simple in zip(parts, nearly_convex) if simple])
    rest = [part for part, simple in zip(parts, nearly_convex) if not simple]
    if len(distinct) > (SETTINGS.max_pieces // 2 if rest else SETTINGS.max_pieces):
        distinct, rest = [], parts
    pieces = [part.reshape(-1, 3) for part in distinct]
    if rest:
        pieces += _split(np.concatenate(rest), SETTINGS.max_pieces - len(pieces))
    return [_solid(piece, bounds) for piece in pieces]


def _connected(corners: np.ndarray) -> list[np.ndarray]:
    """The triangles of each connected part, the largest part first."""
    mesh = _welded(corners)
    parts = trimesh.graph.connected_components(mesh.face_adjacency, nodes=np.arange(len(mesh.faces)), min_len=1)
    found = [np.asarray(mesh.triangles)[np.sort(part)] for part in parts]
    return sorted(found, key=_extent, reverse=True)


def _welded(corners: np.ndarray) -> trimesh.Trimesh:
    mesh = trimesh.Trimesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), process=False)
    mesh.merge_vertices(digits_vertex=6)
    mesh.update_faces(mesh.nondegenerate_faces())
    return mesh


def _extent(corners: np.ndarray) -> float:
    """Length of the diagonal of the bounding box."""
    return float(np.linalg.norm(np.ptp(corners.reshape(-1, 3), axis=0)))


def _is_nearly_convex(corners: np.ndarray) -> bool:
    """True if the surface of the convex hull stays near the part's own surface."""
    points = corners.reshape(-1, 3)
    if _extent(corners) < 2 * SETTINGS.nearly_convex_m:
        return True
    hull = trimesh.convex.convex_hull(_thickened(points))
    spacing = SETTINGS.nearly_convex_m / 2
    samples = _samples(_welded(corners), spacing)
    away = KDTree(samples).query(_samples(hull, 2 * spacing))[0]
    return float(np.percentile(away, 99)) <= SETTINGS.nearly_convex_m + spacing


def _samples(mesh: trimesh.Trimesh, spacing: float) -> np.ndarray:
    """Points of the surface about ``spacing`` apart; the same at every call."""
    count = int(np.clip(4 * mesh.area / spacing**2, 500, 60_000))
    return trimesh.sample.sample_surface(mesh, count, seed=0)[0]


def _distinct(parts: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Drop parts, in the order of their size, that earlier parts cover."""
    kept: list[np.ndarray] = []
    solids: list[Convex] = []
    for part in parts:
        points = part.reshape(-1, 3)
        if solids and min(float(solid.outside(points).max()) for solid in solids) <= SETTINGS.covered_m:
            continue
        kept.append(part)
        solids.append(Convex.of(_thickened(points)))
    return kept


def _split(corners: np.ndarray, most: int) -> list[np.ndarray]:
    """The pieces that V-HACD makes of a mesh."""
    mesh = _welded(corners)
    faces = np.hstack([np.full((len(mesh.faces), 1), 3), mesh.faces]).ravel().astype(np.uint32)
    pieces = vhacdx.compute_vhacd(  # pyrefly: ignore[missing-attribute]  # of a compiled module without stubs
        np.asarray(mesh.vertices, dtype=np.float64),
        faces,
        maxConvexHulls=most,
        resolution=SETTINGS.cubes,
        minimumVolumePercentErrorAllowed=SETTINGS.volume_error_percent,
        maxRecursionDepth=12,
        shrinkWrap=True,
        fillMode="flood",
        maxNumVerticesPerCH=SETTINGS.max_corners,
        asyncACD=False,  # threads would make the pieces' order a matter of chance
    )
    return [np.asarray(vertices) for vertices, _ in pieces]


def _solid(points: np.ndarray, bounds: np.ndarray) -> np.ndarray:
    """The corners (k, 3) of the hull of points, within the mesh's bounds, with a volume and with few corners."""
    points = _thickened(np.clip(points, bounds[0], bounds[1]))
    corners = points[ConvexHull(points).vertices]
    if len(corners) > SETTINGS.max_corners:
        corners = _spread(corners, SETTINGS.max_corners - 6)  # and the six of the bounding box
    return corners.round(6)


def _spread(points: np.ndarray, count: int) -> np.ndarray:
    """The extreme points in evenly spread directions: the corners that matter most for a hull."""
    k = np.arange(count)
    z, turn = 1 - (2 * k + 1) / count, np.pi * (3 - np.sqrt(5)) * k
    directions = np.column_stack([np.sqrt(1 - z**2) * np.cos(turn), np.sqrt(1 - z**2) * np.sin(turn), z])
    scaled = (points - points.mean(axis=0)) / np.maximum(np.ptp(points, axis=0), 1e-9)
    extremes = np.concatenate([np.argmax(scaled @ directions.T, axis=0), scaled.argmin(axis=0), scaled.argmax(axis=0)])
    return points[np.unique(extremes)]


def _thickened(points: np.ndarray) -> np.ndarray:
    """Thicken flat points with copies shifted along the flat direction."""
    centred = points - points.mean(axis=0)
    axes = np.linalg.svd(centred, full_matrices=False)[2]
    extents = np.ptp(centred @ axes.T, axis=0)
    for axis, extent in zip(axes, extents):
        if extent < SETTINGS.min_thickness_m:
            shift = axis * (SETTINGS.min_thickness_m - extent) / 2
            points = np.concatenate([points - shift, points + shift])
    return points
