"""Textured surfaces of a fetched model, between its files and the parts of our objects.

Files: Wavefront OBJ with MTL materials and STL, read by trimesh. A material shows its picture or its diffuse colour; a
plain colour becomes a small picture, because SAPIEN drops the colours of vertices.
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


@dataclass(frozen=True)
class TextureSettings:
    """Sizes of the pictures of converted models.

    Args:
        max_edge_px: larger textures are scaled down; objects of a table scene are seen at a few hundred pixels.
        plain_edge_px: of the picture of a plain colour.
    """

    max_edge_px: int = 512
    plain_edge_px: int = 4


SETTINGS = TextureSettings()

Y_UP_TO_Z_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
"""Turns a model with y up and its front along z to z up and its front along -y, towards the robot."""


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
    """Read the surfaces of a model's file, in its own frame and unit, one per material.

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
    return np.full((SETTINGS.plain_edge_px, SETTINGS.plain_edge_px, 3), np.asarray(colour, dtype=np.uint8)[:3])


def opaque(picture: Image.Image) -> np.ndarray:
    """Lay a picture over white, at most ``max_edge_px`` wide and high: (H, W, 3) uint8."""
    picture = picture.convert("RGBA")
    picture.thumbnail((SETTINGS.max_edge_px, SETTINGS.max_edge_px))
    ground = Image.new("RGBA", picture.size, (255, 255, 255, 255))
    return np.asarray(Image.alpha_composite(ground, picture).convert("RGB"))


# --- turning and scaling -------------------------------------------------------------------------------------


def turned(surfaces: Sequence[MaterialSurface], rotation: np.ndarray) -> list[MaterialSurface]:
    """Rotate surfaces by a (3, 3) rotation."""
    return [replace(surface, corners=surface.corners @ np.asarray(rotation).T) for surface in surfaces]


def euler_rotation(degrees: Sequence[float]) -> np.ndarray:
    """Return the (3, 3) rotation about the fixed axes x, then y, then z."""
    turns = [trimesh.transformations.rotation_matrix(np.radians(a), axis) for a, axis in zip(degrees, np.eye(3))]
    return (turns[2] @ turns[1] @ turns[0])[:3, :3]


def stretched(surfaces: Sequence[MaterialSurface], size: Sequence[float]) -> list[MaterialSurface]:
    """Stretch surfaces to a bounding box with these edge lengths and its lower corner at the origin."""
    points = np.concatenate([surface.corners.reshape(-1, 3) for surface in surfaces])
    lower, edges = points.min(axis=0), np.ptp(points, axis=0)
    scale = np.asarray(size, dtype=np.float64) / np.where(edges > 0, edges, 1.0)
    return [replace(surface, corners=(surface.corners - lower) * scale) for surface in surfaces]


# --- parts ---------------------------------------------------------------------------------------------------


def part_of(surface: MaterialSurface) -> Part:
    """Make a part of a surface, with computed normals: not every model has its own."""
    mesh, kept = welded(surface.corners)
    uv = np.full((len(kept), 3, 2), 0.5) if surface.uv is None else surface.uv[kept]
    return paint(mesh, surface.texture, lambda corners, normals: uv, roughness=surface.roughness)


def welded(corners: np.ndarray) -> tuple[trimesh.Trimesh, np.ndarray]:
    """Merge corners at the same place into vertices; returns the mesh and the indices of its triangles."""
    mesh = trimesh.Trimesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), process=False)
    mesh.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=7)
    solid = np.asarray(mesh.area_faces > 1e-12)
    mesh.update_faces(solid)
    mesh.remove_unreferenced_vertices()
    return mesh, np.flatnonzero(solid)


def _fetched_again(path: Path) -> str:
    """Return the way out of a damaged file."""
    return f"delete {path}, then fetch it again: {vcage_command('setup', 'assets')}"
