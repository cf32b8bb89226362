"""Collision shapes of a mesh file: convex hulls of its connected components, as SAPIEN makes them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import trimesh
from scipy.spatial import ConvexHull, QhullError

from vcage.objects import hulls


@dataclass(frozen=True)
class ComponentSettings:
    """Settings of the hulls of components.

    Args:
        half_sheet_m: a flat component gets this thickness on either side; a solid needs some.
        weld_decimals: corners with coordinates, metres, equal to this number of decimals are the same.
        max_fast_pieces: more pieces slow the simulation down noticeably.
    """

    half_sheet_m: float = 0.0005
    weld_decimals: int = 7
    max_fast_pieces: int = 128


SETTINGS = ComponentSettings()


def joined(surfaces: Sequence[trimesh.Trimesh]) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (n, 3) and faces (m, 3) of all surfaces of a file: what materials cut apart is one component again."""
    vertices, faces = trimesh.util.append_faces([s.vertices for s in surfaces], [s.faces for s in surfaces])
    return np.asarray(vertices), np.asarray(faces)


def component_hulls(vertices: np.ndarray, faces: np.ndarray) -> list[trimesh.Trimesh]:
    """The convex hulls of the connected components of a surface; parts thinner than a sheet are left out.

    To SAPIEN, solids that touch in a corner are one component, whose hull fills every container that is put together
    of boards. Where the file keeps such solids apart, each closed in itself, each gets a hull of its own instead.

    Args:
        vertices: (n, 3), metres.
        faces: (m, 3) vertex indices.
    """
    places, index = np.unique(np.asarray(vertices).round(SETTINGS.weld_decimals), axis=0, return_inverse=True)
    welded = index.ravel()[faces]
    solids = _labels(faces, len(vertices))
    corners: dict[bytes, np.ndarray] = {}  # double-sided surfaces have the same corners twice
    for component in _groups(_labels(welded, len(places))):
        pieces = [component[group] for group in _groups(solids[component])]
        apart = len(pieces) > 1 and all(_is_closed(welded[piece]) for piece in pieces)
        for group in pieces if apart else [component]:
            numbers = np.unique(welded[group])
            corners[numbers.tobytes()] = places[numbers]
    found = (convex_hull(points) for points in corners.values())
    return [hull for hull in found if hull is not None]


def _labels(faces: np.ndarray, count: int) -> np.ndarray:
    """(m,) number of the component of each face; faces that share one of ``count`` vertices are connected."""
    edges = faces[:, [[0, 1], [1, 2]]].reshape(-1, 2)
    return trimesh.graph.connected_component_labels(edges, node_count=count)[faces[:, 0]]


def _groups(labels: np.ndarray) -> list[np.ndarray]:
    """Indices of equal labels, in the order of their first."""
    order = np.argsort(labels, kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(labels[order])) + 1) if len(labels) else []
    return sorted(groups, key=lambda group: group[0])


def _is_closed(faces: np.ndarray) -> bool:
    """True if every edge belongs to two faces."""
    edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    return bool((np.unique(edges, axis=0, return_counts=True)[1] == 2).all())


def hulls_of_surface(vertices: np.ndarray, faces: np.ndarray) -> list[trimesh.Trimesh]:
    """The collision shape of a surface that comes without one: containers stay open.

    Args:
        vertices, faces: as for :func:`component_hulls`.
    """
    corners = vertices[faces]
    if np.ptp(corners.reshape(-1, 3), axis=0).max() < 2 * SETTINGS.half_sheet_m:
        return []
    return hulls.convex_pieces(corners)


def convex_hull(points: np.ndarray) -> trimesh.Trimesh | None:
    """The convex hull of points (n, 3), made a sheet of ``half_sheet_m`` where they lie in a plane; None for a line."""
    centred = points - points.mean(axis=0)
    _, sizes, axes = np.linalg.svd(centred, full_matrices=False)
    if len(points) < 3 or sizes[1] < 1e-6:
        return None
    if np.ptp(centred @ axes[2]) < 2 * SETTINGS.half_sheet_m:
        points = np.concatenate([points - SETTINGS.half_sheet_m * axes[2], points + SETTINGS.half_sheet_m * axes[2]])
    try:
        hull = ConvexHull(points)
    except QhullError:
        return None
    corners = np.unique(hull.simplices)
    faces = np.searchsorted(corners, hull.simplices)
    solid = trimesh.Trimesh(hull.points[corners], faces, process=False)
    solid.fix_normals()
    return solid
