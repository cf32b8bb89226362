"""The library: every annotation that has a builder, built on demand into the user's cache."""

from __future__ import annotations

import contextlib
import fcntl
import functools
import hashlib
from collections.abc import Callable, Iterator
from pathlib import Path

from vcage.assets.asset import Asset
from vcage.assets.model import read_model, write_model
from vcage.errors import InputFileError, SchemaMismatch, UnknownName
from vcage.files import atomic_folder, cache_dir, cache_path, resource
from vcage.schema.asset import Annotation, CatalogueEntry, PhysicalModel


class Library:
    """All assets by name; get one with :meth:`load`.

    Args:
        annotations: by name.
    """

    def __init__(self, annotations: dict[str, Annotation]):
        self._annotations = dict(sorted(annotations.items()))
        self._assets: dict[tuple[str, str], Asset] = {}

    @classmethod
    def load(cls, root: Path | None = None) -> Library:
        """Read every ``<root>/<name>/asset.json``; the project's own annotations by default.

        Raises:
            DamagedFile, SchemaMismatch: an annotation is damaged; names file and field.
            InputFileError: there is no annotation at all.
        """
        root = Path(root) if root is not None else resource("assets", "objects")
        annotations = {}
        for path in sorted(root.glob("*/asset.json")):
            annotation = Annotation.read(path)
            if annotation.name != path.parent.name:
                raise SchemaMismatch(
                    f"{path}: field name: {annotation.name!r} is not the folder's name {path.parent.name!r}",
                    hint="rename the folder or mend the field",
                    details={"path": str(path), "field": "name"},
                )
            annotations[annotation.name] = annotation
        if not annotations:
            raise InputFileError(f"no asset.json under {root}", hint="give the folder that holds one folder per asset")
        return cls(annotations)

    @property
    def names(self) -> list[str]:
        """Names of all assets, sorted."""
        return list(self._annotations)

    def annotation(self, name: str) -> Annotation:
        """Words and points of an asset.

        Raises:
            UnknownName: there is no such asset.
        """
        if name not in self._annotations:
            raise UnknownName("asset", name, self._annotations)
        return self._annotations[name]

    def asset(self, name: str, variant: str | None = None) -> Asset:
        """An asset with its model; the first variant by default.

        Raises:
            UnknownName: there is no such asset or variant.
            InputFileError: the annotation has no builder.
        """
        annotation = self.annotation(name)
        by_id = {v.id: v for v in annotation.variants}
        variant = variant if variant is not None else annotation.variants[0].id
        if variant not in by_id:
            raise UnknownName(f"variant of {name}", variant, by_id)
        key = (name, variant)
        if key not in self._assets:
            self._assets[key] = Asset(annotation, by_id[variant], built_model(name, variant))
        return self._assets[key]

    def entry(self, name: str) -> CatalogueEntry:
        """What a model sees of one asset."""
        return self.asset(name).entry()

    def entries(self) -> list[CatalogueEntry]:
        """What a model sees of the library, in the order of the names."""
        return [self.entry(name) for name in self.names]

    def unbuilt(self) -> list[tuple[str, str]]:
        """(name, variant) of every model that is not in the cache."""
        wanted = [(name, v.id) for name, annotation in self._annotations.items() for v in annotation.variants]
        return [pair for pair in wanted if not model_folder(*pair).is_dir()]

    def build_all(self, progress: Callable[[str, int, int], None] | None = None) -> None:
        """Build every variant that is not in the cache.

        Args:
            progress: called before each variant with its name, its number from 0, and how many there are.
        """
        wanted = self.unbuilt()
        for i, (name, variant) in enumerate(wanted):
            if progress is not None:
                progress(f"{name}/{variant}", i, len(wanted))
            self.asset(name, variant)


def model_folder(name: str, variant: str) -> Path:
    """Where a variant's model lies in the cache, built or not; the name changes with the builders' source."""
    digest = hashlib.sha256(f"{_source_hash()}/{name}/{variant}".encode()).hexdigest()[:16]
    return cache_path("assets", f"{name}-{variant}-{digest}")


def built_model(name: str, variant: str) -> PhysicalModel:
    """The model of a variant, from the cache or built into it.

    Raises:
        InputFileError: no builder has that name.
    """
    folder = model_folder(name, variant)
    if not folder.is_dir():
        with _only_one(folder):
            if not folder.is_dir():
                _build(name, variant, folder)
    return read_model(folder)


def _build(name: str, variant: str, folder: Path) -> None:
    from vcage.assets.builders import BUILDERS  # imported late: a full cache needs no builders

    if name not in BUILDERS:
        raise InputFileError(
            f"asset {name!r} has an annotation but no builder",
            hint=f"add {name!r} to a BUILDERS table of vcage/assets/builders, or remove its annotation",
            details={"name": name, "builders": sorted(BUILDERS)},
        )
    try:
        built = BUILDERS[name](variant)
    except KeyError as error:
        if error.args != (variant,):
            raise
        raise InputFileError(
            f"the builder of asset {name!r} knows no variant {variant!r}",
            hint=f"mend the variants in the asset.json of {name!r}, or its builder in vcage/assets/builders",
        ) from error
    with atomic_folder(folder) as part:
        write_model(built, part)


@contextlib.contextmanager
def _only_one(folder: Path) -> Iterator[None]:
    """Keep other processes from building into the same folder."""
    with open(cache_dir("assets") / f"{folder.name}.lock", "w") as handle:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield


@functools.cache
def _source_hash() -> str:
    """Hash of all sources that decide what a built model looks like."""
    here = Path(__file__).parent
    sources = [here / "model.py", *sorted(here.glob("builders/*.py")), *sorted(here.glob("textures/*.py"))]
    digest = hashlib.sha256()
    for path in sources:
        digest.update(path.relative_to(here).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()
