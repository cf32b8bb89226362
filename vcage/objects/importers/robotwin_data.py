"""Annotations of RoboTwin: ``model_data{K}.json`` of a variant, ``points_info.json`` of all variants.

A point is a 4×4 matrix in the frame of the mesh, or of a link, whose translation is not scaled yet. A number that is
wrong costs the variant where nothing can be made without it, and the point otherwise, with a warning.
"""

from __future__ import annotations

import difflib
import os.path
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from vcage.base.errors import DamagedFile, InputFileError, mismatch
from vcage.base.placeholders import require_fetched
from vcage.base.reading import read_json
from vcage.objects.importers.robotwin_words import TEXTS, description, point_texts

KEYS = (
    "center", "extents", "scale", "contact_points_pose", "contact_points", "functional_matrix", "functional_points",
    "target_pose", "target_points", "orientation_point", "contact_points_group", "contact_points_mask",
    "transform_matrix", "stable", "init_qpos", "mass", "name", "description",
)  # fmt: skip
"""Fields of ``model_data``; besides them, ``…description`` and ``…discription`` hold texts."""


@dataclass(frozen=True)
class RawPoint:
    """A point as it is written.

    Args:
        index: its place in the list, which RoboTwin's tasks call it by.
        matrix: (4, 4), translation unscaled.
        base: the link whose frame it is in; None for the mesh's.
        text: its description; may be empty.
        field: where it stands in the file.
    """

    index: int
    matrix: np.ndarray
    base: str | None
    text: str
    field: str


@dataclass(frozen=True)
class AnnotationFile:
    """A file of RoboTwin's, and the receiver of its faults.

    Args:
        path: of the file.
        report: called with a sentence about each omission or assumption.
        data: its fields; none when it is missing.
    """

    path: Path
    report: Callable[[str], None]
    data: dict[str, Any] = field(default_factory=dict)

    def warn(self, name: str, message: str) -> None:
        """Report a fault of a field."""
        self.report(f"{self.path}: field {name}: {message}")


@dataclass(frozen=True)
class ModelData:
    """The usable part of a ``model_data`` file.

    Args:
        file: that it is from.
        scale: (3,) mesh units to metres.
        scale_assumed: True if no scale is given, so that it is 1.
        contacts, functionals: points.
        transform: (3, 3) extra rotation of an articulated object.
        init_qpos: joint positions to start from; empty for zeros.
        mass: kilograms by link.
        description: a sentence about the object; may be empty.
    """

    file: AnnotationFile
    scale: np.ndarray
    scale_assumed: bool = False
    contacts: list[RawPoint] = field(default_factory=list)
    functionals: list[RawPoint] = field(default_factory=list)
    transform: np.ndarray = field(default_factory=lambda: np.eye(3))
    init_qpos: list[float] = field(default_factory=list)
    mass: dict[str, float] = field(default_factory=dict)
    description: str = ""


def read_object(path: Path) -> dict[str, Any]:
    """The JSON object in a file.

    Raises:
        DamagedFile: it cannot be read, or holds something else.
    """
    require_fetched(path)
    try:
        data = read_json(path, nan=True)  # a point of NaN is left out alone
    except InputFileError as error:
        why = error.message.replace("is not valid JSON", "is not JSON that can be read")
        raise DamagedFile(why, hint="fix it, or download the object again", details=error.details) from error
    if not isinstance(data, dict):
        raise DamagedFile(f"{path}: expected an object with fields, got {type(data).__name__}", hint="fix the file")
    return data


def read_model_data(path: Path, info: dict[str, Any], report: Callable[[str], None]) -> ModelData:
    """The annotation of a variant; without the file, nothing but a warning.

    Args:
        path: of the file.
        info: of ``points_info.json``; its texts stand in for missing ones.
        report: called with a sentence about each omission or assumption.

    Raises:
        DamagedFile: the file is not JSON.
        SchemaMismatch: the scale, or another essential field, is invalid.
    """
    if not os.path.lexists(path):
        report(f"{path}: missing; expected scale and points: scale 1 is assumed, and there are no points")
        return ModelData(AnnotationFile(path, report), np.ones(3), scale_assumed=True)
    data = read_object(path)
    file = AnnotationFile(path, report, data)
    scale, init_qpos = read_scale(path, data), _numbers(file, "init_qpos")  # refusals come before warnings
    _warn_about_unknown(file)
    contacts = "contact_points_pose" if "contact_points_pose" in data else "contact_points"
    functionals = "functional_matrix" if "functional_matrix" in data else "functional_points"
    listed = data.get(contacts)
    hidden = _masked(file, len(listed) if isinstance(listed, list) else 0)
    return ModelData(
        file,
        scale,
        contacts=[p for p in _points(file, contacts, point_texts("contact", data, info)) if p.index not in hidden],
        functionals=_points(file, functionals, point_texts("functional", data, info)),
        transform=_transform(file),
        init_qpos=init_qpos,
        mass=_mass(file),
        description=description(data) or description(info),
    )


