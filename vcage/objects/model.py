"""Write a built object to files, and read them: a GLB to render, convex OBJs for physics, and a short description.

SAPIEN reads a GLB's coordinates unchanged, so files are z up although glTF is y up. A moving part has
its files in a sub-folder of its name.
"""

from __future__ import annotations

import contextlib
import reprlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image
from pydantic import Field, ValidationError

from vcage.base.errors import SchemaMismatch
from vcage.base.files import read_json, write_bytes, write_json, write_text
from vcage.base.geometry import Pose
from vcage.objects.modelling.parts import BuiltObject, MovingPart, Part
from vcage.schema.asset import Joint, MovingLink, PhysicalModel
from vcage.schema.base import Finite, Identifier, Point3, Record

if TYPE_CHECKING:
    import trimesh

DESCRIPTION = "model.json"


class _LinkFile(Record):
    """A moving part in :data:`DESCRIPTION`; ``hulls`` counts its files."""

    name: Identifier
    parent: Identifier | None = None
    hulls: int = Field(ge=1)
    mass: Finite = Field(gt=0)
    joint: Joint


class _ModelFile(Record):
    """:data:`DESCRIPTION`: a :class:`PhysicalModel` whose files are counted, for their names follow."""

    hulls: int = Field(ge=1)
    lower: Point3
    upper: Point3
    mass: Finite = Field(gt=0)
    friction: Finite = Field(gt=0)
    links: list[_LinkFile]


def write_model(built: BuiltObject, folder: Path) -> None:
    """Write the files of a variant into an existing folder, with the origin moved to the centre of the bottom."""
    (lower, upper), origin = built.bounds, built.bottom_centre
    _write_meshes(built.parts, built.hulls, origin, folder)
    write_json(
        folder / DESCRIPTION,
        {
            "hulls": len(built.hulls),
            "lower": (lower - origin).round(6).tolist(),
            "upper": (upper - origin).round(6).tolist(),
            "mass": built.mass,
            "friction": built.friction,
            "links": [_write_link(part, origin, folder) for part in built.moving],
        },
    )


def read_model(folder: Path) -> PhysicalModel:
    """The model that :func:`write_model` left in a folder.

    Raises:
        MissingStage, DamagedFile: its description is not there, or not JSON.
        SchemaMismatch: a field of it is missing or invalid; names file and field.
    """
    path = folder / DESCRIPTION
    data = read_json(path)
    with schema_errors(path):
        model = _ModelFile.model_validate(data)
        links = [
            MovingLink(**_meshes(folder / link.name, link.hulls), **link.model_dump(exclude={"hulls"}))
            for link in model.links
        ]
        known = model.model_dump(exclude={"hulls", "links"})
        return PhysicalModel(**_meshes(folder, model.hulls), **known, links=links)


@contextlib.contextmanager
def schema_errors(path: Path) -> Iterator[None]:
    """Turn the refusal of a record into an error that names its file.

    Raises:
        SchemaMismatch: names file, field, the value, and what was expected.
    """
    try:
        yield
    except ValidationError as error:
        first = error.errors()[0]
        field = ".".join(str(part) for part in first["loc"]) or "(whole file)"
        value = "" if first["type"] == "missing" else f"; got {reprlib.repr(first['input'])}"
        raise SchemaMismatch(
            f"{path}: field {field}: {first['msg']}{value}",
            hint="fix the field, or make the file again",
            details={"path": str(path), "field": field, "errors": error.error_count()},
        ) from error


def write_turned(model: PhysicalModel, pose: Pose, folder: Path) -> None:
    """Write a model without moving parts, turned to a pose, into an existing folder.

    Args:
        model: whose files are read.
        pose: of its frame in the new one, whose origin is at the centre of the bottom there.
    """
    import trimesh  # slow, and only needed where a model is made

    scene = trimesh.Scene()
    for i, mesh in enumerate(trimesh.load_scene(model.visual, process=False).dump()):
        scene.add_geometry(mesh.apply_transform(pose.matrix()), node_name=f"part-{i}", geom_name=f"part-{i}")
    write_bytes(folder / "visual.glb", scene.export(file_type="glb", include_normals=True))
    corners = []
    for i, path in enumerate(model.hulls):
        piece = trimesh.load_mesh(path, process=False).apply_transform(pose.matrix())
        write_text(folder / _hull_name(i), _obj(piece, np.zeros(3)))
        corners.append(piece.bounds)
    lower, upper = np.min(corners, axis=(0, 1)), np.max(corners, axis=(0, 1))
    described = {
        "hulls": len(model.hulls),
        "lower": [*lower[:2].round(6).tolist(), 0.0],
        "upper": upper.round(6).tolist(),
        "mass": model.mass,
        "friction": model.friction,
        "links": [],
    }
    write_json(folder / DESCRIPTION, described)


def _write_link(part: MovingPart, origin: np.ndarray, folder: Path) -> dict[str, Any]:
    (folder / part.name).mkdir()
    _write_meshes(part.parts, part.hulls, origin, folder / part.name)
    shifted = tuple((np.asarray(part.joint.origin) - origin).round(6).tolist())
    return {
        "name": part.name,
        "parent": part.parent,
        "hulls": len(part.hulls),
        "mass": part.mass,
        "joint": part.joint.model_copy(update={"origin": shifted}).model_dump(),
    }


def _write_meshes(parts: Sequence[Part], hulls: Sequence[trimesh.Trimesh], origin: np.ndarray, folder: Path) -> None:
    write_bytes(folder / "visual.glb", _glb(parts, origin))
    for i, piece in enumerate(hulls):
        write_text(folder / _hull_name(i), _obj(piece, origin))


def _meshes(folder: Path, hulls: int) -> dict[str, Any]:
    return {"visual": str(folder / "visual.glb"), "hulls": [str(folder / _hull_name(i)) for i in range(hulls)]}


def _hull_name(index: int) -> str:
    return f"hull-{index:02d}.obj"


def _glb(parts: Sequence[Part], origin: np.ndarray) -> bytes:
    import trimesh  # slow, and only needed where a model is built

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
