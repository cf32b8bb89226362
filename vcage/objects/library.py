"""The library: every annotation with a model, built on demand into the user's cache."""

from __future__ import annotations

import contextlib
import logging
import os
from collections.abc import Iterable, Sequence
from pathlib import Path

from vcage.base.errors import AssetLeftOut, InputFileError, UnknownName, mismatch
from vcage.base.files import data_path, resource, whole
from vcage.base.progress import Progress, silent
from vcage.base.workers import cores, map_in_processes
from vcage.objects import sources
from vcage.objects.asset import Asset, unbuilt_entry
from vcage.objects.lying import LIES, UNABLE, laid, standing_in_lying
from vcage.objects.painting import look, looks_of
from vcage.objects.points import check_meshes, check_points, check_size
from vcage.objects.rooms import rooms_of
from vcage.schema.asset import Annotation, CatalogueEntry, Variant

logger = logging.getLogger(__name__)

MAX_MODELS_IN_PROCESS = 8
"""Models that are built sooner than processes that build them are started."""

OWN_OBJECTS = "take one of those listed, or name the folder of yours in VCAGE_ASSETS"
"""The way out where no object has a name."""


class Library:
    """All assets by name; get one with :meth:`load`.

    Example:
        >>> library = Library.load()
        >>> library.asset("mug", library.entry("mug").variants[0].id).size

    Args:
        annotations: by name.
        folders: where each annotation lies, by name.
        left_out: why a kind is annotated but not there, by name.
    """

    def __init__(
        self, annotations: dict[str, Annotation], folders: dict[str, Path], left_out: dict[str, str] | None = None
    ):
        self._annotations = dict(sorted(annotations.items()))
        self._folders = folders
        self._assets: dict[tuple[str, str], Asset] = {}
        self._whole: set[tuple[str, str]] = set()
        self.left_out = dict(sorted((left_out or {}).items()))

    @classmethod
    def load(cls, root: Path | None = None) -> Library:
        """Read every ``<root>/<name>/asset.json``; those of :func:`object_folders` by default.

        Kinds of unfetched packages are left out (:attr:`left_out` lists them).

        Raises:
            DamagedFile, SchemaMismatch: an annotation is damaged, or a name occurs twice; names file and field.
            InputFileError: there is no annotation at all, or ``VCAGE_ASSETS`` names a folder without any.
        """
        roots = [Path(root)] if root is not None else object_folders()
        annotations, folders, left_out = {}, {}, {}
        for path in _annotation_files(roots):
            annotation = _read(path)
            if annotation.name in folders:
                first = folders[annotation.name] / "asset.json"
                text = f"{annotation.name!r} is the name of {first} already; expected another"
                hint = f"give it another name: rename the folder {path.parent} and the field"
                raise mismatch(path, "name", text, hint, first=str(first))
            folders[annotation.name] = path.parent
            reason = sources.missing(annotation)
            if reason is None:
                annotations[annotation.name] = annotation
            else:
                left_out[annotation.name] = reason
        if not folders:
            raise InputFileError(f"no asset.json under {roots[0]}", hint="give the folder with one folder per asset")
        return cls(annotations, folders, left_out)

    @property
    def names(self) -> list[str]:
        """Names of all assets, sorted."""
        return list(self._annotations)

    def annotation(self, name: str) -> Annotation:
        """Words and points of an asset.

        Raises:
            UnknownName: there is no such asset.
            AssetLeftOut: its package was not fetched.
        """
        if name in self.left_out:
            raise AssetLeftOut(f"the object {name!r} is not here", hint=self.left_out[name])
        if name not in self._annotations:
            raise UnknownName("asset", name, self._annotations, hint=OWN_OBJECTS)
        return self._annotations[name]

    def variants(self, names: Iterable[str] | None = None) -> list[tuple[str, str]]:
        """(name, variant) of all assets, or of those named, in the order of the names."""
        return [
            (name, v.id) for name in (self.names if names is None else names) for v in self.annotation(name).variants
        ]

    def asset(self, name: str, variant: str | None = None) -> Asset:
        """An asset with its model; the first variant by default.

        Raises:
            UnknownName: there is no such asset or variant.
            InputFileError: the annotation has no builder, or does not fit the model (see
                :func:`vcage.objects.points.check_points`), or a mesh of that does not load.
        """
        asset = self._described(name, variant)
        if (name, asset.variant.id) not in self._whole:
            check_meshes(asset)
            self._whole.add((name, asset.variant.id))
        return asset

    def _described(self, name: str, variant: str | None = None) -> Asset:
        """An asset of whose model only the description is read."""
        annotation = self.annotation(name)
        variant = variant if variant is not None else annotation.variants[0].id
        shown = look(annotation, variant)
        if shown is None:
            raise UnknownName(f"variant of {name}", variant, looks_of(annotation))
        key = (name, variant)
        if key not in self._assets and shown.laid is not None:
            self._assets[key] = self._laid(self._described(name, shown.laid), shown)
        if key not in self._assets:
            path = self._folders[name] / "asset.json"
            check_size(annotation, variant, path)
            model = sources.model(annotation, shown, self._folders[name])
            asset = Asset(annotation, shown, model)
            check_points(asset, path)
            self._assets[key] = asset
        return self._assets[key]

    def _laid(self, standing: Asset, shown: Variant) -> Asset:
        """An asset on its side.

        Raises:
            InputFileError: it cannot be stood up.
        """
        stands = standing_in_lying(standing)
        if stands is None:
            message = f"{standing.name} {UNABLE}"
            raise InputFileError(message, hint=f"take {LIES}")
        return laid(standing, stands, shown)

    def entry(self, name: str) -> CatalogueEntry:
        """The entry of an asset, as models see it; meshes are read only to measure rooms that were not measured before.

        Raises:
            UnknownName, InputFileError: see :meth:`asset`.
        """
        asset = self._described(name)
        return asset.entry().model_copy(update={"rooms": rooms_of(asset)})

    def entries(self) -> list[CatalogueEntry]:
        """Return all catalogue entries in the order of the names; builds missing 3D models first.

        Raises:
            InputFileError: see :meth:`asset`.
        """
        self._make(self._unbuilt_firsts())
        return [self.entry(name) for name in self.names]

    def listing(self) -> list[CatalogueEntry]:
        """As :meth:`entries`, but executes only the project's own ``model.py``: a kind that needs another one has
        no size.

        Raises:
            InputFileError: see :meth:`asset`.
        """
        ours, firsts = resource("assets", "objects"), self._unbuilt_firsts()
        foreign = {name for name, _ in firsts if self._folders[name].parent != ours}
        self._make([key for key in firsts if key[0] not in foreign])
        return [unbuilt_entry(self.annotation(name)) if name in foreign else self.entry(name) for name in self.names]

    def _unbuilt_firsts(self) -> list[tuple[str, str]]:
        """(name, variant) of every first variant whose model is not in the cache."""
        firsts = {(name, self.annotation(name).variants[0].id) for name in self.names}
        return [key for key in self.unbuilt() if key in firsts]

    def unbuilt(self) -> list[tuple[str, str]]:
        """(name, variant) of every model that is not in the cache."""
        return [
            (name, variant.id)
            for name, annotation in self._annotations.items()
            for variant in annotation.variants
            if not sources.model_folder(annotation, variant, self._folders[name]).is_dir()
        ]

    def build_all(self, progress: Progress = silent) -> list[InputFileError]:
        """Build every variant that is not in the cache; returns why some could not be built.

        Args:
            progress: called for every variant.
        """
        wanted, failures = self.unbuilt(), []
        self._make(wanted, progress)
        for name, variant in wanted:
            try:
                self.asset(name, variant)
            except InputFileError as error:
                failures.append(error)
        return failures

    def _make(self, wanted: Sequence[tuple[str, str]], progress: Progress = silent) -> None:
        """Make models into the cache, with a process for each core if it takes long. One that cannot be
        made is left for :meth:`asset` to complain about."""
        if len(wanted) > MAX_MODELS_IN_PROCESS:
            logger.info("building %d models of objects, once for all runs", len(wanted))
        tasks = []
        for name, variant in wanted:
            annotation = self._annotations[name]
            tasks.append((annotation, next(v for v in annotation.variants if v.id == variant), self._folders[name]))
        made = map_in_processes(_make_one, tasks, cores() if len(tasks) > MAX_MODELS_IN_PROCESS else 1)
        for number, name in enumerate(made):
            progress(name, number, len(tasks))


