"""The packages of docs/architecture.md: a module imports only from its own package and from those before it."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TABLE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
RULES = "vcage.models.rules"
PACKAGES = re.findall(r"^\| `vcage\.(\w+)` \|", TABLE, re.MULTILINE)


def imported(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """(line, dotted name) of every import, those inside functions too."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from ((node.lineno, f"{node.module}.{alias.name}") for alias in node.names)


def breaches(source: str, package: str) -> list[str]:
    """Imports of a module of ``package`` that lead to a package after it, or out of the library."""
    found = []
    for line, name in imported(ast.parse(source)):
        top, _, rest = name.partition(".")
        other = rest.split(".")[0]
        outside = top in ("tests", "benchmarks", "skills")
        upwards = top == "vcage" and other not in PACKAGES[: PACKAGES.index(package) + 1]
        if outside or upwards:
            found.append(f"line {line}: {name}")
    return found


def test_the_table_names_every_package_and_no_other():
    assert sorted(PACKAGES) == sorted(path.parent.name for path in (ROOT / "vcage").glob("*/__init__.py"))


def test_the_library_itself_holds_nothing_but_its_face():
    assert [path.name for path in (ROOT / "vcage").glob("*.py")] == ["__init__.py"]


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_imports_only_from_packages_before_it(package):
    modules = sorted((ROOT / "vcage" / package).rglob("*.py"))
    found = {str(m.relative_to(ROOT)): breaches(m.read_text(encoding="utf-8"), package) for m in modules}
    assert {name: lines for name, lines in found.items() if lines} == {}


def rules_imported(source: str) -> list[str]:
    """Imports from the rules that answer without a model."""
    found = imported(ast.parse(source))
    return [f"line {line}: {name}" for line, name in found if f"{name}.".startswith(f"{RULES}.")]


def test_only_the_registry_imports_the_rules():
    modules = sorted(set((ROOT / "vcage").rglob("*.py")) - set((ROOT / "vcage/models/rules").rglob("*.py")))
    found = {str(m.relative_to(ROOT)): rules_imported(m.read_text(encoding="utf-8")) for m in modules}
    assert [name for name, lines in found.items() if lines] == ["vcage/models/registry.py"]


def test_the_registry_imports_nothing_of_the_rules_but_roles():
    lines = rules_imported((ROOT / "vcage/models/registry.py").read_text(encoding="utf-8"))
    assert {line.rpartition(".")[2] for line in lines} == {"OfflineReasoner", "OfflineEditor", "OfflineCritic"}


@pytest.mark.parametrize("line", ["from vcage.models import rules", "import vcage.models.rules.goals"])
def test_an_import_of_the_rules_is_found(line):
    assert rules_imported(f"def f():\n    {line}\n")


@pytest.mark.parametrize(
    "line",
    [
        "from vcage.sim.world import World",
        "from vcage import layout",
        "from vcage import __version__",
        "import vcage",
        "import vcage.cli.main",
        "import tests.run_folders",
    ],
)
def test_an_import_from_a_later_package_is_found(line):
    assert breaches(f"def f():\n    {line}\n", "objects")
