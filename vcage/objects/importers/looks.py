"""The look of a mesh file: its surfaces with their own pictures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from PIL import Image

from vcage.base.errors import DamagedFile, VcageError
from vcage.base.placeholders import require_fetched
from vcage.objects.mesh_files import MeshFiles
from vcage.objects.modelling.parts import Part, paint

NORMALS = "normals"
"""Attribute of a mesh's vertices: the normals that its file gives, in the mesh's frame; any length."""


def load_surfaces(path: Path, root: Path | None = None) -> list[trimesh.Trimesh]:
    """The surfaces of a mesh file, each at its place in the file's scene.

    Args:
        path: of the mesh.
        root: folder of the object, to which names in the mesh may lead; by default the mesh's own.

    Raises:
        DamagedFile: it is not a mesh that can be read, or holds no triangle, or names a pipe, a device or a folder.
    """
    require_fetched(path)
    files = MeshFiles(path, root)
    try:
        scene = trimesh.load_scene(path, resolver=files, process=False)
        meshes = [_placed(scene, node) for node in scene.graph.nodes_geometry]
        files.require_regular()
    except VcageError:
        raise
    except Exception as error:  # trimesh's readers raise whatever their file format makes them raise
        raise DamagedFile(
            f"{path} is not a mesh that can be read: {type(error).__name__}: {error}", hint="export it again"
        ) from error
    meshes = [mesh for mesh in meshes if mesh is not None]
    if not meshes:
        raise DamagedFile(f"{path} holds no triangle", hint="export it again")
    if not all(np.isfinite(mesh.vertices).all() for mesh in meshes):
        raise DamagedFile(f"{path} has vertices that are not finite numbers", hint="export it again")
    return meshes


def _placed(scene: trimesh.Scene, node: str) -> trimesh.Trimesh | None:
    transform, name = scene.graph[node]
    source = scene.geometry[name]
    if not isinstance(source, trimesh.Trimesh) or not len(source.faces):
        return None
    mesh = source.copy()
    mesh.apply_transform(transform)
    if "vertex_normals" in source._cache:  # the file's own: a copy would compute others
        mesh.vertex_attributes[NORMALS] = source.vertex_normals @ np.linalg.inv(transform[:3, :3])
    return mesh


def parts_of(meshes: Sequence[trimesh.Trimesh], linear: np.ndarray, shift: np.ndarray) -> list[Part]:
    """Surfaces as seen, mapped by ``linear @ x + shift``; parts too small to be seen are left out.

    Args:
        meshes: of :func:`load_surfaces`.
        linear: (3, 3), invertible; under a reflection the triangles are turned over, to face outwards still.
        shift: (3,) metres.
    """
    return [part for mesh in meshes if (part := _part(mesh, linear, shift)) is not None]


def _part(mesh: trimesh.Trimesh, linear: np.ndarray, shift: np.ndarray, min_area_m2: float = 1e-13) -> Part | None:
    """The surface, without the triangles that :func:`vcage.objects.modelling.parts.paint` leaves out as well."""
    texture, uv, roughness, metallic = _look(mesh)
    corners = (np.asarray(mesh.vertices) @ linear.T + shift)[mesh.faces]
    uv = (uv[mesh.faces] if len(uv) == len(mesh.vertices) else uv).reshape(-1, 3, 2)
    own = mesh.vertex_attributes.get(NORMALS)
    normals = None if own is None else (np.asarray(own) @ np.linalg.inv(linear))[mesh.faces]
    if np.linalg.det(linear) < 0:
        corners, uv = corners[:, ::-1], uv[:, ::-1]
        normals = None if normals is None else normals[:, ::-1]
    sheet = trimesh.Trimesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), process=False)
    sheet.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=7)
    kept = np.asarray(sheet.area_faces > min_area_m2)
    if not kept.any():
        return None
    if normals is None or not np.linalg.norm(normals[kept], axis=2).all():
        # The file has no edges: those with a large angle are sharp.
        return paint(sheet, texture, lambda _corners, _normals: uv[kept], roughness=roughness, metallic=metallic)
    normals = normals[kept] / np.linalg.norm(normals[kept], axis=2, keepdims=True)
    rows = np.concatenate([corners[kept], normals, uv[kept]], axis=2).reshape(-1, 8)
    _, first, inverse = np.unique(rows.round(7), axis=0, return_index=True, return_inverse=True)
    rows = rows[first]
    return Part(rows[:, :3], rows[:, 3:6], rows[:, 6:], inverse.reshape(-1, 3), texture, roughness, metallic)


def _look(mesh: trimesh.Trimesh) -> tuple[np.ndarray, np.ndarray, float, float]:
    """(texture, uv, roughness, metallic); as many uv as vertices, or three per face."""
    visual = mesh.visual
    material = getattr(visual, "material", None)
    if material is None:
        return *_face_colours(mesh), 0.6, 0.0
    picture, colour = _picture(material), _colour(material)
    said = getattr(visual, "uv", None)
    uv = None if said is None else np.asarray(said, dtype=np.float64)
    roughness = _number(getattr(material, "roughnessFactor", None), 0.6)
    metallic = _number(getattr(material, "metallicFactor", None), 0.0)
    if picture is None or uv is None or len(uv) != len(mesh.vertices):
        return _plain(colour), np.full((len(mesh.vertices), 2), 0.5), roughness, metallic
    return _tinted(picture, colour), uv[:, :2], roughness, metallic


def _picture(material: Any) -> np.ndarray | None:
    image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    if not isinstance(image, Image.Image):
        return None
    if getattr(material, "alphaMode", None) in ("BLEND", "MASK"):  # transparent parts are drawn white
        white = Image.new("RGBA", image.size, (255, 255, 255, 255))
        image = Image.alpha_composite(white, image.convert("RGBA"))
    return np.asarray(image.convert("RGB"))


def _colour(material: Any) -> tuple[float, ...] | None:
    """The factor that a material puts on its picture, linear RGB from 0 to 1; None when it does not say."""
    for name in ("baseColorFactor", "diffuse"):
        value = getattr(material, name, None)
        if value is not None:
            factor = np.asarray(value, dtype=np.float64)[:3] / 255
            # A glTF factor is linear already; an MTL colour is as seen on a screen.
            return tuple(factor if name == "baseColorFactor" else _to_linear(factor))
    return None


def _number(value: Any, default: float) -> float:
    return default if value is None else float(np.clip(value, 0.0, 1.0))


def _plain(colour: tuple[float, ...] | None, default: tuple[int, int, int] = (178, 178, 178)) -> np.ndarray:
    """A picture of one linear colour, or of the sRGB ``default`` for a surface with neither picture nor colour."""
    seen = default if colour is None else _to_screen(np.array(colour)) * 255
    return np.full((4, 4, 3), seen).round().astype(np.uint8)


def _tinted(picture: np.ndarray, colour: tuple[float, ...] | None) -> np.ndarray:
    if colour is None or min(colour) > 0.999:
        return picture
    return (_to_screen(_to_linear(picture / 255) * np.array(colour)) * 255).round().astype(np.uint8)


def _face_colours(mesh: trimesh.Trimesh, palette_steps: int = 32) -> tuple[np.ndarray, np.ndarray]:
    """A picture with one pixel for each colour of the faces, and three texture coordinates per face.

    Very many colours are rounded to ``palette_steps`` per channel.
    """
    visual = mesh.visual
    if not isinstance(visual, trimesh.visual.ColorVisuals) or visual.kind not in ("face", "vertex"):
        return _plain(None), np.full((len(mesh.vertices), 2), 0.5)
    colours = np.asarray(visual.face_colors)[:, :3]
    if len(np.unique(colours, axis=0)) > palette_steps**2:
        step = 256 // palette_steps
        colours = colours // step * step + step // 2
    palette, index = np.unique(colours, axis=0, return_inverse=True)
    side = int(np.ceil(np.sqrt(len(palette))))
    picture = np.zeros((side * side, 3), dtype=np.uint8)
    picture[: len(palette)] = palette
    row, column = np.divmod(index.ravel(), side)
    middle = np.stack([(column + 0.5) / side, 1 - (row + 0.5) / side], axis=1)
    return picture.reshape(side, side, 3), np.repeat(middle, 3, axis=0)


def _to_linear(screen: np.ndarray) -> np.ndarray:
    return np.where(screen <= 0.04045, screen / 12.92, ((screen + 0.055) / 1.055) ** 2.4)


def _to_screen(linear: np.ndarray) -> np.ndarray:
    linear = np.clip(linear, 0.0, 1.0)
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)
