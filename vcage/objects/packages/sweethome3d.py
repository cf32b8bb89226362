"""Models of the Debian package ``sweethome3d-furniture``: five libraries under Creative Commons licences."""

from __future__ import annotations

import functools
import zipfile
from collections.abc import Sequence
from pathlib import Path, PurePosixPath

from vcage.base.errors import FetchFailed
from vcage.objects.packages import catalogue
from vcage.objects.packages.catalogue import CatalogueModel
from vcage.objects.packages.package import Credit, Package
from vcage.objects.packages.surfaces import Y_UP_TO_Z_UP, Surface, fitted, read_surfaces, turned
from vcage.schema.asset import PackageModel
from vcage.setup import apt

DEBIAN_NAME = "sweethome3d-furniture"
LIBRARIES = "usr/share/sweethome3d/furniture"
LICENCE = "LICENSE.TXT"


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
        apt.unpack(archive, unpacked)
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

    def _surfaces(self, model: PackageModel) -> Sequence[Surface]:
        path, entry = _catalogue(self.folder())[model.model]
        upright = turned(read_surfaces(self.folder() / path), Y_UP_TO_Z_UP @ entry.rotation)
        return fitted(upright, entry.size)

    def _credit(self, model: str) -> Credit:
        _, entry = _catalogue(self.folder())[model]
        return Credit(entry.title, entry.creator, entry.licence)


def extract_library(library: Path, models: set[str], folder: Path) -> None:
    """Extract catalogue, licence and the folders of some models from an ``.sh3f`` zip.

    Raises:
        zipfile.BadZipFile: the zip is damaged.
        KeyError: it has no catalogue.
    """
    with zipfile.ZipFile(library) as archive:
        entries = catalogue.parse(archive.read(catalogue.FILE).decode("latin-1"))
        kept = tuple(f"{PurePosixPath(entries[model].path).parent}/" for model in models & entries.keys())
        for name in archive.namelist():
            if name in (catalogue.FILE, LICENCE) or (kept and name.startswith(kept)):
                archive.extract(name, folder)


@functools.lru_cache(maxsize=4)
def _read_catalogue(path: Path, _changed: int) -> dict[str, CatalogueModel]:
    return catalogue.parse(path.read_text(encoding="latin-1"))


def _catalogue(folder: Path) -> dict[str, tuple[str, CatalogueModel]]:
    """Model id → (path of its file under the package's folder, entry), of every library that is there."""
    found = {}
    for path in sorted(folder.glob(f"*/{catalogue.FILE}")):
        for model, entry in _read_catalogue(path, path.stat().st_mtime_ns).items():
            found[model] = (f"{path.parent.name}/{entry.path}", entry)
    return found
