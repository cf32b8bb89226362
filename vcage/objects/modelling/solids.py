"""Solids as :class:`trimesh.Trimesh`: boxes, rounded boxes, prisms, bodies of revolution, sweeps and cuts.

All watertight, z up, in metres. Booleans go through manifold3d, so that cuts stay watertight.
"""

from __future__ import annotations

import manifold3d
import numpy as np
import trimesh
from numpy.typing import ArrayLike

Solid = trimesh.Trimesh


def box(size: ArrayLike, bottom: ArrayLike = (0.0, 0.0, 0.0)) -> Solid:
    """A box whose bottom face is centred at ``bottom``."""
    size = np.asarray(size, dtype=np.float64)
    solid = trimesh.creation.box(size)
    solid.apply_translation(np.add(bottom, (0, 0, size[2] / 2)))
    return solid


def rounded_box(size: ArrayLike, radius: float, bottom: ArrayLike = (0.0, 0.0, 0.0), steps: int = 3) -> Solid:
    """A box with all edges rounded; ``steps`` facets per quarter turn.

    Args:
        size: (3,) metres.
        radius: of the edges.
        bottom: (3,) where the middle of the bottom face lies.
        steps: facets per quarter turn.
    """
    size, bottom = np.asarray(size, dtype=np.float64), np.asarray(bottom, dtype=np.float64)
    radius = min(radius, size.min() / 2 * 0.999)
    angle = np.linspace(0, np.pi / 2, steps + 1)
    octant = np.array([(np.cos(a) * np.cos(b), np.cos(a) * np.sin(b), np.sin(a)) for a in angle for b in angle])
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
    points = signs[:, None] * (octant * radius + (size / 2 - radius))
    return trimesh.convex.convex_hull(points.reshape(-1, 3) + bottom + (0, 0, size[2] / 2))


def prism(outline: ArrayLike, height: float, z: float = 0.0) -> Solid:
    """A polygon (n, 2), counter-clockwise, raised by ``height`` from ``z``.

    Args:
        outline: (n, 2), counter-clockwise.
        height: metres.
        z: of the bottom.
    """
    raised = manifold3d.Manifold.extrude(manifold3d.CrossSection([np.asarray(outline, dtype=np.float64)]), height)
    return _from_manifold(raised.translate([0, 0, z]))


def rounded_rectangle(size: ArrayLike, radius: float, steps: int = 4) -> np.ndarray:
    """Outline (n, 2), counter-clockwise, of a rectangle around the origin with round corners.

    Args:
        size: (2,) metres.
        radius: of the corners.
        steps: sides per corner.
    """
    half = np.asarray(size, dtype=np.float64) / 2 - radius
    quarter = np.linspace(0, np.pi / 2, steps + 1)
    corners = [(1, 1), (-1, 1), (-1, -1), (1, -1)]
    return np.concatenate(
        [
            half * corner
            + radius * np.stack([np.cos(quarter + i * np.pi / 2), np.sin(quarter + i * np.pi / 2)], axis=1)
            for i, corner in enumerate(corners)
        ]
    )


def circle(radius: float, count: int = 32, centre: ArrayLike = (0.0, 0.0)) -> np.ndarray:
    """Outline (count, 2), counter-clockwise.

    Args:
        radius: metres.
        count: of corners.
        centre: (2,).
    """
    angle = np.arange(count) * 2 * np.pi / count
    return np.stack([np.cos(angle), np.sin(angle)], axis=1) * radius + np.asarray(centre)


def revolved(profile: ArrayLike, segments: int = 40) -> Solid:
    """A closed profile (n, 2) of radius and z, counter-clockwise, turned about the z axis."""
    profile = np.asarray(profile, dtype=np.float64)
    return _from_manifold(manifold3d.Manifold.revolve(manifold3d.CrossSection([profile]), segments))


def arc(centre: ArrayLike, radius: ArrayLike, start: float, end: float, count: int = 6) -> np.ndarray:
    """Points (count, 2) on an ellipse's arc between two angles in degrees; ``radius`` is one number or two.

    Args:
        centre: (2,).
        radius: one number, or (2,).
        start, end: degrees.
        count: of points.
    """
    angle = np.radians(np.linspace(start, end, count))
    return np.asarray(centre) + np.stack([np.cos(angle), np.sin(angle)], axis=1) * np.asarray(radius)


def sweep(path: ArrayLike, section: ArrayLike, scales: ArrayLike | None = None, up: ArrayLike = (0, 0, 1)) -> Solid:
    """A section carried along a path, with flat ends.

    Args:
        path: (n, 3) points; no segment may be parallel to ``up``.
        section: (k, 2) outline, counter-clockwise: first coordinate to the side, second upwards.
        scales: (n,) or (n, 2) factors of the section along the path.
    """
    path, section = np.asarray(path, dtype=np.float64), np.asarray(section, dtype=np.float64)
    count = len(path)
    scales = (
        np.ones((count, 2)) if scales is None else np.asarray(scales, dtype=np.float64).reshape(count, -1) * np.ones(2)
    )
    forward = np.gradient(path, axis=0)
    forward /= np.linalg.norm(forward, axis=1, keepdims=True)
    side = np.cross(forward, np.asarray(up, dtype=np.float64))
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    top = np.cross(side, forward)
    flat = section[None] * scales[:, None]  # (n, k, 2)
    rings = path[:, None] + flat[..., :1] * side[:, None] + flat[..., 1:] * top[:, None]
    return closed_rings(rings)


