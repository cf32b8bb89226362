"""Simplify a fetched model, with its colours and pictures in place.

A surface is welded, its edges are collapsed by quadric error (Garland and Heckbert 1997), and the texture coordinates
of the new corners are read off the old surface, chart by chart, so that no triangle spans a seam of the picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import fast_simplification
import numpy as np
import trimesh
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from vcage.objects.packages.surfaces import MaterialSurface, welded

BARYCENTRIC = np.array([[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4], [3, 3, 1], [3, 1, 3], [1, 3, 3]], dtype=float)
"""Points of an old triangle that represent it in the search for the nearest."""


@dataclass(frozen=True)
class DecimationSettings:
    """Settings of the simplification.

    Args:
        max_triangles: of a converted model.
        aggressiveness: of the edge collapse, tried in turn: the gentlest that reaches the number of triangles keeps
            the shape best.
        shares: of ``max_triangles``, aimed at in turn: surfaces with many borders keep more triangles than they should.
        reversed_normal_m: distance that a reversed normal counts as in the search for the nearest old triangle, which
            tells the two sides of a thin wall apart.
    """

    max_triangles: int = 5900
    aggressiveness: tuple[int, ...] = (4, 7, 10)
    shares: tuple[float, ...] = (1.0, 0.9, 0.75, 0.5)
    reversed_normal_m: float = 0.004


SETTINGS = DecimationSettings()


def decimated(surfaces: Sequence[MaterialSurface], settings: DecimationSettings = SETTINGS) -> list[MaterialSurface]:
    """Simplify surfaces to at most ``max_triangles`` together, each in proportion to its triangles.

    Surfaces that collapse to nothing are left out.
    """
    total, most = sum(len(surface.corners) for surface in surfaces), settings.max_triangles
    if total <= most:
        return list(surfaces)
    fewer = list(surfaces)
    for share in settings.shares:
        goals = [max(12, int(share * len(surface.corners) * most / total)) for surface in surfaces]
        fewer = [_simplified(surface, goal, settings) for surface, goal in zip(surfaces, goals)]
        if sum(len(surface.corners) for surface in fewer) <= most:
            break
    return [surface for surface in fewer if len(surface.corners)]


def _simplified(surface: MaterialSurface, most: int, settings: DecimationSettings) -> MaterialSurface:
    mesh, kept = welded(surface.corners)
    if len(mesh.faces) <= most:
        return replace(surface, corners=surface.corners[kept], uv=None if surface.uv is None else surface.uv[kept])
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    for aggressiveness in settings.aggressiveness:
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
    """Return texture coordinates (n, 3, 2) of new triangles, read off the old ones.

    Args:
        old: (m, 3, 3) corners, metres.
        uv: (m, 3, 2) of the old corners.
        new: (n, 3, 3) corners, metres.
    """
    share = BARYCENTRIC / BARYCENTRIC.sum(axis=1, keepdims=True)
    samples = np.einsum("kc,mcx->mkx", share, old).reshape(-1, 3)
    owner = np.repeat(np.arange(len(old)), len(share))
    sided = np.hstack([samples, _normals(old)[owner] * SETTINGS.reversed_normal_m])
    nearest = KDTree(sided).query(np.hstack([new.mean(axis=1), _normals(new) * SETTINGS.reversed_normal_m]))[1]
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
