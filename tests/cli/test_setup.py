"""What ``vcage setup`` does and leaves alone."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import pytest

from vcage.base.errors import FetchFailed, NoRenderer, VcageError
from vcage.cli import setup
from vcage.cli.main import main
from vcage.setup import vulkan
from vcage.setup.vulkan import Driver

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


def test_cvvdp_is_installed_without_replacing_torch(monkeypatch: pytest.MonkeyPatch) -> None:
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


# --- packages of models ------------------------------------------------------------------------------------


class FakePackage:
    """A package whose fetching is counted."""

    origin, version, megabytes = "somewhere", "1", 2

    def __init__(self, name: str, here: bool, error: VcageError | None = None):
        self.name, self.here, self.error = name, here, error
        self.asked: list[list[str]] = []

    def holds(self, model: str) -> bool:
        return self.here

    def fetch(self, models: list[str]) -> None:
        self.asked.append(models)
        if self.error is not None:
            raise self.error
        self.here = True


@pytest.fixture
def fake_packages(monkeypatch: pytest.MonkeyPatch) -> dict[str, FakePackage]:
    """Two packages, one of them already fetched, and a library with nothing to build."""
    from vcage.objects import library, packages

    fakes = {"one": FakePackage("one", here=True), "two": FakePackage("two", here=False)}
    monkeypatch.delenv(setup.NO_PACKAGES, raising=False)
    monkeypatch.setattr(packages, "package_of", lambda name: fakes[name])
    monkeypatch.setattr(library, "package_models", lambda: {"one": ["a"], "two": ["b", "c"]})
    monkeypatch.setattr(library.Library, "load", classmethod(lambda cls: cls({}, {})))
    return fakes


def test_only_missing_packages_are_fetched(
    fake_packages: dict[str, FakePackage], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["setup", "assets"]) == 0
    assert fake_packages["one"].asked == [] and fake_packages["two"].asked == [["b", "c"]]
    assert summary(capsys)["assets"]["packages"] == {"one": "here", "two": "fetched"}


def test_a_package_that_cannot_be_had_is_a_warning(
    fake_packages: dict[str, FakePackage], capsys: pytest.CaptureFixture[str]
) -> None:
    fake_packages["two"].error = FetchFailed("apt-get: no answer", hint="check the mirror")
    assert main(["setup", "assets"]) == 0
    captured = capsys.readouterr()
    assert "the package two cannot be had: apt-get: no answer" in captured.err
    assert json.loads(captured.out.splitlines()[-1])["summary"]["assets"]["packages"]["two"].startswith("apt-get")


@pytest.mark.parametrize("way", ["option", "variable"])
def test_packages_are_left_alone_on_request(
    way: str, fake_packages: dict[str, FakePackage], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    if way == "variable":
        monkeypatch.setenv(setup.NO_PACKAGES, "1")
    assert main(["setup", "assets", *(["--no-packages"] if way == "option" else [])]) == 0
    assert fake_packages["two"].asked == []
    assert summary(capsys)["assets"]["packages"] == {}