def read_scale(path: Path, data: dict[str, Any], smallest: float = 1e-6, largest: float = 1e6) -> np.ndarray:
    """(3,) metres per mesh unit along x, y and z of the mesh.

    Args:
        path: of the file.
        data: its fields.
        smallest, largest: metres per mesh unit; geometry far beyond overflows before its size can be checked.

    Raises:
        SchemaMismatch: it is missing, not one or three numbers, or not within these.
    """
    if "scale" not in data:
        raise mismatch(path, "scale", "missing; expected three numbers, metres per mesh unit")
    values = data["scale"] if isinstance(data["scale"], list) else [data["scale"]] * 3
    if len(values) != 3 or not all(_is_number(x) for x in values):
        raise mismatch(path, "scale", f"got {data['scale']!r}; expected three numbers, metres per mesh unit")
    if min(values) <= 0:
        raise mismatch(path, "scale", f"got {data['scale']!r}; expected numbers above 0")
    if min(values) < smallest or max(values) > largest:
        raise mismatch(path, "scale", f"got {data['scale']!r}; expected {smallest:g} … {largest:g}")
    return np.array(values, dtype=np.float64)


def _is_number(value: Any) -> bool:
    """True for a finite number that a float can hold; JSON's integers have no limit."""
    if not isinstance(value, (int, float)) or isinstance(value, bool):
        return False
    return -sys.float_info.max <= value <= sys.float_info.max


def _warn_about_unknown(file: AnnotationFile) -> None:
    for key in file.data:
        if key not in KEYS and not any(text in key for text in TEXTS):
            near = difflib.get_close_matches(key, KEYS, n=1)
            file.warn(key, f"unknown, not read{f'; did you mean {near[0]}?' if near else ''}")


# --- points ------------------------------------------------------------------------------------------------


def _points(file: AnnotationFile, key: str, texts: dict[int, str]) -> list[RawPoint]:
    values = file.data.get(key) or []
    if not isinstance(values, list):
        file.warn(key, f"got {type(values).__name__}; expected a list of 4×4 matrices: no points were read")
        return []
    points = []
    for i, value in enumerate(values):
        name, base = f"{key}.{i}", None
        if isinstance(value, dict):
            unknown = [k for k in value if k not in ("matrix", "base")]
            if unknown or "matrix" not in value or not isinstance(value.get("base"), str):
                file.warn(name, f"got the keys {sorted(value)}; expected 'matrix' and 'base': left out")
                continue
            name, value, base = f"{name}.matrix", value["matrix"], value["base"]
        complaint = not_a_frame(value)
        if complaint:
            file.warn(name, f"{complaint}: left out")
        else:
            points.append(RawPoint(i, np.array(value, dtype=np.float64), base, texts.get(i, ""), name))
    return points


def not_a_frame(value: Any, max_error: float = 0.02) -> str:
    """Why a value is no 4×4 matrix of a rotation and a translation; empty when it is one.

    Args:
        max_error: of the product of a rotation with its transpose: annotations are rounded.
    """
    try:
        matrix = np.array(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        return "expected a 4×4 matrix of numbers"
    if matrix.shape != (4, 4):
        return f"got the shape {'×'.join(map(str, matrix.shape)) or 'of one number'}; expected 4×4"
    if not np.isfinite(matrix).all() or np.abs(matrix[3] - (0, 0, 0, 1)).max() > 1e-6:
        return "expected finite numbers and a last row of 0 0 0 1"
    rotation = matrix[:3, :3]
    if np.abs(rotation @ rotation.T - np.eye(3)).max() > max_error or np.linalg.det(rotation) < 0:
        return "expected a rotation in the upper left 3×3"
    return ""


def _masked(file: AnnotationFile, count: int) -> set[int]:
    """Contact points excluded by the mask of their group; warns of indices without points."""
    groups, mask = (file.data.get(f"contact_points_{name}") or [] for name in ("group", "mask"))
    if not isinstance(groups, list) or not isinstance(mask, list):
        file.warn("contact_points_group", "expected a list of lists, and a mask with one entry for each: not used")
        return set()
    return _kept_out(file, groups, mask, count)


def _kept_out(file: AnnotationFile, groups: list[Any], mask: list[Any], count: int) -> set[int]:
    if len(mask) != len(groups):
        file.warn("contact_points_mask", f"got {len(mask)} entries; expected one for each of {len(groups)} groups")
    members = [group if isinstance(group, list) else [group] for group in groups]
    for i, group in enumerate(members):
        if wrong := [x for x in group if not _is_index(x, count)]:
            file.warn(f"contact_points_group.{i}", f"got {wrong}; expected indices from 0 to {count - 1}: not used")
    hidden = {x for group, kept in zip(members, mask) if kept is False for x in group if _is_index(x, count)}
    if hidden:
        file.warn("contact_points_mask", f"keeps out the contact points {sorted(hidden)}")
    return hidden


def _is_index(value: Any, count: int) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < count


# --- articulated objects -----------------------------------------------------------------------------------


def _transform(file: AnnotationFile) -> np.ndarray:
    value = file.data.get("transform_matrix")
    complaint = not_a_frame(value) if value is not None else ""
    if complaint:
        file.warn("transform_matrix", f"{complaint}: not used")
    return np.eye(3) if value is None or complaint else np.array(value, dtype=np.float64)[:3, :3]


def _numbers(file: AnnotationFile, key: str) -> list[float]:
    values = file.data.get(key) or []
    if not isinstance(values, list) or not all(_is_number(x) for x in values):
        raise mismatch(file.path, key, f"got {values!r}; expected a list of numbers")
    return [float(x) for x in values]


def _mass(file: AnnotationFile) -> dict[str, float]:
    values = file.data.get("mass") or {}
    if not isinstance(values, dict):
        file.warn("mass", f"got {type(values).__name__}; expected kilograms by link: not used")
        return {}
    for link, value in values.items():
        if not _is_number(value) or value <= 0:
            file.warn(f"mass.{link}", f"got {value!r}; expected kilograms above 0: not used")
    return {link: float(x) for link, x in values.items() if _is_number(x) and x > 0}
