"""Models of the Debian package ``sweethome3d-furniture``: five libraries under Creative Commons licences.

A library is an ``.sh3f`` zip with a catalogue in Java's properties format: every model has a number, and its properties
are lines ``key#number=value``. Lengths are in centimetres, and a model's frame is x right, y up, z towards the viewer.
"""

from __future__ import annotations

import functools
import re
import zipfile
from collections.abc import Collection
from pathlib import Path, PurePosixPath

import numpy as np

from vcage.base.errors import FetchFailed
from vcage.objects.packages.package import Package, PackagedModel
from vcage.objects.packages.surfaces import Y_UP_TO_Z_UP
from vcage.setup import apt

VERSION = "1.8"
_DEBIAN_NAME = "sweethome3d-furniture"
_LIBRARIES = "usr/share/sweethome3d/furniture"
_LICENCE = "LICENSE.TXT"
_CATALOGUE = "PluginFurnitureCatalog.properties"
_LINE = re.compile(r"(?P<key>[A-Za-z]+)(?:#(?P<number>\d+))?\s*=\s*(?P<value>.*)")
_ESCAPE = re.compile(r"\\u([0-9a-fA-F]{4})")


def _download(work: Path) -> Path:
    (package,) = apt.AptMirror(work).download([_DEBIAN_NAME])
    version = apt.field_of(package, "Version")
    if version.split("-")[0] != VERSION:
        raise FetchFailed(
            f"the mirror holds {_DEBIAN_NAME} {version}; our annotations are of {VERSION}",
            hint="use a mirror of a release that has it: Debian 11 to 13",
        )
    return package


def _extract(archive: Path, models: Collection[str], folder: Path) -> None:
    """Extract each library's catalogue, licence and folders of the models into a folder of its name."""
    unpacked = archive.parent / "unpacked"
    apt.unpack_deb(archive, unpacked)
    libraries = sorted((unpacked / _LIBRARIES).glob("*.sh3f"))
    if not libraries:
        raise FetchFailed(f"{archive.name} holds no furniture library under {_LIBRARIES}")
    for library in libraries:
        with zipfile.ZipFile(library) as content:
            entries = _read_catalogue(content.read(_CATALOGUE).decode("latin-1"))
            kept = tuple(f"{PurePosixPath(entries[model].file).parent}/" for model in models if model in entries)
            for name in content.namelist():
                if name in (_CATALOGUE, _LICENCE) or (kept and name.startswith(kept)):
                    content.extract(name, folder / library.stem)


def _index(folder: Path) -> dict[str, PackagedModel]:
    found: dict[str, PackagedModel] = {}
    for path in sorted(folder.glob(f"*/{_CATALOGUE}")):
        found |= _catalogue_file(path, path.stat().st_mtime_ns)
    return found


@functools.lru_cache(maxsize=8)
def _catalogue_file(path: Path, _changed: int) -> dict[str, PackagedModel]:
    return _read_catalogue(path.read_text(encoding="latin-1"), f"{path.parent.name}/")


def _read_catalogue(text: str, prefix: str = "") -> dict[str, PackagedModel]:
    """The models of a catalogue's text by id; those without a size or a file are left out.

    Args:
        text: of the catalogue.
        prefix: of the files' paths.
    """
    library: dict[str, str] = {}
    models: dict[str, dict[str, str]] = {}
    for line in text.splitlines():
        match = _LINE.fullmatch(line.strip())
        if match:
            value = _ESCAPE.sub(lambda code: chr(int(code[1], 16)), match["value"])
            (models.setdefault(match["number"], {}) if match["number"] else library)[match["key"]] = value
    needed = ("id", "model", "width", "depth", "height")
    whole = [fields for fields in models.values() if all(fields.get(name) for name in needed)]
    return {fields["id"]: _model(fields, library, prefix) for fields in whole}


def _model(fields: dict[str, str], library: dict[str, str], prefix: str) -> PackagedModel:
    entries = fields.get("modelRotation", "1 0 0 0 1 0 0 0 1").split()
    width, depth, height = (float(fields[name]) / 100 for name in ("width", "depth", "height"))
    return PackagedModel(
        file=prefix + fields["model"].lstrip("/"),
        title=fields.get("name", fields["id"]),
        creator=fields.get("creator", library.get("provider", "unknown")),
        licence=fields.get("license", library.get("license", "unknown")),
        rotation=Y_UP_TO_Z_UP @ np.array([float(x) for x in entries]).reshape(3, 3),
        size=(width, depth, height),
    )


SWEET_HOME_3D = Package(
    name="sweethome3d",
    version=VERSION,
    origin=f"Debian package {_DEBIAN_NAME}",
    megabytes=120,
    download=_download,
    extract=_extract,
    index=_index,
)
