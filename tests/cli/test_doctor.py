"""What ``vcage doctor`` says."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from vcage.base.errors import NoRenderer
from vcage.cli import doctor
from vcage.cli.doctor import Finding
from vcage.cli.main import main
from vcage.setup import vulkan
from vcage.setup.vulkan import Driver, RenderProbe

FINE = Finding("Python", True, "3.11.2")
OPTIONAL = Finding("assets", False, "0 of 9", required=False, mend="vcage setup assets")
BROKEN = Finding("Vulkan", False, "none", mend="vcage setup vulkan")


def look(monkeypatch: pytest.MonkeyPatch, *findings: Finding) -> None:
    """Let the doctor find these."""
    found: list[Callable[[], Finding]] = [lambda finding=finding: finding for finding in findings]
    monkeypatch.setattr(doctor, "CHECKS", tuple(found))


def test_a_key_file_readable_by_others_is_reported_with_the_fix(monkeypatch, tmp_path: Path):
    path = tmp_path / "keys.json"
    path.write_text('{"openai": "very-secret"}')
    path.chmod(0o644)
    monkeypatch.setenv("VCAGE_KEY_FILE", str(path))
    finding = doctor.keys()
    assert not finding.ok and not finding.required
    assert f"other users may read {path}" in finding.found and finding.mend == f"chmod 600 {path}"
    path.chmod(0o600)
    assert doctor.keys().ok


def test_all_well_exits_with_0_and_lists_the_findings(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    look(monkeypatch, FINE, OPTIONAL)
    assert main(["doctor"]) == 0
    *table, record = capsys.readouterr().out.splitlines()
    assert table[0].split() == ["ok", "Python", "3.11.2"]
    assert table[2].split("→")[1].strip() == "vcage setup assets"
    assert [check["name"] for check in json.loads(record)["summary"]["checks"]] == ["Python", "assets"]


def test_a_missing_requirement_exits_with_4_and_names_the_command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    look(monkeypatch, FINE, BROKEN)
    assert main(["doctor"]) == 4
    out, err = capsys.readouterr()
    error = json.loads(out.splitlines()[-1])["error"]
    assert error["hint"] == "run: vcage setup vulkan"
    assert len(error["details"]["checks"]) == 2
    assert "MISSING Vulkan" in out
    assert "missing or unfit: Vulkan" in err


def test_json_leaves_only_the_last_line(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    look(monkeypatch, FINE)
    assert main(["doctor", "--json"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 1


def test_numpy_2_is_unfit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor.metadata, "version", lambda name: "2.1.0")
    finding = doctor.numpy()
    assert not finding.ok
    assert "numpy>=1.26,<2" in finding.mend


def test_a_missing_package_is_fixed_with_pip(monkeypatch: pytest.MonkeyPatch) -> None:
    def absent(name: str) -> str:
        raise doctor.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(doctor.metadata, "version", absent)
    for check in (doctor.sapien, doctor.mani_skill, doctor.torch, doctor.video, doctor.opencv):
        finding = check()
        assert not finding.ok and finding.required
        assert " -m pip install " in finding.mend


def test_cvvdp_of_another_version_is_replaced_by_setup(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "cvvdp_version", lambda: "0.1")
    assert doctor.cvvdp().mend.endswith("vcage setup cvvdp")


def test_no_driver_and_a_driver_that_cannot_render_are_told_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    def none() -> Driver:
        raise NoRenderer("nothing draws", hint="x")

    monkeypatch.setattr(vulkan, "ensure_driver", none)
    assert doctor.vulkan().found == "nothing draws"
    monkeypatch.setattr(vulkan, "ensure_driver", lambda: Driver("system", None, ""))
    monkeypatch.setattr(vulkan, "probe", lambda: RenderProbe(False, 1.0, "", "blank"))
    finding = doctor.vulkan()
    assert "blank" in finding.found
    assert finding.mend.endswith("vcage setup vulkan --force")


def test_keys_are_shown_by_name_only(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VCAGE_GEMINI_API_KEY", "the-secret-itself")
    finding = doctor.keys()
    assert "VCAGE_GEMINI_API_KEY" in finding.found
    assert "the-secret-itself" not in str(finding)


def test_an_empty_cache_of_assets_is_no_failure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("VCAGE_CACHE", str(tmp_path / "none" / "yet"))
    finding = doctor.assets()
    assert not finding.ok and not finding.required
    assert finding.found.startswith("0 of ")
    assert doctor.disk().found.endswith("free in the cache")
    assert not (tmp_path / "none").exists()
