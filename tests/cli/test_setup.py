"""What ``vcage setup`` does and leaves alone."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import pytest

from vcage.cli import setup
from vcage.cli.main import main
from vcage.errors import NoRenderer
from vcage.sim import vulkan
from vcage.sim.vulkan import Driver

DRIVER = Driver("cache", Path("/cache/lvp_icd.json"), "llvmpipe")


def summary(capsys: pytest.CaptureFixture[str]) -> Any:
    return json.loads(capsys.readouterr().out.splitlines()[-1])["summary"]


def test_a_driver_that_draws_is_not_fetched_again(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(vulkan, "ensure_driver", lambda: DRIVER)
    monkeypatch.setattr(vulkan, "install_driver", lambda: pytest.fail("fetched"))
    assert main(["setup", "vulkan"]) == 0
    assert summary(capsys)["vulkan"] == {"kind": "cache", "name": "llvmpipe", "icd": "/cache/lvp_icd.json"}


def test_where_no_driver_draws_one_is_fetched(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def none() -> Driver:
        raise NoRenderer("nothing draws")

    monkeypatch.setattr(vulkan, "ensure_driver", none)
    monkeypatch.setattr(vulkan, "install_driver", lambda: DRIVER)
    assert main(["setup", "vulkan"]) == 0
    assert summary(capsys)["vulkan"]["kind"] == "cache"


def test_a_package_of_the_right_version_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(setup, "cvvdp_version", lambda: setup.CVVDP)
    monkeypatch.setattr(setup, "_pip", lambda *arguments: pytest.fail("installed"))
    assert main(["setup", "cvvdp"]) == 0


def test_cvvdp_is_installed_without_what_would_replace_torch(monkeypatch: pytest.MonkeyPatch) -> None:
    commands: list[list[str]] = []

    def run(command: list[str], **options: Any) -> subprocess.CompletedProcess[str]:
        commands.append(command)
        return subprocess.CompletedProcess(command, 0)

    monkeypatch.setattr(setup, "cvvdp_version", lambda: "")
    monkeypatch.setattr(setup.subprocess, "run", run)
    assert main(["setup", "cvvdp"]) == 0
    assert commands[0][-2:] == ["--no-deps", f"cvvdp=={setup.CVVDP}"]


def test_a_failing_pip_is_an_error_of_configuration(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(setup, "cvvdp_version", lambda: "")
    monkeypatch.setattr(setup.subprocess, "run", lambda *a, **k: subprocess.CompletedProcess(a, 1))
    assert main(["setup", "cvvdp"]) == 4
    assert "vcage setup cvvdp" in capsys.readouterr().err
