"""Convex pieces for a fetched mesh: the collision shape that our own builders make by hand.

Connected parts of the mesh that are nearly convex become one piece each, if they are few. The rest goes through V-HACD,
which fills the mesh with small cubes and splits them until the pieces fit (Mamou 2016). Unlike a splitting of the mesh
itself it needs no closed surface, and it takes a second or two. Containers stay open, since the cubes fill walls and
not the room between them. The pieces are kept in the cache under the hash of the mesh.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import trimesh
import vhacdx
from scipy.spatial import ConvexHull, KDTree

from vcage.base.files import atomic_path, cache_path
from vcage.objects.convex import Convex

MOST_PIECES = 40
MOST_PARTS = 200
"""A mesh of more connected parts is loose triangles rather than parts."""

MOST_CORNERS = 48
"""Of one piece; PhysX takes at most 255."""

CUBES = 100_000
"""Small cubes that the mesh is filled with; four times as many take four times as long for a hardly better fit."""

VOLUME_ERROR = 0.5
"""Per cent by which a piece may exceed its cubes before it is split again."""

NEARLY_CONVEX = 0.0015
"""Metres that the convex hull of a part may stand off its surface to be taken as it is."""

THINNEST = 0.001
"""Metres: what is flatter is thickened to this, because a piece needs a volume."""

COVERED = 0.0005
"""Metres that a part may stand out of the other pieces to need no piece of its own."""

GROWTH = 0.0006
"""Metres by which every one of several pieces grows: V-HACD leaves gaps of up to a millimetre between neighbours."""

FOOT = 0.001
"""Metres: what is so near the table stands on it. A round thing on a corner would never come to rest, and the pieces of
V-HACD are uneven by as much."""

_RECIPE = f"1/{MOST_PIECES}/{MOST_PARTS}/{MOST_CORNERS}/{CUBES}/{VOLUME_ERROR}/{NEARLY_CONVEX}/{THINNEST}/{COVERED}"


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
    """Corners of a piece, those less than :data:`FOOT` above the mesh's lowest point put down to it."""
    if points[:, 2].max() < lowest + 2 * FOOT:
        return points
    heights = np.where(points[:, 2] < lowest + FOOT, lowest, points[:, 2])
    return np.column_stack([points[:, :2], heights])


def _footed(points: np.ndarray) -> np.ndarray:
    """Corners of a piece with a flat foot, as wide as the piece is :data:`FOOT` above its lowest point."""
    lowest = points[:, 2].min()
    foot = Convex.of(points).shadow(lowest, lowest + FOOT)
    return np.concatenate([points, np.column_stack([foot, np.full(len(foot), lowest)])])


def _grown(points: np.ndarray) -> np.ndarray:
    """Corners of a piece moved outwards by :data:`GROWTH`."""
    outwards = points - points.mean(axis=0)
    return points + GROWTH * outwards / np.maximum(np.linalg.norm(outwards, axis=1, keepdims=True), 1e-9)


def _save(pieces: Sequence[np.ndarray], path: Path) -> None:
    with atomic_path(path) as part, open(part, "wb") as handle:
        np.savez(handle, **{f"piece-{i:02d}": piece for i, piece in enumerate(pieces)})


def _decomposed(corners: np.ndarray) -> list[np.ndarray]:
    """Corners (k, 3) of each piece."""
    bounds = np.stack([corners.min(axis=(0, 1)), corners.max(axis=(0, 1))])
    parts = _connected(corners)
    nearly_convex = [len(parts) <= MOST_PARTS and _is_nearly_convex(part) for part in parts]
    distinct = _distinct([part for part, simple in zip(parts, nearly_convex) if simple])
    rest = [part for part, simple in zip(parts, nearly_convex) if not simple]
    if len(distinct) > (MOST_PIECES // 2 if rest else MOST_PIECES):
        distinct, rest = [], parts
    pieces = [part.reshape(-1, 3) for part in distinct]
    if rest:
        pieces += _split(np.concatenate(rest), MOST_PIECES - len(pieces))
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
    """Whether every point of the convex hull's surface is near the part's own surface."""
    points = corners.reshape(-1, 3)
    if _extent(corners) < 2 * NEARLY_CONVEX:
        return True
    hull = trimesh.convex.convex_hull(_thickened(points))
    spacing = NEARLY_CONVEX / 2
    samples = _samples(_welded(corners), spacing)
    away = KDTree(samples).query(_samples(hull, 2 * spacing))[0]
    return float(np.percentile(away, 99)) <= NEARLY_CONVEX + spacing


def _samples(mesh: trimesh.Trimesh, spacing: float) -> np.ndarray:
    """Points of the surface about ``spacing`` apart; the same at every call."""
    count = int(np.clip(4 * mesh.area / spacing**2, 500, 60_000))
    return trimesh.sample.sample_surface(mesh, count, seed=0)[0]


def _distinct(parts: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Of parts in the order of their size, those that stand out of the ones before."""
    kept: list[np.ndarray] = []
    solids: list[Convex] = []
    for part in parts:
        points = part.reshape(-1, 3)
        if solids and min(float(solid.outside(points).max()) for solid in solids) <= COVERED:
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
        resolution=CUBES,
        minimumVolumePercentErrorAllowed=VOLUME_ERROR,
        maxRecursionDepth=12,
        shrinkWrap=True,
        fillMode="flood",
        maxNumVerticesPerCH=MOST_CORNERS,
        asyncACD=False,  # threads would make the pieces' order a matter of chance
    )
    return [np.asarray(vertices) for vertices, _ in pieces]


def _solid(points: np.ndarray, bounds: np.ndarray) -> np.ndarray:
    """The corners (k, 3) of the hull of points, within the mesh's bounds, with a volume and with few corners."""
    points = _thickened(np.clip(points, bounds[0], bounds[1]))
    corners = points[ConvexHull(points).vertices]
    if len(corners) > MOST_CORNERS:
        corners = _spread(corners, MOST_CORNERS - 6)  # and the six of the bounding box
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
    """Points, joined by copies shifted along the direction in which they are flat, if they are."""
    centred = points - points.mean(axis=0)
    axes = np.linalg.svd(centred, full_matrices=False)[2]
    extents = np.ptp(centred @ axes.T, axis=0)
    for axis, extent in zip(axes, extents):
        if extent < THINNEST:
            shift = axis * (THINNEST - extent) / 2
            points = np.concatenate([points - shift, points + shift])
    return points
