"""The catalogue of a furniture library of Sweet Home 3D: ``PluginFurnitureCatalog.properties`` in an ``.sh3f`` zip.

Every model has a number; its properties are lines ``key#number=value`` in Java's properties format. Lengths are in
centimetres, and the frame of a model is x right, y up, z towards the viewer.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

FILE = "PluginFurnitureCatalog.properties"
_LINE = re.compile(r"(?P<key>[A-Za-z]+)(?:#(?P<number>\d+))?\s*=\s*(?P<value>.*)")
_ESCAPE = re.compile(r"\\u([0-9a-fA-F]{4})")


@dataclass(frozen=True)
class CatalogueModel:
    """One model of a library.

    Args:
        id: ``Scopia#teapot``.
        path: of its OBJ file inside the zip.
        size: width, depth and height, metres.
        rotation: (3, 3) that stands it upright, before it is scaled.
        title, creator, licence: for the attribution.
    """

    id: str
    path: str
    size: tuple[float, float, float]
    rotation: np.ndarray
    title: str
    creator: str
    licence: str


def parse(text: str) -> dict[str, CatalogueModel]:
    """The models of a catalogue by id; those without a size or a file are left out."""
    library: dict[str, str] = {}
    models: dict[str, dict[str, str]] = {}
    for line in text.splitlines():
        match = _LINE.fullmatch(line.strip())
        if match:
            value = _ESCAPE.sub(lambda code: chr(int(code[1], 16)), match["value"])
            (models.setdefault(match["number"], {}) if match["number"] else library)[match["key"]] = value
    return {fields["id"]: _model(fields, library) for fields in models.values() if _complete(fields)}


def _complete(fields: dict[str, str]) -> bool:
    return all(fields.get(name) for name in ("id", "model", "width", "depth", "height"))


def _model(fields: dict[str, str], library: dict[str, str]) -> CatalogueModel:
    entries = fields.get("modelRotation", "1 0 0 0 1 0 0 0 1").split()
    width, depth, height = (float(fields[name]) / 100 for name in ("width", "depth", "height"))
    return CatalogueModel(
        id=fields["id"],
        path=fields["model"].lstrip("/"),
        size=(width, depth, height),
        rotation=np.array([float(x) for x in entries]).reshape(3, 3),
        title=fields.get("name", fields["id"]),
        creator=fields.get("creator", library.get("provider", "unknown")),
        licence=fields.get("license", library.get("license", "unknown")),
    )
