"""Choosing a Vulkan driver."""

from __future__ import annotations

import _ctypes
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from vcage.base.errors import NoRenderer
from vcage.setup import mesa, vulkan
from vcage.setup.vulkan import Driver, RenderProbe

GOOD = RenderProbe(True, 1.0, "llvmpipe", "")
BAD = RenderProbe(False, 1.0, "", "failed to find a rendering device")


@pytest.fixture
def machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A machine with an empty cache, no GPU, no system driver, and no driver named by the user."""
    monkeypatch.setenv("VCAGE_CACHE", str(tmp_path))
    # Set before it is deleted: then what ensure_driver() puts there is taken back, too.
    monkeypatch.setenv(vulkan.ICD_VARIABLE, "")
    monkeypatch.delenv(vulkan.ICD_VARIABLE)
    monkeypatch.setattr(vulkan, "ICD_FOLDERS", (str(tmp_path / "icd.d"),))
    monkeypatch.setattr(vulkan, "find_gpu", lambda: "")
    return tmp_path


def put_driver(machine: Path) -> Path:
    """A driver in the cache, as :func:`vulkan.install_driver` leaves it."""
    icd = machine / "vulkan" / "mesa" / mesa.ICD_NAME
    icd.parent.mkdir(parents=True, exist_ok=True)
    icd.touch()
    return icd


def probing(monkeypatch: pytest.MonkeyPatch, *results: RenderProbe) -> list[Path | None]:
    """Let probes answer ``results`` in turn; returns the list of what was probed."""
    tried: list[Path | None] = []
    answers = iter(results)

    def probe(icd: Path | None = None) -> RenderProbe:
        tried.append(icd)
        return next(answers)

    monkeypatch.setattr(vulkan, "probe", probe)
    return tried


def test_a_driver_named_by_the_user_is_used_unchanged(machine: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(vulkan.ICD_VARIABLE, "/somewhere/icd.json")
    assert vulkan.ensure_driver() == Driver("given", Path("/somewhere/icd.json"), "")


def test_nothing_installed_is_an_error_that_names_the_command(machine: Path) -> None:
    with pytest.raises(NoRenderer, match="none is installed") as caught:
        vulkan.ensure_driver()
    assert caught.value.command.endswith("vcage setup vulkan")


def test_the_cached_driver_is_handed_to_this_process_and_its_children(
    machine: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    icd = put_driver(machine)
    probing(monkeypatch, GOOD)
    assert vulkan.ensure_driver() == Driver("cache", icd, "llvmpipe")
    assert os.environ[vulkan.ICD_VARIABLE] == str(icd)
    assert vulkan.ensure_driver().kind == "cache"


def test_a_decision_is_taken_once(machine: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put_driver(machine)
    tried = probing(monkeypatch, GOOD)
    first = vulkan.ensure_driver()
    monkeypatch.delenv(vulkan.ICD_VARIABLE)
    assert vulkan.ensure_driver() == first
    assert len(tried) == 1


def test_a_system_driver_that_does_not_draw_yields_to_the_cached_one(
    machine: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (machine / "icd.d").mkdir()
    (machine / "icd.d" / "lvp_icd.json").touch()
    icd = put_driver(machine)
    tried = probing(monkeypatch, BAD, GOOD)
    assert vulkan.ensure_driver().kind == "cache"
    assert tried == [None, icd]


def test_a_gpu_comes_first_and_needs_no_manifest(machine: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put_driver(machine)
    monkeypatch.setattr(vulkan, "find_gpu", lambda: "GPU 0: a card")
    probing(monkeypatch, GOOD)
    assert vulkan.ensure_driver() == Driver("gpu", None, "llvmpipe")
    assert vulkan.ICD_VARIABLE not in os.environ


@pytest.mark.parametrize("change", ["new system driver", "damaged", "driver deleted"])
def test_a_decision_that_no_longer_holds_is_taken_again(
    machine: Path, monkeypatch: pytest.MonkeyPatch, change: str
) -> None:
    icd = put_driver(machine)
    tried = probing(monkeypatch, GOOD, GOOD)
    vulkan.ensure_driver()
    monkeypatch.delenv(vulkan.ICD_VARIABLE)
    if change == "new system driver":
        (machine / "icd.d").mkdir()
        (machine / "icd.d" / "radeon.json").touch()
        assert vulkan.ensure_driver().kind == "system"
    elif change == "damaged":
        (machine / "vulkan" / "driver.json").write_text("{")
        assert vulkan.ensure_driver().kind == "cache"
    else:
        icd.unlink()
        with pytest.raises(NoRenderer):
            vulkan.ensure_driver()
    assert len(tried) == (1 if change == "driver deleted" else 2)


def test_complaints_of_every_driver_are_reported(machine: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put_driver(machine)
    probing(monkeypatch, BAD)
    with pytest.raises(NoRenderer, match="cache: failed to find a rendering device"):
        vulkan.ensure_driver()


def test_libraries_in_the_cache_are_loaded_before_sapien(tmp_path: Path) -> None:
    """On a machine without X11, ``import sapien`` fails unless ``import vcage.sim`` has loaded libX11."""
    library = tmp_path / "vulkan" / "mesa" / "usr" / "lib" / "x86_64-linux-gnu" / "libvcagetest.so.1"
    library.parent.mkdir(parents=True)
    shutil.copy(_ctypes.__file__, library)
    code = "import vcage.sim; print('libvcagetest' in open('/proc/self/maps').read())"
    environment = os.environ | {"VCAGE_CACHE": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout == "True\n"


def test_a_crashing_driver_is_reported_not_fatal(monkeypatch: pytest.MonkeyPatch) -> None:
    crashed = subprocess.CompletedProcess([], -6, stdout="", stderr="")
    monkeypatch.setattr(vulkan.subprocess, "run", lambda *args, **kwargs: crashed)
    result = vulkan.probe(Path("icd.json"))
    assert not result.ok
    assert result.message == "the process ended with -6"


def test_a_driver_that_hangs_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    def hang(*args: object, **kwargs: object) -> None:
        raise subprocess.TimeoutExpired("probe", vulkan.PROBE_TIMEOUT)

    monkeypatch.setattr(vulkan.subprocess, "run", hang)
    assert "no picture within" in vulkan.probe().message


def test_a_blank_picture_does_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    blank = subprocess.CompletedProcess([], 0, stdout='{"device": "x", "blank": true}\n', stderr="")
    monkeypatch.setattr(vulkan.subprocess, "run", lambda *args, **kwargs: blank)
    result = vulkan.probe()
    assert (result.ok, result.message) == (False, "the picture is blank")


@pytest.mark.slow
def test_the_driver_of_this_machine_draws() -> None:
    driver = vulkan.ensure_driver()
    result = vulkan.probe(driver.icd)
    assert result.ok, result.message
    assert result.device


@pytest.mark.slow
def test_a_manifest_of_nothing_does_not_draw(tmp_path: Path) -> None:
    icd = tmp_path / "icd.json"
    icd.write_text('{"ICD": {"library_path": "/nowhere.so", "api_version": "1.3"}, "file_format_version": "1.0.0"}')
    result = vulkan.probe(icd)
    assert not result.ok
    assert result.message
