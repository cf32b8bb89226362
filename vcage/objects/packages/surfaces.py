"""Painted surfaces of a fetched model, on their way from its files to parts of ours.

Files: Wavefront OBJ with MTL materials and STL, read by trimesh. What is seen of a material is its picture or its
diffuse colour; a plain colour becomes a small picture, because SAPIEN drops the colours of vertices.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import trimesh
from PIL import Image

from vcage.base.commands import vcage_command
from vcage.base.errors import DamagedFile
from vcage.objects.modelling.parts import Part, paint

LARGEST_PICTURE = 512
"""Pixels: larger textures are scaled down; objects of a table scene are seen at a few hundred pixels."""

Y_UP_TO_Z_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
"""A model that looks along its z with y up comes to look along our -y, towards the robot."""

PLAIN = 4
"""Edge length of the picture of a plain colour, pixels."""


@dataclass(frozen=True)
class MaterialSurface:
    """Triangles with one material.

    Args:
        corners: (m, 3, 3) metres.
        uv: (m, 3, 2) texture coordinates, v upwards; None for a plain colour.
        texture: (H, W, 3) uint8 RGB.
        roughness: of the glTF material.
    """

    corners: np.ndarray
    uv: np.ndarray | None
    texture: np.ndarray
    roughness: float = 0.6


def read_surfaces(path: Path) -> list[MaterialSurface]:
    """The surfaces of a model's file, in its own frame and unit, one for each material.

    Raises:
        DamagedFile: the file cannot be read or holds no triangle.
    """
    try:
        # The pictures named in the MTL file are found beside it.
        scene = trimesh.load_scene(str(path), group_material=True, process=False)
    except (OSError, ValueError, IndexError, KeyError) as error:
        raise DamagedFile(f"{path} cannot be read: {error}", hint=_fetched_again(path)) from error
    surfaces = [_surface(mesh) for mesh in scene.dump() if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces)]
    if not surfaces:
        raise DamagedFile(f"{path} holds no triangle", hint=_fetched_again(path))
    return surfaces


def _surface(mesh: trimesh.Trimesh) -> MaterialSurface:
    corners = np.asarray(mesh.vertices, dtype=np.float64)[mesh.faces]
    material = getattr(mesh.visual, "material", None)
    picture = getattr(material, "image", None)
    uv = getattr(mesh.visual, "uv", None)
    roughness = _roughness(material)
    if picture is not None and uv is not None:
        return MaterialSurface(corners, np.asarray(uv)[mesh.faces], opaque(picture), roughness)
    colour = getattr(material, "diffuse", None)
    return MaterialSurface(corners, None, plain((204, 204, 204) if colour is None else colour[:3]), roughness)


def _roughness(material: object) -> float:
    """From the exponent of an MTL material's highlight (Ns), by Blinn's relation to a microfacet's slope."""
    values = getattr(material, "kwargs", None) or {}
    exponent = float(np.ravel(values.get("ns", values.get("Ns", 10.0)))[0])
    return float(np.clip((2 / (exponent + 2)) ** 0.25, 0.25, 0.9))


def plain(colour: Sequence[int]) -> np.ndarray:
    """A picture of one colour, (4, 4, 3) uint8."""
    return np.full((PLAIN, PLAIN, 3), np.asarray(colour, dtype=np.uint8)[:3])


def opaque(picture: Image.Image) -> np.ndarray:
    """(H, W, 3) uint8 of a picture over white, at most :data:`LARGEST_PICTURE` pixels wide and high."""
    picture = picture.convert("RGBA")
    picture.thumbnail((LARGEST_PICTURE, LARGEST_PICTURE))
    ground = Image.new("RGBA", picture.size, (255, 255, 255, 255))
    return np.asarray(Image.alpha_composite(ground, picture).convert("RGB"))


# --- turning and scaling -------------------------------------------------------------------------------------


def turned(surfaces: Sequence[MaterialSurface], rotation: np.ndarray) -> list[MaterialSurface]:
    """Surfaces under a rotation (3, 3)."""
    return [replace(surface, corners=surface.corners @ np.asarray(rotation).T) for surface in surfaces]


def euler_rotation(degrees: Sequence[float]) -> np.ndarray:
    """(3, 3) of turns about x, then y, then z, the axes of the room."""
    turns = [trimesh.transformations.rotation_matrix(np.radians(a), axis) for a, axis in zip(degrees, np.eye(3))]
    return (turns[2] @ turns[1] @ turns[0])[:3, :3]


def stretched(surfaces: Sequence[MaterialSurface], size: Sequence[float]) -> list[MaterialSurface]:
    """Surfaces stretched to a bounding box with these edge lengths, its lower corner at the origin."""
    points = np.concatenate([surface.corners.reshape(-1, 3) for surface in surfaces])
    lower, edges = points.min(axis=0), np.ptp(points, axis=0)
    scale = np.asarray(size, dtype=np.float64) / np.where(edges > 0, edges, 1.0)
    return [replace(surface, corners=(surface.corners - lower) * scale) for surface in surfaces]


# --- parts ---------------------------------------------------------------------------------------------------


def part_of(surface: MaterialSurface) -> Part:
    """A part with normals of its own; the model's are not always there."""
    mesh, kept = welded(surface.corners)
    uv = np.full((len(kept), 3, 2), 0.5) if surface.uv is None else surface.uv[kept]
    return paint(mesh, surface.texture, lambda corners, normals: uv, roughness=surface.roughness)


def welded(corners: np.ndarray) -> tuple[trimesh.Trimesh, np.ndarray]:
    """A mesh whose corners at the same place are one vertex, and the numbers of the triangles that it keeps."""
    mesh = trimesh.Trimesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), process=False)
    mesh.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=7)
    solid = np.asarray(mesh.area_faces > 1e-12)
    mesh.update_faces(solid)
    mesh.remove_unreferenced_vertices()
    return mesh, np.flatnonzero(solid)


def _fetched_again(path: Path) -> str:
    """The way out of a damaged file: what is not there is fetched."""
    return f"delete {path}, then fetch it again: {vcage_command('setup', 'assets')}"
