"""The floors of docs/architecture.md: a module imports only from floors below its own, or from its own package."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MODULES = sorted((ROOT / "vcage").rglob("*.py"))


def floors() -> dict[str, int]:
    """Package or top-level module → floor, from the table."""
    table = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (\d+) \|([^|]+)\|", table, re.MULTILINE)
    return {name: int(floor) for floor, names in rows for name in re.findall(r"`vcage\.(\w+)`", names)}


def imported(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """(line, dotted name) of every import, those inside functions too."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from ((node.lineno, f"{node.module}.{alias.name}") for alias in node.names)


def breaches(source: str, package: str) -> list[str]:
    """Imports of a module of ``package`` that its floor does not allow."""
    table, found = floors(), []
    for line, name in imported(ast.parse(source)):
        top, _, rest = name.partition(".")
        other = rest.split(".")[0]
        if top in ("tests", "benchmarks", "skills"):
            found.append(f"line {line}: {name}")
        elif top == "vcage" and other in table and other != package and table[other] >= table[package]:
            found.append(f"line {line}: {name}, floor {table[other]}, from floor {table[package]}")
    return found


def test_the_table_names_every_package_and_no_other():
    there = {
        path.stem for path in (ROOT / "vcage").iterdir() if path.suffix == ".py" or (path / "__init__.py").exists()
    }
    assert set(floors()) == there - {"__init__"}


@pytest.mark.parametrize("path", MODULES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_a_module_imports_only_from_floors_below(path):
    package = path.relative_to(ROOT / "vcage").with_suffix("").parts[0]
    if package != "__init__":
        assert breaches(path.read_text(encoding="utf-8"), package) == []


@pytest.mark.parametrize(
    "line",
    ["from vcage.sim.world import World", "from vcage import igsc", "import vcage.cli.main", "import tests.runs"],
)
def test_an_import_from_the_same_floor_or_above_is_found(line):
    assert breaches(f"def f():\n    {line}\n", "assets")