def closed_rings(rings: ArrayLike) -> Solid:
    """A solid through rings (n, k, 3) of k points each, closed by a fan at both ends."""
    rings = np.asarray(rings, dtype=np.float64)
    count, k = rings.shape[:2]
    vertices = np.concatenate([rings.reshape(-1, 3), rings[[0, -1]].mean(axis=1)])
    i, j = np.meshgrid(np.arange(count - 1), np.arange(k), indexing="ij")
    a, b = (i * k + j).ravel(), (i * k + (j + 1) % k).ravel()
    walls = np.concatenate([np.stack([a, b, b + k], axis=1), np.stack([a, b + k, a + k], axis=1)])
    ring = np.arange(k)
    start = np.stack([np.full(k, count * k), (ring + 1) % k, ring], axis=1)
    last = (count - 1) * k
    end = np.stack([np.full(k, count * k + 1), last + ring, last + (ring + 1) % k], axis=1)
    solid = trimesh.Trimesh(vertices, np.concatenate([walls, start, end]), process=False)
    if solid.volume < 0:
        solid.invert()
    return solid


def ellipsoid(radii: ArrayLike, centre: ArrayLike = (0.0, 0.0, 0.0), count: int = 24) -> Solid:
    """An ellipsoid of ``count`` meridians.

    Args:
        radii: (3,) metres.
        centre: (3,).
        count: of meridians.
    """
    solid = trimesh.creation.uv_sphere(radius=1.0, count=[count // 2, count])
    solid.apply_scale(np.asarray(radii, dtype=np.float64))
    solid.apply_translation(centre)
    return solid


def moved(
    solid: Solid, offset: ArrayLike = (0.0, 0.0, 0.0), *, turn: float = 0.0, axis: ArrayLike = (0, 0, 1)
) -> Solid:
    """A copy, turned by ``turn`` degrees about ``axis`` through the origin, then shifted.

    Args:
        solid: to copy.
        offset: (3,) metres.
        turn: degrees.
        axis: (3,) of the turn.
    """
    out = solid.copy()
    out.apply_transform(trimesh.transformations.rotation_matrix(np.radians(turn), axis))
    out.apply_translation(offset)
    return out


def union(*solids: Solid) -> Solid:
    """All of them as one solid."""
    return _from_manifold(manifold3d.Manifold.batch_boolean([_to_manifold(s) for s in solids], manifold3d.OpType.Add))


def cut(solid: Solid, *tools: Solid) -> Solid:
    """The solid without the tools."""
    parts = [_to_manifold(s) for s in (solid, *tools)]
    return _from_manifold(manifold3d.Manifold.batch_boolean(parts, manifold3d.OpType.Subtract))


def above(solid: Solid, z: float) -> Solid:
    """Return the part of the solid above the height ``z``, closed by a flat bottom."""
    return _from_manifold(_to_manifold(solid).trim_by_plane([0.0, 0.0, 1.0], z))


def split_by_facing(solid: Solid) -> tuple[Solid, Solid]:
    """The faces of a hollow body of revolution that face away from the z axis, and those that face it or up."""
    outwards = np.einsum("ij,ij->i", solid.triangles_center[:, :2], solid.face_normals[:, :2]) > 0
    outwards |= solid.face_normals[:, 2] < -0.9
    outside, inside = solid.copy(), solid.copy()
    outside.update_faces(outwards)
    inside.update_faces(~outwards)
    return outside, inside


def displaced(solid: Solid, amplitude: float, wavelength: float, rng: np.random.Generator) -> Solid:
    """A copy whose surface is gently uneven: vertices move along their normals by up to about ``amplitude``.

    Args:
        solid: to copy.
        amplitude: metres.
        wavelength: of the waves, metres.
        rng: draws the waves.
    """
    out = solid.copy()
    waves = rng.normal(size=(8, 3)) * 2 * np.pi / wavelength
    phases = rng.uniform(0, 2 * np.pi, 8)
    height = np.sin(out.vertices @ waves.T + phases).mean(axis=1) * 2
    out.vertices = out.vertices + out.vertex_normals * (height * amplitude)[:, None]
    return out


def _to_manifold(solid: Solid) -> manifold3d.Manifold:
    mesh = manifold3d.Mesh64(np.asarray(solid.vertices, dtype=np.float64), np.asarray(solid.faces, dtype=np.uint64))
    mesh.merge()
    result = manifold3d.Manifold(mesh)
    if result.status() != manifold3d.Error.NoError:
        raise ValueError(f"not a closed solid: {result.status()}")
    return result


def _from_manifold(solid: manifold3d.Manifold) -> Solid:
    mesh = solid.to_mesh64()
    return trimesh.Trimesh(
        np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts, dtype=np.int64), process=False
    )
