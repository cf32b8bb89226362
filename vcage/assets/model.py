"""From a built object to files: one GLB for the eye, convex OBJs for physics, and a short description.

SAPIEN reads a GLB's coordinates as they are, so files are written z up although glTF calls y up.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import trimesh
from PIL import Image

from vcage.assets.builders.parts import BuiltObject, Part
from vcage.files import read_json, write_bytes, write_json, write_text
from vcage.schema.asset import PhysicalModel

DESCRIPTION = "model.json"


def write_model(built: BuiltObject, folder: Path) -> None:
    """Write the files of a variant into an existing folder, with the origin moved to the centre of the bottom."""
    lower, upper = _bounds(built)
    origin = np.array([(lower[0] + upper[0]) / 2, (lower[1] + upper[1]) / 2, lower[2]])
    write_bytes(folder / "visual.glb", _glb(built.parts, origin))
    for i, piece in enumerate(built.hulls):
        write_text(folder / _hull_name(i), _obj(piece, origin))
    write_json(
        folder / DESCRIPTION,
        {
            "hulls": len(built.hulls),
            "lower": (lower - origin).round(6).tolist(),
            "upper": (upper - origin).round(6).tolist(),
            "mass": built.mass,
            "friction": built.friction,
        },
    )


def read_model(folder: Path) -> PhysicalModel:
    """The model that :func:`write_model` left in a folder."""
    data = read_json(folder / DESCRIPTION)
    return PhysicalModel(
        visual=str(folder / "visual.glb"),
        hulls=[str(folder / _hull_name(i)) for i in range(data["hulls"])],
        lower=data["lower"],
        upper=data["upper"],
        mass=data["mass"],
        friction=data["friction"],
    )


def _hull_name(index: int) -> str:
    return f"hull-{index:02d}.obj"


def _bounds(built: BuiltObject) -> np.ndarray:
    points = np.concatenate([p.vertices for p in built.parts] + [h.vertices for h in built.hulls])
    return np.stack([points.min(axis=0), points.max(axis=0)])


def _glb(parts: list[Part], origin: np.ndarray) -> bytes:
    scene = trimesh.Scene()
    for i, part in enumerate(parts):
        material = trimesh.visual.material.PBRMaterial(
            name=f"material-{i}",
            baseColorTexture=Image.fromarray(part.texture),
            roughnessFactor=part.roughness,
            metallicFactor=part.metallic,
        )
        mesh = trimesh.Trimesh(
            part.vertices - origin,
            part.faces,
            vertex_normals=part.normals,
            visual=trimesh.visual.TextureVisuals(uv=part.uv, material=material),
            process=False,
        )
        scene.add_geometry(mesh, node_name=f"part-{i}", geom_name=f"part-{i}")
    return scene.export(file_type="glb", include_normals=True)


def _obj(piece: trimesh.Trimesh, origin: np.ndarray) -> str:
    vertices = [f"v {x:.7f} {y:.7f} {z:.7f}" for x, y, z in piece.vertices - origin]
    faces = [f"f {a} {b} {c}" for a, b, c in piece.faces + 1]
    return "\n".join([*vertices, *faces]) + "\n"
