"""Imports of the objects' own code: each decides the result, so each is in the hash of a model."""

from __future__ import annotations

import ast
from pathlib import Path

from vcage.base.files import resource

ALLOWED = ("assets.shapes", "assets.textures", "vcage.objects.modelling", "vcage.schema.asset")


def _project_imports(path: Path) -> list[str]:
    modules = [node.module or "" for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.ImportFrom)]
    modules += [
        a.name for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Import) for a in node.names
    ]
    return [module for module in modules if module.split(".")[0] in ("assets", "vcage", "tests", "benchmarks")]


def test_models_and_shapes_import_only_shapes_and_modelling_helpers() -> None:
    wrong = {
        str(path.relative_to(resource("assets"))): module
        for path in sorted(resource("assets").rglob("*.py"))
        for module in _project_imports(path)
        if not module.startswith(ALLOWED)
    }
    assert wrong == {}
