"""Robots, scene templates and ranges of randomisation by name: ``assets/{robots,scenes,randomisation}/<name>.yml``.

Robots that were imported lie in the same way in the user's data folder (:mod:`vcage.sim.robotwin.importing`).
"""

from __future__ import annotations

from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import TypeVar

from vcage.base.commands import pip_command
from vcage.base.errors import DamagedFile, MissingDependency, MissingStage, UnknownName
from vcage.base.files import data_path, resource
from vcage.base.reading import read_yaml
from vcage.schema.base import Document
from vcage.schema.randomisation import Randomisation
from vcage.schema.robot import Robot
from vcage.schema.scene import SceneTemplate

AnyDocument = TypeVar("AnyDocument", bound=Document)


def load_robot(name: str) -> Robot:
    """The robot called ``name``.

    Raises:
        UnknownName: there is none; lists the known ones.
        DamagedFile, SchemaMismatch: its file is damaged or has wrong fields.
    """
    return _load(Robot, "robot", "robots", name)


def load_template(name: str, robot: str | None = None) -> SceneTemplate:
    """The scene template called ``name``; raises as :func:`load_robot`.

    Args:
        robot: replaces the template's own.
    """
    template = _load(SceneTemplate, "scene", "scenes", name)
    return template if robot is None else template.model_copy(update={"robot": load_robot(robot).name})


def load_randomisation(name: str) -> Randomisation:
    """The ranges called ``name`` (``assets/randomisation/<name>.yml``), or those of a YAML file.

    Args:
        name: of ranges, or the path of a file that ends in .yml or .yaml.

    Raises:
        MissingStage: the file does not exist.
        UnknownName: such ranges do not exist, or one of their textures has no painter.
        DamagedFile, SchemaMismatch: as for :func:`load_robot`.
    """
    if not name.endswith((".yml", ".yaml")):
        return _painted(_load(Randomisation, "randomisation", "randomisation", name))
    path = Path(name).expanduser()
    if not path.is_file():
        raise MissingStage(
            f"{path} does not exist", hint=f"check the path, or take one of {available('randomisation')}"
        )
    ranges = Randomisation.parse(read_yaml(path), path)
    return _painted(ranges).model_copy(update={"name": path.name})  # so that it differs from our own of that name


def _painted(ranges: Randomisation) -> Randomisation:
    """The ranges, if there is a painter for each of their textures."""
    from vcage.objects.surface_pictures import SURFACES, painter_of

    for where in SURFACES:
        for name in getattr(ranges.look.surfaces, where):
            painter_of(where, name)
    return ranges


def available(folder: str) -> list[str]:
    """Sorted names of the files of ``assets/<folder>``, ours and the user's."""
    return sorted(_paths(folder))


def _paths(folder: str) -> dict[str, Path]:
    """Path by name; ours take precedence over the user's."""
    places = (data_path(folder), resource("assets", folder))
    return {path.stem: path for place in places for path in place.glob("*.yml")}


def _load(kind: type[AnyDocument], what: str, folder: str, name: str) -> AnyDocument:
    paths = _paths(folder)
    if name not in paths:
        raise UnknownName(what, name, paths)
    return _parsed(kind, paths[name], paths[name].stat().st_mtime_ns)


@lru_cache(maxsize=32)
def _parsed(kind: type[AnyDocument], path: Path, _changed: int) -> AnyDocument:
    return kind.parse(read_yaml(path), path)


def package_file(name: str) -> Path:
    """The file called ``package:path`` in an installed Python package, ``assets:path`` in ours, or ``file:/path``.

    Raises:
        MissingDependency: the package is not installed.
        DamagedFile: it has no such file.
    """
    package, _, inside = name.partition(":")
    if package == "assets":
        return resource("assets", *inside.split("/"))
    if package == "file":
        if not Path(inside).is_file():
            raise DamagedFile(f"the robot's file {inside} is missing", hint="import the robot again")
        return Path(inside)
    spec = find_spec(package)
    if spec is None or not spec.submodule_search_locations:
        raise MissingDependency(f"the robot needs the package {package!r}", command=pip_command(package))
    path = Path(spec.submodule_search_locations[0]) / inside
    if not path.is_file():
        raise DamagedFile(
            f"the package {package!r} has no file {inside}", command=pip_command("--force-reinstall", package)
        )
    return path
