"""Models of the Debian package ``sweethome3d-furniture``: five libraries under Creative Commons licences.

A library is an ``.sh3f`` zip with a catalogue in Java's properties format: every model has a number, and its properties
are lines ``key#number=value``. Lengths are in centimetres, and a model's frame is x right, y up, z towards the viewer.
"""

from __future__ import annotations

import functools
import re
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

import numpy as np

from vcage.base.errors import FetchFailed
from vcage.objects.packages.package import Credit, Package
from vcage.objects.packages.surfaces import Y_UP_TO_Z_UP, MaterialSurface, read_surfaces, stretched, turned
from vcage.schema.asset import PackageModel
from vcage.setup import apt

DEBIAN_NAME = "sweethome3d-furniture"
LIBRARIES = "usr/share/sweethome3d/furniture"
LICENCE = "LICENSE.TXT"
CATALOGUE = "PluginFurnitureCatalog.properties"
_LINE = re.compile(r"(?P<key>[A-Za-z]+)(?:#(?P<number>\d+))?\s*=\s*(?P<value>.*)")
_ESCAPE = re.compile(r"\\u([0-9a-fA-F]{4})")


class SweetHome3D(Package):
    """Household objects as OBJ files with materials, in zips with a catalogue that tells their size.

    A library's zip becomes a folder of its name with the catalogue, the licence, and the folders of the models
    asked for.
    """

    name = "sweethome3d"
    version = "1.8"
    origin = f"Debian package {DEBIAN_NAME}"
    megabytes = 120

    def _download(self, work: Path) -> Path:
        (package,) = apt.AptMirror(work).download([DEBIAN_NAME])
        version = apt.field_of(package, "Version")
        if version.split("-")[0] != self.version:
            raise FetchFailed(
                f"the mirror holds {DEBIAN_NAME} {version}; our annotations are of {self.version}",
                hint="take a mirror of a release that has it: Debian 11 to 13",
            )
        return package

    def _extract(self, archive: Path, models: set[str], folder: Path) -> None:
        unpacked = archive.parent / "unpacked"
        apt.unpack_deb(archive, unpacked)
        libraries = sorted((unpacked / LIBRARIES).glob("*.sh3f"))
        if not libraries:
            raise FetchFailed(f"{archive.name} holds no furniture library under {LIBRARIES}")
        for library in libraries:
            try:
                extract_library(library, models, folder / library.stem)
            except (zipfile.BadZipFile, KeyError) as error:
                raise FetchFailed(f"{library.name} of {archive.name} is damaged: {error}") from error

    def _file(self, model: str) -> str | None:
        entry = _catalogue(self.folder()).get(model)
        return entry and entry[0]

    def _surfaces(self, model: PackageModel) -> Sequence[MaterialSurface]:
        path, entry = _catalogue(self.folder())[model.model]
        upright = turned(read_surfaces(self.folder() / path), Y_UP_TO_Z_UP @ entry.rotation)
        return stretched(upright, entry.size)

    def _credit(self, model: str) -> Credit:
        _, entry = _catalogue(self.folder())[model]
        return Credit(entry.title, entry.creator, entry.licence)


def extract_library(library: Path, models: set[str], folder: Path) -> None:
    """Extract catalogue, licence and the folders of some models from an ``.sh3f`` zip.

    Args:
        library: the zip.
        models: ids of those that are wanted.
        folder: to extract into.

    Raises:
        zipfile.BadZipFile: the zip is damaged.
        KeyError: it has no catalogue.
    """
    with zipfile.ZipFile(library) as archive:
        entries = read_catalogue(archive.read(CATALOGUE).decode("latin-1"))
        kept = tuple(f"{PurePosixPath(entries[model].path).parent}/" for model in models & entries.keys())
        for name in archive.namelist():
            if name in (CATALOGUE, LICENCE) or (kept and name.startswith(kept)):
                archive.extract(name, folder)


@functools.lru_cache(maxsize=4)
def _catalogue_file(path: Path, _changed: int) -> dict[str, CatalogueModel]:
    return read_catalogue(path.read_text(encoding="latin-1"))


def _catalogue(folder: Path) -> dict[str, tuple[str, CatalogueModel]]:
    """Model id → (path of its file under the package's folder, entry), of every library that is there."""
    found = {}
    for path in sorted(folder.glob(f"*/{CATALOGUE}")):
        for model, entry in _catalogue_file(path, path.stat().st_mtime_ns).items():
            found[model] = (f"{path.parent.name}/{entry.path}", entry)
    return found


# --- the catalogue -------------------------------------------------------------------------------------------


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


def read_catalogue(text: str) -> dict[str, CatalogueModel]:
    """The models of a catalogue's text by id; those without a size or a file are left out."""
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
