"""RoboTwin's rigid objects: ``visual/base{K}.glb``, ``collision/base{K}.glb`` and ``model_data{K}.json``.

A mesh is y up and stands upright after a quarter turn about x, RoboTwin's quaternion [0.707, 0.707, 0, 0]; its front,
which looks along its z, then looks towards the robot, as ours does.
"""

from __future__ import annotations

import os.path
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from vcage.base.errors import DamagedFile, InputFileError
from vcage.objects.importers.component_hulls import SETTINGS, component_hulls, hulls_of_surface, joined
from vcage.objects.importers.converted import Converted, estimated_mass, total_volume
from vcage.objects.importers.looks import load_surfaces, parts_of
from vcage.objects.importers.robotwin_data import ModelData, RawPoint, read_model_data
from vcage.objects.importers.robotwin_points import Placed, converted_variant, scaled_point
from vcage.objects.mesh_files import report_unseen_textures
from vcage.objects.modelling.parts import BuiltObject
from vcage.objects.packages.surfaces import Y_UP_TO_Z_UP

NUMBERED = re.compile(r"(?:base(\d*)\.glb|textured(\d*)\.obj|model_data(\d*)\.json)")


def variant_numbers(folder: Path) -> list[str]:
    """The K of every variant of an object's folder, in the order of the numbers; '' for files without a number."""
    files = [path for place in (folder, folder / "visual", folder / "collision") for path in place.glob("*.*")]
    matches = [match for path in files if (match := NUMBERED.fullmatch(path.name))]
    return sorted({next(g for g in m.groups() if g is not None) for m in matches}, key=lambda k: (len(k), k))


def convert(folder: Path, number: str, info: dict[str, Any], report: Callable[[str], None]) -> Converted:
    """One variant of a rigid object.

    Args:
        number: its K.
        info: of ``points_info.json``.
        report: called with a sentence about each omission or assumption.

    Raises:
        InputFileError: no mesh can be read, or a field that nothing works without is wrong.
    """
    model = read_model_data(folder / f"model_data{number}.json", info, report)
    linear = Y_UP_TO_Z_UP * model.scale
    visual = _visual(folder, number, model)
    report_unseen_textures(visual, report, folder)
    surfaces = load_surfaces(visual, folder)
    parts = parts_of(surfaces, linear, np.zeros(3))
    hulls = _collision(folder, number, linear, surfaces, model)
    frame = np.eye(4)
    frame[:3, :3] = Y_UP_TO_Z_UP

    def place(raws: Sequence[RawPoint], origin: np.ndarray) -> list[Placed]:
        frame[:3, 3] = -origin
        return [scaled_point(model, raw, frame, None) for raw in raws]

    built = BuiltObject(parts, hulls, estimated_mass(total_volume(hulls)))
    return converted_variant(f"base{number}", built, model, place)


def _candidates(folder: Path, kind: str, number: str) -> list[Path]:
    """Return RoboTwin's places for the 'visual' or 'collision' mesh, in its order."""
    names = (f"base{number}.glb", f"textured{number}.obj")
    return [place / name for place in (folder / kind, folder) for name in names]


def _visual(folder: Path, number: str, model: ModelData) -> Path:
    wanted = _candidates(folder, "visual", number)
    found = next(filter(os.path.lexists, wanted), None)
    if found is not None:
        return found
    solid = next(filter(os.path.lexists, _candidates(folder, "collision", number)), None)
    if solid is None:
        raise InputFileError(
            f"{wanted[0]}: missing; expected a mesh there or at {', '.join(map(str, wanted[1:]))}",
            hint="download the object again",
            details={"path": str(wanted[0])},
        )
    model.file.report(f"{wanted[0]}: missing; {solid} is shown in its place")
    return solid


def _collision(
    folder: Path, number: str, linear: np.ndarray, surfaces: list[trimesh.Trimesh], model: ModelData
) -> list[trimesh.Trimesh]:
    wanted = _candidates(folder, "collision", number)[:2]
    found = next(filter(os.path.lexists, wanted), None)
    hulls: list[trimesh.Trimesh] = []
    if found is None:
        model.file.report(f"{wanted[0]}: missing; the collision shape is made from the visible mesh")
    else:
        hulls = _read_hulls(found, folder, linear, model)
    if not hulls:
        hulls = hulls_of_surface(*_in_metres(surfaces, linear))
    if not hulls:
        raise InputFileError(f"{folder}: variant {number or 'base'} has no solid part", hint="export its mesh again")
    if len(hulls) > SETTINGS.max_fast_pieces:
        most = SETTINGS.max_fast_pieces
        model.file.report(f"{found}: {len(hulls)} convex pieces; more than {most} make the simulation slow")
    return hulls


def _read_hulls(path: Path, root: Path, linear: np.ndarray, model: ModelData) -> list[trimesh.Trimesh]:
    try:
        hulls = component_hulls(*_in_metres(load_surfaces(path, root), linear))
    except DamagedFile as error:
        model.file.report(f"{error.message}: the collision shape is made from the visible mesh")
        return []
    if not hulls:
        model.file.report(f"{path}: no solid component; the collision shape is made from the visible mesh")
    return hulls


def _in_metres(surfaces: list[trimesh.Trimesh], linear: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    vertices, faces = joined(surfaces)
    return vertices @ linear.T, faces
