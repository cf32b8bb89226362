"""``vcage robots import`` and ``vcage robots list``."""

from __future__ import annotations

import pytest

from tests.cli.command import run
from tests.sim.robotwin.embodiment import config, write

pytestmark = pytest.mark.usefixtures("data")


def test_a_robot_is_imported_and_listed(tmp_path, data, capsys):
    folder = write(tmp_path / "box-arm", config())
    code, record, text = run(capsys, "robots", "import", "robotwin", folder, "--distance", "0.7")
    assert (code, record["summary"]["robot"]) == (0, "box-arm")
    assert record["summary"]["warnings"] == text.count("warning: ") > 0
    assert record["output"] == str(data / "robots" / "box-arm.yml")
    code, record, text = run(capsys, "robots", "list")
    assert (code, record["summary"]["robots"]) == (0, ["aloha_agilex", "box-arm", "dual_panda"])
    assert "box-arm: left, right." in text and "aloha_agilex (default): left, right." in text


@pytest.mark.parametrize("distance", ["0", "-1", "far", "nan"])
def test_a_distance_must_be_metres_above_0(tmp_path, capsys, distance):
    code, record, _ = run(capsys, "robots", "import", "robotwin", tmp_path, f"--distance={distance}")
    assert (code, record["error"]["code"]) == (2, "usage")
