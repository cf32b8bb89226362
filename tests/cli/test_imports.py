"""The modules of the command line import each other in one direction."""

from __future__ import annotations

import ast
import graphlib
from pathlib import Path

import vcage.cli

FOLDER = Path(vcage.cli.__file__).parent


def imported(path: Path) -> set[str]:
    """Names of the modules of the command line that a module imports, also late."""
    nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    froms = [node for node in nodes if isinstance(node, ast.ImportFrom) and node.module]
    names = [f"{node.module}.{alias.name}" for node in froms for alias in node.names]
    return {name.split(".")[2] for name in names if name.startswith("vcage.cli.")}


def test_no_module_imports_itself_by_a_detour():
    graph = {path.stem: imported(path) - {path.stem} for path in FOLDER.glob("*.py") if path.stem != "__init__"}
    list(graphlib.TopologicalSorter(graph).static_order())  # raises CycleError
