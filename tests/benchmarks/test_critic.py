"""How the critic benchmark makes outcomes, and counts."""

from __future__ import annotations

import ast
import json
import re
from pathlib import Path

import numpy as np
import pytest

from benchmarks import critic
from benchmarks._critic import making
from benchmarks._critic.kinds import FAILURES
from benchmarks._critic.making import outcomes
from benchmarks._critic.outcome import (
    SUCCESS,
    Outcome,
    OutcomeQuestion,
    OutcomeRecord,
    OutcomeTruth,
    OutcomeTruths,
    neutral_id,
    read_outcomes,
    write_list,
)
from benchmarks._critic.scenes import SCENES, UNTOUCHED_SCENES, Draw, part_of, settings
from benchmarks._sentences.sources import by_template, sentences, slug
from benchmarks.critic import Judged, figures, make
from tests.run_folders import REPOSITORY
from vcage.base.errors import InputFileError, UsageError
from vcage.objects.library import Library
from vcage.schema.goals import Goal
from vcage.schema.subtasks import TemplateName

CRITIC = re.compile(r"rules(\.| import )(critic|change|evidence|standing|verdicts)|question import .*\bverdict\b")
"""Imports of a test that shows pictures to the offline critic."""

GOAL = Goal(subject="cup", relation="inside", reference="tray")


def judged(
    success: bool, accepted: bool, kind: str = "success", part: str = "tuning", confidence: float = 0.9
) -> Judged:
    record = OutcomeRecord(
        id="1", name="x", scene="s.json",
        setting="kitchen", part=part, template="place", text="Put it there.", goals=[GOAL],
        asset="cup", success=success, reason="because", kind=kind, pictures={}, empty="e.png",
    )  # fmt: skip
    return Judged(record, accepted, confidence, "seen", 1.0)


def test_precision_is_over_accepted_and_recall_over_successful_episodes() -> None:
    told = (
        [judged(True, True)] * 8 + [judged(True, False)] * 2 + [judged(False, True, "beside")] + [judged(False, False)]
    )
    row = next(row for row in figures(told)["rows"] if row["part"] == "all")
    assert (row["n"], row["successes"]) == (12, 10)
    assert row["precision"] == round(8 / 9, 4) and row["recall"] == 0.8
    assert row["precision_low"] < row["precision"] and row["recall_low"] < row["recall"]


def test_parts_are_counted_apart_and_wrong_verdicts_by_kind() -> None:
    told = [judged(False, True, "beside", "untouched"), judged(True, True)]
    found = figures(told)
    rows = {row["part"]: row["n"] for row in found["rows"]}
    assert rows == {"tuning": 1, "untouched": 1, "all": 2}
    assert found["by_failure"]["beside"] == {"n": 1, "successes": 0, "failures": 1, "false_yes": 1, "false_no": 0}


def test_a_stated_confidence_is_compared_with_how_often_it_is_right() -> None:
    told = [
        judged(True, True, confidence=0.95),
        judged(True, False, confidence=0.95),
        judged(True, True, confidence=0.6),
    ]
    assert figures(told)["by_confidence"] == {"0.5-0.7": {"n": 1, "right": 1.0}, "0.9-1": {"n": 2, "right": 0.5}}


def test_two_scenes_and_about_half_of_the_other_kinds_are_untouched() -> None:
    assert all(part_of(scene, "candle") == "untouched" for scene in UNTOUCHED_SCENES)
    kinds = [f"kind_{n}" for n in range(200)]
    assert 70 < sum(part_of("kitchen", kind) == "untouched" for kind in kinds) < 130
    assert set(UNTOUCHED_SCENES) < set(SCENES)


def test_no_kind_that_a_unit_test_shows_the_offline_critic_is_untouched() -> None:
    library = Library.load()
    kinds = {*library.names, *library.left_out}
    shown = {text for path in _tests_of_the_critic() for text in _strings(path)} & kinds
    assert len(shown) > 10
    assert {kind for kind in shown for scene in SCENES if part_of(scene, kind) == "untouched"} == set()


def _tests_of_the_critic() -> set[Path]:
    """The unit tests of the offline critic, and the modules of tests that these import."""
    found: set[Path] = set()
    left = [path for path in (REPOSITORY / "tests").rglob("test_*.py") if CRITIC.search(path.read_text())]
    while left:
        path = left.pop()
        found.add(path)
        imported = re.findall(r"^from (tests\.[\w.]+) import", path.read_text(), re.MULTILINE)
        left += {REPOSITORY / f"{name.replace('.', '/')}.py" for name in imported} - found
    return found


def _strings(path: Path) -> set[str]:
    nodes = ast.walk(ast.parse(path.read_text()))
    return {node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)}


