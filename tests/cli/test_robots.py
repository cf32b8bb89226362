"""``vcage robots import`` and ``vcage robots list``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tests.sim.robotwin.embodiment import config, write
from vcage.cli.main import main


@pytest.fixture(autouse=True)
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("VCAGE_DATA", str(tmp_path / "data"))
    return tmp_path / "data"


def run(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, dict[str, Any], str]:
    """Exit code, the last line as a record, and the lines before it."""
    code = main([str(x) for x in arguments])
    *lines, last = capsys.readouterr().out.splitlines()
    return code, json.loads(last), "\n".join(lines)


def test_a_robot_is_imported_and_listed(tmp_path, data, capsys):
    folder = write(tmp_path / "box-arm", config())
    code, record, text = run(capsys, "robots", "import", "robotwin", folder, "--distance", "0.7")
    assert (code, record["summary"]["robot"]) == (0, "box-arm")
    assert record["summary"]["warnings"] == text.count("warning: ") > 0
    assert record["output"] == str(data / "robots" / "box-arm.yml")
    code, record, text = run(capsys, "robots", "list")
    assert (code, record["summary"]["robots"]) == (0, ["box-arm", "dual_panda"])
    assert "box-arm: left, right." in text


@pytest.mark.parametrize("distance", ["0", "-1", "far", "nan"])
def test_a_distance_must_be_metres_above_0(tmp_path, capsys, distance):
    code, record, _ = run(capsys, "robots", "import", "robotwin", tmp_path, f"--distance={distance}")
    assert (code, record["error"]["code"]) == (2, "usage")
