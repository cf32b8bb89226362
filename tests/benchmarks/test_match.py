"""``python -m benchmarks match`` on painted pictures: its rows, its options, its refusals, and the greedy baseline."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks import match
from benchmarks.__main__ import main
from benchmarks._match.cases import write_case
from benchmarks._match.greedy import match_greedily
from benchmarks._match.stacks import build
from tests.benchmarks.painted import MOVED, painted_case
from vcage.base.errors import UnknownName, UsageError
from vcage.base.geometry import wrap_angle
from vcage.models.registry import build_detector, build_embedder


@pytest.fixture
def pictures(tmp_path: Path) -> Path:
    write_case(tmp_path, painted_case())
    return tmp_path


def test_the_baseline_finds_painted_bars_where_they_are() -> None:
    matches = match_greedily(painted_case(), build_detector("background"), build_embedder("classical"))
    for found in matches:
        place, yaw = MOVED[found.object]
        assert found.method == "feature"
        np.testing.assert_allclose(found.position, place, atol=0.006)
        assert abs(float(wrap_angle(found.yaw - yaw))) < np.radians(8)


def test_the_baseline_keeps_objects_that_an_empty_table_does_not_show() -> None:
    case = painted_case()
    empty = type(case)(**{**vars(case), "target": case.background})
    matches = match_greedily(empty, build_detector("background"), build_embedder("classical"))
    assert {found.method for found in matches} == {"kept"}


def test_every_level_has_a_row_of_each_stack_and_of_the_baseline(pictures: Path) -> None:
    rows = match.run(False, pictures=pictures)["rows"]
    assert [(row["level"], row["stack"]) for row in rows] == [
        ("painted", "background+classical"),
        ("painted", "greedy-baseline"),
    ]
    assert all(row["pictures"] == 1 and row["recall"] == 1 for row in rows)


def test_the_last_line_is_json(pictures: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["match", "--quick", "--pictures", str(pictures)]) == 0
    assert json.loads(capsys.readouterr().out.splitlines()[-1])["rows"]


def test_the_log_ends_with_the_rows_as_a_table(pictures: Path, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    assert main(["match", "--pictures", str(pictures)]) == 0
    heading, ours, baseline = (line.split() for line in caplog.messages[-3:])
    assert heading[:3] == ["level", "stack", "pictures"]
    assert (ours[:3], baseline[:3]) == (["painted", "background+classical", "1"], ["painted", "greedy-baseline", "1"])


def test_a_damaged_case_ends_the_run_with_its_name(pictures: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (pictures / "painted" / "000" / "target.png").unlink()
    assert main(["match", "--pictures", str(pictures)]) == 3
    printed = capsys.readouterr()
    assert "painted/000" in printed.err
    assert json.loads(printed.out.splitlines()[-1])["error"]["code"] == "bad_input_file"


def test_keeping_pictures_that_were_not_made_is_refused(pictures: Path) -> None:
    with pytest.raises(UsageError, match="--keep"):
        match.run(True, pictures=pictures, keep=pictures)


def test_an_unknown_detector_error_lists_the_known_ones() -> None:
    with pytest.raises(UnknownName, match="background, grounding-dino"):
        build("backgroud+classical")


def test_a_stack_needs_an_embedder() -> None:
    with pytest.raises(UsageError, match="background"):
        build("background")


def test_a_benchmark_without_options_of_its_own_refuses_them(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["select", "--pictures", "x"])
    assert "unrecognized arguments" in capsys.readouterr().err
