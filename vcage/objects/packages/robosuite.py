"""Object meshes with textures from the PyPI package ``robosuite``: groceries, in metres, z up."""

from __future__ import annotations

import zipfile
from collections.abc import Collection
from functools import partial
from pathlib import Path

from vcage.objects.packages.package import Package, PackagedModel
from vcage.setup.python_index import download

VERSION = "1.5.2"
_MESHES = "robosuite/models/assets/objects/meshes"
_TEXTURES = "robosuite/models/assets/textures"
_LICENCE = f"robosuite-{VERSION}.dist-info/licenses/LICENSE"


def _extract(archive: Path, models: Collection[str], folder: Path) -> None:
    with zipfile.ZipFile(archive) as wheel:
        names = set(wheel.namelist())
        wanted = {_LICENCE}
        for model in models:
            materials = f"{_MESHES}/{model}.mtl"
            wanted |= {f"{_MESHES}/{model}.obj", materials}
            if materials in names:
                wanted |= _pictures(wheel.read(materials).decode())
        for name in sorted(wanted & names):
            # All in one folder: a picture is found there under any path in the MTL file.
            (folder / Path(name).name).write_bytes(wheel.read(name))


def _pictures(materials: str) -> set[str]:
    """Paths in the wheel of the pictures that an MTL file names."""
    lines = [line.split(maxsplit=1) for line in materials.splitlines() if line.startswith("map_")]
    return {f"{_TEXTURES}/{Path(words[1].strip()).name}" for words in lines if len(words) == 2}


def _index(folder: Path) -> dict[str, PackagedModel]:
    licence = "MIT; its text lies beside the package's files"
    return {
        path.stem: PackagedModel(path.name, path.stem, "the robosuite authors", licence)
        for path in folder.glob("*.obj")
    }


ROBOSUITE = Package(
    name="robosuite",
    version=VERSION,
    origin="PyPI package robosuite",
    megabytes=157,
    download=partial(
        download, f"robosuite=={VERSION}", "b9e02df55de8949739de6ba1d196d2ba59cf33c51a76efcfbe5c2f73cdcf99ce"
    ),
    extract=_extract,
    index=_index,
)
