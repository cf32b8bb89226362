"""Robots and scene templates by name: ``assets/robots/<name>.yml`` and ``assets/scenes/<name>.yml``."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import TypeVar

from vcage.errors import DamagedFile, MissingDependency, UnknownName
from vcage.files import resource
from vcage.schema.base import Document
from vcage.schema.robot import Robot
from vcage.schema.scene import SceneTemplate

AnyDocument = TypeVar("AnyDocument", bound=Document)


def load_robot(name: str) -> Robot:
    """The robot called ``name``.

    Raises:
        UnknownName: there is none; lists those there are.
        DamagedFile, SchemaMismatch: its file is not what it should be.
    """
    return _load(Robot, "robot", "robots", name)


def load_template(name: str) -> SceneTemplate:
    """The scene template called ``name``; raises as :func:`load_robot`."""
    return _load(SceneTemplate, "scene", "scenes", name)


def available(folder: str) -> list[str]:
    """Names of the files of ``assets/<folder>``, sorted."""
    return sorted(path.stem for path in resource("assets", folder).glob("*.yml"))


def _load(kind: type[AnyDocument], what: str, folder: str, name: str) -> AnyDocument:
    import yaml

    names = available(folder)
    if name not in names:
        raise UnknownName(what, name, names)
    path = resource("assets", folder, f"{name}.yml")
    try:
        data = yaml.safe_load(path.read_text(encoding="utf-8"))
    except yaml.YAMLError as error:
        raise DamagedFile(f"{path} is not valid YAML: {error}", hint="mend the file") from error
    return kind.parse(data, path)


def package_file(name: str) -> Path:
    """The file that ``package:path`` names, inside an installed Python package.

    Raises:
        MissingDependency: the package is not installed.
        DamagedFile: it has no such file.
    """
    package, _, inside = name.partition(":")
    spec = find_spec(package)
    if spec is None or not spec.submodule_search_locations:
        raise MissingDependency(f"the robot needs the package {package!r}", hint=f"pip install {package}")
    path = Path(spec.submodule_search_locations[0]) / inside
    if not path.is_file():
        raise DamagedFile(
            f"the package {package!r} has no file {inside}", hint=f"pip install --force-reinstall {package}"
        )
    return path
