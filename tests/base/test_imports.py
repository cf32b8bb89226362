"""Leaving out what an import drags along."""

from __future__ import annotations

import importlib
import json
import subprocess
import sys

import pytest

from vcage.base.imports import left_out

PLOTTER = "import slow_package.plots as plots\n"


@pytest.fixture
def packages(tmp_path, monkeypatch):
    """A package that is slow to import, and a module that imports it."""
    (tmp_path / "slow_package").mkdir()
    (tmp_path / "slow_package" / "__init__.py").write_text("loaded = True\n")
    (tmp_path / "slow_package" / "plots.py").write_text("loaded = True\n")
    (tmp_path / "plotter.py").write_text(PLOTTER)
    monkeypatch.syspath_prepend(tmp_path)
    yield
    for name in ("slow_package", "slow_package.plots", "plotter"):
        sys.modules.pop(name, None)


@pytest.mark.usefixtures("packages")
def test_excluded_modules_are_not_loaded():
    with left_out("slow_package", "plots"):
        plotter = importlib.import_module("plotter")
    assert not hasattr(plotter.plots, "loaded")


@pytest.mark.usefixtures("packages")
def test_afterwards_it_can_be_imported():
    with left_out("slow_package", "plots"):
        importlib.import_module("plotter")
    assert importlib.import_module("slow_package.plots").loaded


@pytest.mark.usefixtures("packages")
def test_loaded_modules_are_found_first():
    importlib.import_module("slow_package.plots")
    with left_out("slow_package", "plots"):
        plotter = importlib.import_module("plotter")
    assert plotter.plots.loaded


def test_planning_a_motion_loads_no_plotting():
    code = "import json, sys, vcage.sim.speed_profile; print(json.dumps(sorted(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = json.loads(done.stdout)
    assert "toppra.algorithm" in loaded
    assert not [name for name in loaded if name.startswith("matplotlib")]
