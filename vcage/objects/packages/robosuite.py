"""Object meshes with textures from the PyPI package ``robosuite``."""

from __future__ import annotations

import zipfile
from collections.abc import Sequence
from pathlib import Path

from vcage.base.errors import FetchFailed
from vcage.objects.packages.package import Credit, Package
from vcage.objects.packages.surfaces import MaterialSurface, read_surfaces
from vcage.schema.asset import PackageModel
from vcage.setup import python_index

PYPI_NAME = "robosuite"
MESHES = "robosuite/models/assets/objects/meshes"
TEXTURES = "robosuite/models/assets/textures"
LICENCE = "robosuite-{version}.dist-info/licenses/LICENSE"


class Robosuite(Package):
    """Groceries of robosuite's pick-and-place task; the meshes are in metres, z up."""

    name = "robosuite"
    version = "1.5.2"
    origin = f"PyPI package {PYPI_NAME}"
    megabytes = 157

    def _download(self, work: Path) -> Path:
        return python_index.download(PYPI_NAME, self.version, "wheel", work)

    def _extract(self, archive: Path, models: set[str], folder: Path) -> None:
        try:
            with zipfile.ZipFile(archive) as wheel:
                names = set(wheel.namelist())
                kept = {LICENCE.format(version=self.version)} & names
                for model in models:
                    materials = f"{MESHES}/{model}.mtl"
                    kept |= {f"{MESHES}/{model}.obj", materials} & names
                    if materials in names:
                        kept |= _pictures(wheel.read(materials).decode()) & names
                for name in sorted(kept):
                    # All in one folder: there a picture is found whatever path the MTL file gives.
                    (folder / Path(name).name).write_bytes(wheel.read(name))
        except zipfile.BadZipFile as error:
            raise FetchFailed(f"{archive.name} is damaged: {error}") from error

    def _file(self, model: str) -> str | None:
        return f"{model}.obj"

    def _surfaces(self, model: PackageModel) -> Sequence[MaterialSurface]:
        return read_surfaces(self.folder() / f"{model.model}.obj")

    def _credit(self, model: str) -> Credit:
        return Credit(model, "the robosuite authors", "MIT; its text lies beside the package's files")


def _pictures(materials: str) -> set[str]:
    """Paths in the wheel of the pictures that an MTL file names."""
    lines = [line.split(maxsplit=1) for line in materials.splitlines() if line.startswith("map_")]
    return {f"{TEXTURES}/{Path(words[1].strip()).name}" for words in lines if len(words) == 2}
