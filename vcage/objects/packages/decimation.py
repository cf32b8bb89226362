"""Fewer triangles for a fetched model, with its colours and pictures where they were.

A surface is welded, its edges are collapsed by quadric error (Garland and Heckbert 1997), and the texture coordinates
of the new corners are read off the old surface, chart by chart, so that no triangle spans a seam of the picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import fast_simplification
import numpy as np
import trimesh
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from vcage.objects.packages.surfaces import MaterialSurface, welded

AGGRESSIVENESS = (4, 7, 10)
"""Tried in turn: the gentlest that reaches the number of triangles asked for keeps the shape best."""

SHARES = (1.0, 0.9, 0.75, 0.5)
"""Of the number asked for, tried in turn: surfaces with many borders keep more triangles than they should."""

BARYCENTRIC = np.array(
    [[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4], [3, 3, 1], [3, 1, 3], [1, 3, 3]], dtype=float
)  # points of an old triangle that stand for it in the search for the nearest
SIDE_WEIGHT = 0.004
"""Metres that a reversed normal counts as when the nearest old triangle is looked for: both sides of a thin wall."""


def decimated(surfaces: Sequence[MaterialSurface], most: int) -> list[MaterialSurface]:
    """Surfaces of together at most ``most`` triangles; each gives in proportion to what it has.

    Surfaces that collapse to nothing are left out.
    """
    total = sum(len(surface.corners) for surface in surfaces)
    if total <= most:
        return list(surfaces)
    for share in SHARES:
        goals = [max(12, int(share * len(surface.corners) * most / total)) for surface in surfaces]
        fewer = [_simplified(surface, goal) for surface, goal in zip(surfaces, goals)]
        if sum(len(surface.corners) for surface in fewer) <= most:
            break
    return [surface for surface in fewer if len(surface.corners)]


def _simplified(surface: MaterialSurface, most: int) -> MaterialSurface:
    mesh, kept = welded(surface.corners)
    if len(mesh.faces) <= most:
        return replace(surface, corners=surface.corners[kept], uv=None if surface.uv is None else surface.uv[kept])
    for aggressiveness in AGGRESSIVENESS:
        vertices, faces = fast_simplification.simplify(
            np.asarray(mesh.vertices), np.asarray(mesh.faces), target_count=most, agg=aggressiveness
        )
        if len(faces) <= most:
            break
    corners = vertices[faces].astype(np.float64)
    corners = corners[trimesh.triangles.area(corners) > 1e-12]
    uv = None if surface.uv is None else transferred(surface.corners[kept], surface.uv[kept], corners)
    return replace(surface, corners=corners, uv=uv)


def transferred(old: np.ndarray, uv: np.ndarray, new: np.ndarray) -> np.ndarray:
    """Texture coordinates (n, 3, 2) of new triangles (n, 3, 3), read off the old ones (m, 3, 3) with uv (m, 3, 2).

    Args:
        old: (m, 3, 3) corners, metres.
        uv: (m, 3, 2) of the old corners.
        new: (n, 3, 3) corners, metres.
    """
    share = BARYCENTRIC / BARYCENTRIC.sum(axis=1, keepdims=True)
    samples = np.einsum("kc,mcx->mkx", share, old).reshape(-1, 3)
    owner = np.repeat(np.arange(len(old)), len(share))
    sided = np.hstack([samples, _normals(old)[owner] * SIDE_WEIGHT])
    nearest = KDTree(sided).query(np.hstack([new.mean(axis=1), _normals(new) * SIDE_WEIGHT]))[1]
    chart = _charts(old, uv)
    wanted = chart[owner[nearest]]
    out = np.empty((len(new), 3, 2))
    for number in np.unique(wanted):
        rows, own = np.flatnonzero(wanted == number), np.flatnonzero(chart[owner] == number)
        points = new[rows].reshape(-1, 3)
        faces = owner[own[KDTree(samples[own]).query(points)[1]]]
        closest = trimesh.triangles.closest_point(old[faces], points)
        weights = trimesh.triangles.points_to_barycentric(old[faces], closest)
        out[rows] = np.einsum("pc,pcx->px", weights, uv[faces]).reshape(-1, 3, 2)
    return out


def _normals(corners: np.ndarray) -> np.ndarray:
    """(m, 3) unit normals; zero for a triangle without area."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(across, axis=1, keepdims=True)
    return across / np.where(length > 0, length, 1.0)


def _charts(corners: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """(m,) number of the patch that each triangle's picture belongs to: joined where place and coordinates agree."""
    keys = np.concatenate([corners.round(6), uv.round(5)], axis=2).reshape(-1, 5)
    _, vertex = np.unique(keys, axis=0, return_inverse=True)
    face = np.repeat(np.arange(len(corners)), 3)
    shape = (len(corners), int(vertex.max()) + 1)
    incidence = csr_matrix((np.ones(len(face)), (face, vertex.ravel())), shape=shape)
    return connected_components(incidence @ incidence.T, directed=False)[1]
