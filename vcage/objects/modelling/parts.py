"""The result of a builder: textured parts for rendering, convex pieces for physics.

A mesh here is a :class:`trimesh.Trimesh` of geometry only; :func:`paint` gives it a picture, texture
coordinates and normals. Normals are smooth across edges that are flatter than the crease angle.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csr_matrix

from vcage.schema.asset import Joint

if TYPE_CHECKING:
    import trimesh

Mapping = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""From corners (m, 3, 3) in metres and face normals (m, 3) to texture coordinates (m, 3, 2), v upwards."""


@dataclass(frozen=True)
class Part:
    """A textured surface.

    Args:
        vertices, normals: (n, 3) in the builder's frame, metres.
        uv: (n, 2) texture coordinates, (0, 0) at the lower left of the picture.
        faces: (m, 3) vertex indices.
        texture: (H, W, 3) uint8 RGB.
        roughness, metallic: of the glTF material, in [0, 1].
    """

    vertices: np.ndarray
    normals: np.ndarray
    uv: np.ndarray
    faces: np.ndarray
    texture: np.ndarray
    roughness: float
    metallic: float


@dataclass(frozen=True)
class MovingPart:
    """A part of an object that a joint moves, in the frame of the whole object with all joints at 0.

    Args:
        name: what contact and functional points call it: ``drawer_top``, ``lid``.
        parts: the visible shape.
        hulls: convex, watertight pieces; where they would touch a neighbour's, leave a gap of at least 1 mm.
        mass: kilograms.
        joint: its origin is in the same frame as the parts.
        parent: the moving part that carries this one; the body when None.
    """

    name: str
    parts: list[Part]
    hulls: list[trimesh.Trimesh]
    mass: float
    joint: Joint
    parent: str | None = None


@dataclass(frozen=True)
class BuiltObject:
    """One variant of an object, z up, in metres; where the origin lies does not matter.

    Args:
        parts: the visible shape.
        hulls: convex, watertight pieces whose union is the collision shape.
        mass: kilograms, without moving parts.
        friction: Coulomb coefficient.
        moving: parts that joints move, each after the part that carries it.
    """

    parts: list[Part]
    hulls: list[trimesh.Trimesh]
    mass: float
    friction: float = 0.7
    moving: list[MovingPart] = field(default_factory=list)

    @property
    def bounds(self) -> np.ndarray:
        """(2, 3) lower and upper corner of all that is seen and solid, with all joints at 0."""
        bodies = [self, *self.moving]
        points = np.concatenate([x.vertices for body in bodies for x in (*body.parts, *body.hulls)])
        return np.stack([points.min(axis=0), points.max(axis=0)])

    @property
    def bottom_centre(self) -> np.ndarray:
        """(3,) the centre of the bottom of the bounds: the origin of the object frame."""
        lower, upper = self.bounds
        return np.array([*(lower[:2] + upper[:2]) / 2, lower[2]])


def variant_rng(*names: str) -> np.random.Generator:
    """The generator of a variant's texture: always the same for the same names."""
    return np.random.default_rng(zlib.crc32("/".join(names).encode()))


def paint(
    mesh: trimesh.Trimesh,
    texture: np.ndarray,
    mapping: Mapping,
    *,
    crease: float = 40.0,
    roughness: float = 0.6,
    metallic: float = 0.0,
) -> Part:
    """Give a mesh a texture.

    Args:
        mesh: geometry.
        texture: (H, W, 3) uint8 RGB.
        mapping: gives each corner its texture coordinates.
        crease: edges that turn by more degrees than this stay sharp.
    """
    mesh = mesh.copy()
    mesh.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=7)
    mesh.update_faces(mesh.area_faces > 1e-13)
    corners = np.asarray(mesh.triangles)  # (m, 3, 3)
    normals = _corner_normals(mesh, np.cos(np.radians(crease)))
    uv = mapping(corners, np.asarray(mesh.face_normals))
    rows = np.concatenate([corners, normals, uv], axis=2).reshape(-1, 8)
    _, first, inverse = np.unique(rows.round(6), axis=0, return_index=True, return_inverse=True)
    rows = rows[first]
    return Part(rows[:, :3], rows[:, 3:6], rows[:, 6:], inverse.reshape(-1, 3), texture, roughness, metallic)


def _corner_normals(mesh: trimesh.Trimesh, least_cosine: float) -> np.ndarray:
    """(m, 3, 3) unit normals: area-weighted mean over the faces at a vertex that are not beyond the crease."""
    faces, face_normals = np.asarray(mesh.faces), np.asarray(mesh.face_normals)
    count = len(faces)
    ones = np.ones(3 * count)
    incidence = csr_matrix((ones, (np.repeat(np.arange(count), 3), faces.ravel())), shape=(count, len(mesh.vertices)))
    out = np.zeros((count, 3, 3))
    for corner in range(3):
        pick = csr_matrix((np.ones(count), (np.arange(count), faces[:, corner])), shape=incidence.shape)
        here, there = (pick @ incidence.T).nonzero()
        near = np.einsum("ij,ij->i", face_normals[here], face_normals[there]) >= least_cosine
        here, there = here[near], there[near]
        np.add.at(out[:, corner], here, face_normals[there] * mesh.area_faces[there, None])
    return out / np.linalg.norm(out, axis=2, keepdims=True)