def _make_one(task: tuple[Annotation, Variant, Path]) -> str:
    annotation, variant, folder = task
    with contextlib.suppress(InputFileError):
        sources.model(annotation, variant, folder)
    return f"{annotation.name}/{variant.id}"


def package_models() -> dict[str, list[str]]:
    """Return the ids of models that annotations take from packages, by package, fetched or not.

    Raises:
        DamagedFile, SchemaMismatch: an annotation is damaged; names file and field.
    """
    wanted: dict[str, set[str]] = {}
    for annotation in map(_read, _annotation_files(object_folders())):
        models = {variant.package.model for variant in annotation.variants if variant.package is not None}
        if models:
            wanted.setdefault(annotation.source, set()).update(models)
    return {source: sorted(models) for source, models in wanted.items()}


def object_folders() -> list[Path]:
    """The folders of objects: the project's own, the imported ones, and those named by ``$VCAGE_ASSETS``.

    Raises:
        InputFileError: ``VCAGE_ASSETS`` names no folder, or a folder without an object.
    """
    named = [Path(name).expanduser() for name in os.environ.get("VCAGE_ASSETS", "").split(os.pathsep) if name]
    for folder in named:
        if not any(folder.glob("*/asset.json")):
            why = f"no asset.json under {folder}" if folder.is_dir() else f"{folder} is not a folder"
            raise InputFileError(
                f"VCAGE_ASSETS: {why}",
                hint=f"give folders with one folder per object, with {os.pathsep!r} between them",
                details={"path": str(folder)},
            )
    return [resource("assets", "objects"), imported_objects(), *named]


def imported_objects() -> Path:
    """Folder of imported objects: one sub-folder per object, with ``asset.json`` and its models."""
    return data_path("objects")


def _annotation_files(folders: Iterable[Path]) -> list[Path]:
    """The annotations of all objects in the folders; those being written or replaced are left out."""
    return [path for folder in folders for path in sorted(folder.glob("*/asset.json")) if whole(path.parent)]


def _read(path: Path) -> Annotation:
    annotation = Annotation.read(path)
    if annotation.name != path.parent.name:
        text = f"{annotation.name!r} is not the folder's name {path.parent.name!r}"
        raise mismatch(path, "name", text, "rename the folder or fix the field")
    return annotation
