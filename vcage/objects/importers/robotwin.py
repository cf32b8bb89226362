"""Import the objects of RoboTwin, unchanged as they are downloaded: ``objects/NNN_name/…``.

An object becomes a folder with ``asset.json`` and one sub-folder per variant, as :mod:`vcage.objects.model` reads
them. An annotation of ours has one set of points for all variants; variants with other points become objects of
their own, named after the first of them.
"""

from __future__ import annotations

import os.path
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from vcage.base.errors import InputFileError
from vcage.base.files import atomic_folder
from vcage.base.progress import Progress, silent
from vcage.objects.asset import Asset
from vcage.objects.importers import Imported, robotwin_articulated, robotwin_rigid
from vcage.objects.importers.converted import Converted
from vcage.objects.importers.robotwin_data import read_object
from vcage.objects.importers.robotwin_points import same_points
from vcage.objects.importers.robotwin_words import NUMBERED, TakenNames, called, identifier, plural, unique
from vcage.objects.library import imported_objects
from vcage.objects.model import read_model, schema_errors, write_model
from vcage.objects.points import check_meshes, check_points
from vcage.schema.asset import Annotation, Words


def import_robotwin(
    folder: Path, into: Path | None = None, progress: Progress = silent, *, force: bool = False
) -> list[Imported]:
    """Import one object's folder, or all objects of a folder; what cannot be imported does not stop the others.

    Args:
        folder: ``objects/NNN_name``, ``objects``, or the folder that holds ``objects``.
        into: where the objects go; :func:`vcage.objects.library.imported_objects` when not given.
        progress: called before each object.
        force: replace objects that were imported before.

    Returns:
        One entry per object, including refused ones.

    Raises:
        InputFileError: the folder is missing, or holds no object.
    """
    into = imported_objects() if into is None else Path(into)
    folders = robotwin_folders(Path(folder))
    done: list[Imported] = []
    for i, source in enumerate(folders):
        progress(source.name, i, len(folders))
        name, warnings = identifier(source), list[str]()
        try:
            written = _import(source, into, TakenNames(into, done, force), warnings.append)
            done += [Imported(own, into / own, warnings if own == name else []) for own in written]
        except InputFileError as error:
            done.append(Imported(name, into / name, warnings, error))
    return done


def robotwin_folders(folder: Path) -> list[Path]:
    """The object folders in a folder, or that folder itself.

    Raises:
        InputFileError: there is none.
    """
    if not folder.is_dir():
        raise InputFileError(f"{folder} is not a folder", hint="give the folder 'objects' of RoboTwin's assets")
    if _is_object(folder):
        return [folder]
    inner = folder / "objects"
    places = [inner] if inner.is_dir() else [folder]
    found = [
        path
        for place in places
        for path in sorted(place.iterdir())
        if path.is_dir() and (_is_object(path) or NUMBERED.fullmatch(path.name))
    ]
    if not found:
        raise InputFileError(
            f"{folder} holds no RoboTwin object; expected NNN_name/visual/base0.glb or NNN_name/<id>/mobility.urdf",
            hint="give an object's folder, or the folder 'objects' of RoboTwin's assets",
            details={"path": str(folder)},
        )
    return found


def _is_object(folder: Path) -> bool:
    return bool(robotwin_rigid.variant_numbers(folder)) or any(folder.glob("*/mobility.urdf"))


def _import(source: Path, into: Path, names: TakenNames, report: Callable[[str], None]) -> list[str]:
    """Write the objects that a folder becomes; returns their names.

    Args:
        source: the folder.
        into: where the objects go.
        names: that are taken.
        report: called with a sentence about each omission or assumption.
    """
    name = identifier(source)
    names.claim(name, source)
    named: dict[str, list[Converted]] = {}
    for group in _by_points(_variants(source, report)):
        other = f"{name}_{group[0].variant.id.removeprefix('base')}"
        named[unique(other, named) if named else name] = group
    for own in named:
        names.claim(own, source)
    with schema_errors(source):
        annotations = {own: _annotation(own, source, group) for own, group in named.items()}
    _write(annotations, named, into)
    for own, group in named.items():
        if own != name:
            ids = ", ".join(one.variant.id for one in group)
            report(f"{source}: variant {ids} has other points than the first: imported as {own}")
    return list(named)


def _variants(source: Path, report: Callable[[str], None]) -> list[Converted]:
    """All usable variants, with different ids; the others are reported."""
    info = _points_info(source, report)
    done: dict[str, Converted] = {}
    errors = []
    for path, convert in _converters(source, info, report):
        try:
            with schema_errors(path):
                one = convert()
        except InputFileError as error:
            errors.append(error)
        else:
            variant = one.variant.model_copy(update={"id": unique(one.variant.id, done)})
            done[variant.id] = replace(one, variant=variant)
    if errors and not done:
        raise errors[0]
    for error in errors:
        report(f"{error.message}: this variant is left out")
    if not done:
        raise InputFileError(
            f"{source} is empty; expected visual/base0.glb and model_data0.json, or <id>/mobility.urdf",
            hint="download the object again",
            details={"path": str(source)},
        )
    return list(done.values())


def _converters(
    source: Path, info: dict[str, Any], report: Callable[[str], None]
) -> list[tuple[Path, Callable[[], Converted]]]:
    """For each variant its annotation file and its converter."""
    folders = sorted((path.parent for path in source.glob("*/mobility.urdf")), key=lambda p: (len(p.name), p.name))
    if folders:  # base{K}.glb beside them are pictures of the same thing
        return [
            (folder / "model_data.json", partial(robotwin_articulated.convert, folder, info, report))
            for folder in folders
        ]
    return [
        (source / f"model_data{number}.json", partial(robotwin_rigid.convert, source, number, info, report))
        for number in robotwin_rigid.variant_numbers(source)
    ]


def _points_info(source: Path, report: Callable[[str], None]) -> dict[str, Any]:
    path = source / "points_info.json"
    if not os.path.lexists(path):
        return {}
    try:
        return read_object(path)
    except InputFileError as error:
        report(f"{error.message}: not used")
        return {}


def _by_points(converted: Sequence[Converted]) -> list[list[Converted]]:
    groups: list[list[Converted]] = []
    for one in converted:
        for group in groups:
            first = group[0]
            if same_points(first.contacts, one.contacts) and same_points(first.functionals, one.functionals):
                group.append(one)
                break
        else:
            groups.append([one])
    return groups


def _annotation(name: str, source: Path, group: Sequence[Converted]) -> Annotation:
    words = called(source)
    return Annotation(
        name=name,
        source="robotwin",
        words=Words(
            name=words,
            plural=plural(words),
            description=group[0].description or f"A {words}, imported from RoboTwin.",
            category="imported",
        ),
        variants=[one.variant for one in group],
        contact_points=group[0].contacts,
        functional_points=group[0].functionals,
    )


def _write(annotations: Mapping[str, Annotation], groups: Mapping[str, Sequence[Converted]], into: Path) -> None:
    """Write all objects of a folder, or none; the output is checked as the library will check it."""
    with ExitStack() as finishing:  # folders get their names when the last of them has passed
        for name, annotation in annotations.items():
            part = finishing.enter_context(atomic_folder(into / name))
            for one in groups[name]:
                folder = part / one.variant.id
                folder.mkdir()
                write_model(one.built, folder)
                asset = Asset(annotation, one.variant, read_model(folder))
                check_points(asset, into / name / "asset.json")
                check_meshes(asset)
            annotation.write(part / "asset.json")
