"""The public face: ``import vcage`` is quick, its names are documented, and README's code for Python runs."""

from __future__ import annotations

import ast
import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest

import vcage
from tests.run_folders import REPOSITORY, Finished, copied


def test_importing_it_imports_nothing_else() -> None:
    code = "import sys; before = set(sys.modules); import vcage; print(sorted(set(sys.modules) - before))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = [name for name in ast.literal_eval(done.stdout) if name.split(".")[0] not in sys.stdlib_module_names]
    assert loaded == ["vcage", "vcage.base", "vcage.base.version"]


def test_every_name_is_explained_with_an_example() -> None:
    texts = {name: inspect.getdoc(getattr(vcage, name)) or "" for name in vcage.__all__}
    assert [name for name, text in texts.items() if "\nExample:\n    >>> " not in text] == []


def test_the_names_for_type_checkers_match_the_program() -> None:
    tree = ast.parse(inspect.getsource(vcage))
    imports = {
        alias.name: node.module
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and str(node.module).startswith("vcage.")
        for alias in node.names
    }
    assert imports.pop("__version__") == "vcage.base.version"
    assert imports == vcage._PLACES
    assert sorted(imports) == sorted(vcage.__all__)
    assert set(vcage.__all__) <= set(dir(vcage))


def test_the_code_of_the_readme_runs(
    finished: Finished, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    copied(finished.run, tmp_path / "runs" / "blocks")
    monkeypatch.chdir(tmp_path)
    code, *_ = re.findall(r"^```python\n(.*?)^```", (REPOSITORY / "README.md").read_text(), re.DOTALL | re.MULTILINE)
    exec(compile(code, "README.md", "exec"), {})
    fresh = ast.literal_eval(capsys.readouterr().out.splitlines()[0])
    assert not any(fresh.values()) and list(fresh)[-1] == "export"
