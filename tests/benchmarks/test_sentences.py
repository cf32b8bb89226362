"""Which sentences are run whole, and how what came of them is counted."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from benchmarks import sentences as benchmark
from benchmarks._sentences import whole
from benchmarks._sentences.sources import (
    PAGES,
    REPOSITORY,
    Sentence,
    by_template,
    examples,
    of_libero,
    of_pages,
    sentences,
    slug,
)
from benchmarks._sentences.whole import Ran, Tried, Whole, ran
from benchmarks.sentences import chosen, figures, told
from vcage.base.errors import InputFileError, UsageError
from vcage.stages.chain import STAGES
from vcage.tasks.templates import TEMPLATES

VERBS = (
    "put", "pack", "open", "turn", "stack", "weigh", "hand", "push", "shake", "lift", "hit", "wipe", "pour", "hang",
    "insert", "stand",
)  # fmt: skip


@pytest.mark.parametrize(
    "line",
    [
        'vcage run "Put it there" --out runs/a',
        'vcage run --seed 4 --models=offline "Put it there"',
        'vcage select-place "Put it there" --force',
        'python3 {baseDir}/scripts/run.py "Put it there" --episodes 3',
        'python3 skills/vcage-igsc/scripts/select_place.py \\\n  --out runs/a \\\n  "Put it there"',
        'vcage.ChainOptions(instruction="Put it there", episodes=1)',
    ],
)
def test_the_instruction_of_a_command_or_a_call_is_found(line: str) -> None:
    assert list(examples(line)) == ["Put it there"]


@pytest.mark.parametrize(
    "line",
    [
        'a robot of RoboTwin: vcage run "…" --robot NAME',
        'vcage compress DATA --to lerobot-v3.0 --task "open the jar" --out jar',
        "vcage run --scene office_desk --all-subtasks --out runs/office",
        'vcage run --scene office_desk --out "runs/my office"',
        'vcage run --goal "lemon on table" --start "lemon inside bowl" --out runs/told',
        'vcage assets search "something to drink from"',
        'the words "put it there" mean nothing',
        '{"ok": false, "error": {"code"}}',
    ],
)
def test_nothing_else_in_quotes_is_a_sentence(line: str) -> None:
    assert not list(examples(line))


def test_every_command_in_quotes_on_our_pages_is_found_and_nothing_else() -> None:
    pages = [path.read_text(encoding="utf-8") for pattern in PAGES for path in REPOSITORY.glob(pattern)]
    quoted = {text for page in pages for text in re.findall(r'"([A-Z][a-z]+ [^"\n{]+)"', page)}
    commands = {text for text in quoted if text.split()[0].lower() in VERBS}
    assert {sentence.text for sentence in of_pages(REPOSITORY)} == commands


def test_a_sentence_of_several_pages_is_run_once_and_names_them_all(tmp_path: Path) -> None:
    (tmp_path / "docs").mkdir()
    (tmp_path / "README.md").write_text('vcage run "Turn on the tap"\nvcage run "Turn on the tap" --seed 1\n')
    (tmp_path / "docs/cli.md").write_text('vcage run "Turn on the tap"\nvcage run "Ring the bell"\n')
    assert of_pages(tmp_path) == [
        Sentence("Turn on the tap", "README.md, docs/cli.md"),
        Sentence("Ring the bell", "docs/cli.md"),
    ]


def test_pages_without_a_sentence_are_an_error(tmp_path: Path) -> None:
    with pytest.raises(InputFileError, match="no page"):
        of_pages(tmp_path)


def test_libero_has_twenty_five_tasks_with_ids_of_their_own() -> None:
    found = of_libero()
    assert len(found) == len({sentence.source for sentence in found}) == 25
    assert all(sentence.source.startswith("libero/") for sentence in found)


def test_every_template_has_one_of_the_sentences() -> None:
    assert set(by_template()) == set(TEMPLATES)
    assert set(by_template().values()) <= {sentence.text for sentence in sentences()}


def test_quick_takes_one_sentence_of_each_template() -> None:
    assert {sentence.text for sentence in chosen(quick=True)} == set(by_template().values())


def test_sentences_are_chosen_by_a_part_of_their_words_in_any_case() -> None:
    assert {sentence.text for sentence in chosen(quick=False, only="MICROWAVE")} == {
        "open the microwave",
        "close the microwave",
    }
    with pytest.raises(UsageError, match="zebra"):
        chosen(quick=False, only="zebra")


def test_no_two_sentences_have_one_folder() -> None:
    names = [Whole(sentence).name for sentence in sentences()]
    assert len(set(names)) == len(names)
    assert len({slug(sentence.text) for sentence in sentences()}) == len(names), "scenes of the critic's outcomes"


def tried(template: str, true: bool | None, accepted: bool | None) -> Tried:
    return Tried(
        template=template, subtask="block-onto-plate", step=0, attempt=0, true=true, accepted=accepted, stage="verify",
        reason="seen", truth="it lies there",
    )  # fmt: skip


def result(*attempts: Tried, code: int = 0, wrong: str = "") -> Ran:
    return Ran(
        sentence="Put it there", source="README.md", seed=0, exit_code=code, reason="too few" if code else "",
        templates=list(dict.fromkeys(one.template for one in attempts)), tried=list(attempts), wrong_episode=wrong,
        seconds=10.0,
    )  # fmt: skip


def test_a_sentence_counts_under_each_of_its_templates_and_once_under_all() -> None:
    done = [result(tried("open", True, True), tried("place", True, True)), result(tried("place", True, False), code=7)]
    rows = {row["template"]: row for row in figures(done)["rows"]}
    assert list(rows) == ["place", "open", "all"]
    assert [(rows[name]["sentences"], rows[name]["exit_0"]) for name in rows] == [(2, 1), (1, 1), (2, 1)]
    assert [(rows[name]["attempts"], rows[name]["true"], rows[name]["accepted"]) for name in rows] == [
        (2, 2, 1),
        (1, 1, 1),
        (3, 3, 2),
    ]


def test_verdicts_are_false_where_the_state_contradicts() -> None:
    attempts = [(True, True), (True, False), (False, True), (False, False), (None, None)]
    row = figures([result(*(tried("place", *one) for one in attempts))])["rows"][0]
    assert row["attempts"] == 5, "one of them ended before anyone looked"
    assert (row["true"], row["accepted"], row["false_accepted"], row["false_refused"]) == (2, 2, 1, 1)


def test_a_sentence_without_a_chain_counts_as_refused() -> None:
    found = figures([result(code=2)])
    assert [(row["template"], row["sentences"], row["exit_0"]) for row in found["rows"]] == [
        ("refused", 1, 0),
        ("all", 1, 0),
    ]
    assert (found["sentences"][0]["exit_code"], found["sentences"][0]["reason"]) == (2, "too few")


def test_false_verdicts_and_wrong_episodes_are_reported_with_both_reasons() -> None:
    one = result(tried("place", False, True), tried("place", True, True), wrong="it lies beside it")
    first, verdict, episode = told(one)
    assert "exit 0" in first
    assert "FALSELY ACCEPTED: seen; by the state: it lies there" in verdict
    assert "WRONG EPISODE: it lies beside it" in episode


def test_a_sentence_not_understood_ends_with_the_commands_exit_code(tmp_path: Path) -> None:
    task = Whole(Sentence("Fold the napkin", "test"), keep=tmp_path)
    first = ran(task)
    assert (first.exit_code, first.templates, first.tried) == (2, [], [])
    assert "napkin" in first.reason or "Fold" in first.reason
    assert (tmp_path / task.name / "sentence.json").exists()


def test_a_finished_sentence_is_not_run_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(whole, "_run", lambda task, folder: result(tried("place", True, True)))
    task = Whole(Sentence("Put it there", "README.md"), keep=tmp_path)
    (tmp_path / task.name / "run").mkdir(parents=True)  # begun, and interrupted
    first = ran(task)
    assert not (tmp_path / task.name / "run").exists()
    monkeypatch.setattr(whole, "_run", lambda *_: pytest.fail("it is finished"))
    assert ran(task) == first


def test_an_internal_error_is_exit_code_1_and_the_others_continue(monkeypatch: pytest.MonkeyPatch) -> None:
    class Broken:
        __name__ = "vcage.stages.select_place"

        def job(self, *_: object) -> None:
            raise ValueError("a bug")

    monkeypatch.setitem(STAGES, "select_place", Broken())
    found = ran(Whole(Sentence("Put the blocks on the plate", "README.md")))
    assert (found.exit_code, found.reason) == (1, "ValueError: a bug")


def test_a_run_goes_as_far_as_the_verification() -> None:
    assert whole.THROUGH[0] == "select_place" and whole.THROUGH[-1] == "verify"
    assert not {"compress", "export"} & set(whole.THROUGH)


def test_no_remaining_sentence_is_a_usage_error() -> None:
    with pytest.raises(UsageError, match="zebra"):
        benchmark.run(quick=False, only="zebra")
    with pytest.raises(UsageError, match="seed"):
        benchmark.run(quick=False, seeds=0)
