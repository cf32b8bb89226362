"""``vcage assets list``, ``validate`` and ``gallery``: one JSON line that programs read."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from vcage.apps.proof.mesh import MeshLimits
from vcage.cli.main import main


def run(capsys: pytest.CaptureFixture[str], *arguments: object) -> tuple[int, list[str], dict]:
    """Exit code, lines of stdout, and the last of them read as JSON."""
    code = main([str(a) for a in arguments])
    lines = capsys.readouterr().out.strip().splitlines()
    return code, lines, json.loads(lines[-1])


def test_the_list_as_json_is_one_line_of_counts(capsys) -> None:
    code, lines, record = run(capsys, "assets", "list", "--json")
    assert code == 0 and len(lines) == 1
    least = {"kitchen": 30, "bathroom": 18, "office_desk": 24, "cashier_desk": 18, "cabinet": 12}
    assert record["kinds"] >= 90 and sum(record["sources"].values()) == record["kinds"]
    assert all(record["scenes"][scene] >= count for scene, count in least.items())
    assert record["sources"]["parametric"] >= 45


def test_a_scene_can_be_listed_alone(capsys) -> None:
    _, lines, record = run(capsys, "assets", "list", "--scene", "bathroom")
    assert len(lines) == record["kinds"] + 1 == record["scenes"]["bathroom"] + 1


def test_an_unknown_scene_error_lists_the_known_ones(capsys) -> None:
    code, _, record = run(capsys, "assets", "list", "--scene", "garage")
    assert code == 2 and "bathroom" in record["error"]["message"]


@pytest.mark.slow
def test_the_validation_ends_with_its_counts(capsys, tmp_path: Path) -> None:
    code, _, record = run(
        capsys, "assets", "validate", "soap_bar", "--quick", "--no-page", "--workers", 1, "--out", tmp_path
    )
    assert code == 0
    keys = ["objects", "variants", "contact_points", "functional_points", "joints", "tries", "failed"]
    assert list(record)[:7] == keys
    assert record["objects"] == 1 and record["failed"] == [] and (tmp_path / "proof.json").is_file()


@pytest.mark.slow
def test_a_failed_validation_names_the_problem_and_exits_with_3(capsys, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr("vcage.apps.proof.mesh.LIMITS", MeshLimits(max_faces=10))
    code, _, record = run(
        capsys, "assets", "validate", "soap_bar", "--quick", "--no-page", "--workers", 1, "--out", tmp_path
    )
    assert code == 3 and record["error"]["code"] == "assets_unproven"
    assert any("soap_bar" in failure and "mesh" in failure for failure in record["failed"])


def test_an_unknown_object_is_refused_with_a_suggestion(capsys, tmp_path: Path) -> None:
    code, _, record = run(capsys, "assets", "validate", "soap_ba", "--out", tmp_path)
    assert code == 2 and "soap_bar" in record["error"]["hint"]


def test_the_gallery_draws_the_named_objects(capsys, tmp_path: Path) -> None:
    code, _, record = run(capsys, "assets", "gallery", "soap_bar", "--out", tmp_path)
    assert code == 0 and record["summary"]["kinds"] == 1
    assert (tmp_path / "index.html").is_file()


def test_the_help_of_the_group_lists_its_actions(capsys) -> None:
    assert main(["assets", "--help"]) == 0
    text = capsys.readouterr().out
    assert all(f"assets {action}" in text for action in ("list", "gallery", "validate"))
