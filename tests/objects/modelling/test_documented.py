"""The helpers of object authors, as docs/assets.md lists them."""

from __future__ import annotations

import ast
import re
from pathlib import Path

ROOT = Path(__file__).parents[3]
MODULES = {path.stem: path for path in (ROOT / "vcage" / "objects" / "modelling").glob("[a-z]*.py")}


def public_names(path: Path) -> set[str]:
    """Public functions and classes that a module defines."""
    body = ast.parse(path.read_text(encoding="utf-8")).body
    names = {node.name for node in body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    return {name for name in names if not name.startswith("_")}


def test_the_page_lists_every_helper_and_no_other() -> None:
    page = (ROOT / "docs" / "assets.md").read_text(encoding="utf-8")
    section = page.partition("### Helpers")[2].partition("\n### ")[0]
    rows = re.findall(r"^\| `(\w+)` \| (.+) \|$", section, re.MULTILINE)
    listed = {module: set(re.findall(r"`(\w+)`", functions)) for module, functions in rows}
    assert listed == {name: public_names(path) for name, path in MODULES.items()}