def test_the_critic_is_counted_by_template() -> None:
    found = figures([judged(True, True), judged(True, False), judged(False, False, "beside")])
    assert found["by_template"] == {"place": {"n": 3, "successes": 2, "failures": 1, "false_yes": 0, "false_no": 1}}


def test_scenes_cover_every_sentence_and_quick_takes_one_per_template() -> None:
    names = {slug(sentence.text) for sentence in sentences()}
    assert names <= set(settings()) and set(SCENES) <= set(settings())
    full = critic.drawn(7, "dual_panda", "all", quick=False)
    assert {draw.scene for draw in full} == set(settings())
    assert len({(draw.scene, draw.seed) for draw in full}) == len(full)
    quick = {draw.scene for draw in critic.drawn(7, "dual_panda", "all", quick=True)}
    assert quick == {*SCENES, *(slug(text) for text in by_template().values())}


def test_a_folder_without_a_list_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match=r"outcomes\.json"):
        next(read_outcomes(tmp_path))


def test_the_truth_is_in_a_file_of_its_own(tmp_path: Path) -> None:
    record = judged(False, True, kind="beside").record.model_copy(update={"reason": "it lies beside the tray"})
    write_list([record], tmp_path)
    asked, truth = ((tmp_path / name).read_text() for name in ("outcomes.json", "truth.json"))
    assert json.loads(truth)["truths"]["1"]["reason"] == "it lies beside the tray"
    assert set(json.loads(asked)["outcomes"][0]) == set(OutcomeQuestion.model_fields)
    assert not {*OutcomeTruth.model_fields} & {*OutcomeQuestion.model_fields}


def test_a_folder_without_its_truth_file_names_it(tmp_path: Path) -> None:
    write_list([judged(True, True).record], tmp_path)
    (tmp_path / "truth.json").write_text(OutcomeTruths(truths={}).model_dump_json(by_alias=True))
    with pytest.raises(InputFileError, match=r"truth\.json says nothing of 1"):
        next(read_outcomes(tmp_path))
    (tmp_path / "truth.json").unlink()
    with pytest.raises(InputFileError, match=r"truth\.json does not exist"):
        next(read_outcomes(tmp_path))


def test_a_number_names_an_outcome_and_follows_from_seed_and_name() -> None:
    numbers = {neutral_id(f"kitchen-000-{n:02d}-{kind}", seed) for n in range(9) for kind in "ab" for seed in (0, 1)}
    assert len(numbers) == 36 and all(len(n) == 12 and n.isdigit() for n in numbers)
    assert neutral_id("kitchen-000-00-a", 0) in numbers


@pytest.mark.parametrize(
    ("scene", "template", "laid_out"),
    [
        ("office_desk", "insert", False),
        ("office_desk", "place", True),
        ("insert-the-peg-into-the-peg-block", "insert", True),
        ("put-the-egg-in-the-pot", "hand_over", True),
    ],
)
def test_a_scene_is_laid_out_if_the_named_template_has_a_sub_task_in_it(
    scene: str, template: TemplateName, laid_out: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    def lay_out(*_: object) -> None:
        raise UsageError("it is laid out", hint="")

    monkeypatch.setattr(making, "lay_out_placed", lay_out)
    noted: list[str] = []
    monkeypatch.setattr(making.logger, "warning", lambda text, *given: noted.append(text % given))
    assert outcomes(Draw(scene, 0, "dual_panda", 2, templates=(template,))) == []
    assert any("it is laid out" in line for line in noted) == laid_out


@pytest.mark.slow
def test_outcomes_are_made_physically_and_read_as_they_were_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: dict[str, Outcome] = {}

    def noted(draw: Draw) -> list[Outcome]:
        found = outcomes(draw)
        made.update({outcome.record.id: outcome for outcome in found})
        return found

    monkeypatch.setattr(critic, "outcomes", noted)
    make([Draw("cabinet", 100, "dual_panda", 2, part="tuning")], tmp_path, workers=1)
    assert {o.record.success for o in made.values()} == {True, False}
    failed = [o.record for o in made.values() if not o.record.success]
    assert all(record.kind in (*FAILURES, "gave up", "as it came") and record.reason for record in failed)
    written = list(read_outcomes(tmp_path))
    assert len(written) == len(made)
    for outcome in written:
        again = made[outcome.record.id]
        assert outcome.record == again.record
        assert all(np.array_equal(p, again.seen[w][c]) for w, by in outcome.seen.items() for c, p in by.items())
    assert json.loads((tmp_path / "outcomes.json").read_text())["schema"] == "vcage.benchmarks.outcomes/2"
    assert "It is for counting alone" in " ".join((tmp_path / "README.md").read_text().split())
    names = " ".join(str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*"))
    words = {SUCCESS, "cabinet", *(word for o in made.values() for word in o.record.kind.split() if len(word) > 3)}
    assert not [word for word in words if word in names], "names tell nothing"
