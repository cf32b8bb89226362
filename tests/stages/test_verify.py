"""Judging again: all attempts from the pictures that were kept, or one pair."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from tests.model_server import ModelServer, text_answer
from tests.run_folders import OPTIONS, Finished, command, copied
from vcage.base.drawing import EDGE, VIEW
from vcage.base.errors import DamagedFile, InputFileError, MissingStage, StaleStage, UnknownName
from vcage.base.files import RunFolder, read_json, write_json, write_text
from vcage.base.pictures import read_picture, write_picture
from vcage.episodes import second_judge
from vcage.episodes.second_judge import judge_pair
from vcage.episodes.store import log_path, read_log
from vcage.runs.edits import seal
from vcage.schema.episodes import Attempt, CriticCounts, Episodes, SingleVerdict, Truth, Verdict, Verdicts
from vcage.stages import verify


def pair(finished):
    """The first sub-task's id and the two pictures that were looked at."""
    episode = Episodes.read(finished.run.episodes).episodes[0]
    return episode.subtasks[0], *tops(finished.run, episode)


def tops(run, episode):
    """The views from above before and after the first sub-task."""
    return [run.episodes.parent / p for p in episode.verdicts[0].pictures if p.endswith("-top.png")]


def test_the_same_critic_says_the_same_again(finished):
    episode = Episodes.read(finished.run.episodes).episodes[0]
    verdicts = Verdicts.read(finished.run.verdicts).episodes[episode.file]
    assert [v.reason for v in verdicts] == [v.reason for v in episode.verdicts]
    for verdict in verdicts:
        assert all((finished.run.verdicts.parent / name).is_file() for name in verdict.pictures)


class Never:
    """A critic that must not be asked."""

    provider = "offline"

    def judge(self, _question):
        raise AssertionError("asked again")


def test_a_verdict_of_the_same_critic_on_the_same_pictures_is_taken_over(finished, tmp_path, monkeypatch):
    run = copied(finished.run, tmp_path / "run", before="verify")
    monkeypatch.setattr(finished.context, "models", replace(finished.context.models, critic=Never()))
    record = verify.execute(run, OPTIONS, finished.context).record
    (episode,) = Episodes.read(run.episodes).episodes
    assert record.taken_over == len(episode.subtasks) > 0
    assert verify.summary(record)["taken_over"] == record.taken_over
    with pytest.raises(AssertionError, match="asked again"):
        verify.execute(run, replace(OPTIONS, force=True), finished.context)


def test_another_picture_is_judged_again(finished, tmp_path):
    run = copied(finished.run, tmp_path / "run", before="verify")
    (episode,) = Episodes.read(run.episodes).episodes
    before, after = tops(run, episode)
    write_picture(after, read_picture(before))
    record = verify.execute(run, OPTIONS, finished.context).record
    assert record.taken_over == len(episode.subtasks) - 1
    assert not record.episodes[episode.file][0].accepted


# --- two critics ---------------------------------------------------------------------------------------


class Says:
    """A critic that gives the same answer to everything."""

    provider = "another"

    def __init__(self, accepted: bool):
        self._accepted = accepted
        self.asked = 0

    def judge(self, _question: object) -> Verdict:
        self.asked += 1
        return Verdict(accepted=self._accepted, reason="it always says so", confidence=0.6, provider=self.provider)


@pytest.fixture
def run(finished: Finished, tmp_path) -> RunFolder:
    """A collection whose first sub-task was wrongly refused, and rightly, before it was verified."""
    run = copied(finished.run, tmp_path / "run", before="verify")
    attempts = read_log(run.episodes.parent)
    first = attempts[0]
    wrongly = refused(run, first, 7, first.truth)
    rightly = refused(run, first, 8, Truth(success=False, reason="it lies beside it"))
    write_log(run, [wrongly, rightly, *attempts])
    return run


def refused(run: RunFolder, done: Attempt, number: int, truth: Truth) -> Attempt:
    """An attempt whose pictures show the same before and after, and that the collecting critic refused."""
    before = next(p for p in done.verdict.pictures if "-before-" in p)
    pictures = [f"critic/e{done.episode:06d}-s{done.step}-a{number}-{when}-top.png" for when in ("before", "after")]
    for name in pictures:
        write_picture(run.episodes.parent / name, read_picture(run.episodes.parent / before))
    said = Verdict(accepted=False, reason="nothing moved", confidence=0.9, provider="offline", pictures=pictures)
    return done.model_copy(update={"attempt": number, "accepted": False, "verdict": said, "truth": truth})


def write_log(run: RunFolder, attempts: Sequence[Attempt]) -> None:
    write_text(log_path(run.episodes.parent), "".join(a.model_dump_json() + "\n" for a in attempts))
    seal(Episodes.read(run.episodes), run.episodes)


def judged_by(
    critic: Says, run: RunFolder, finished: Finished, monkeypatch: pytest.MonkeyPatch, refused: bool = True
) -> Verdicts:
    monkeypatch.setattr(finished.context, "models", replace(finished.context.models, critic=critic))
    return verify.execute(run, replace(OPTIONS, refused=refused), finished.context).record


def test_nothing_is_asked_about_attempts_that_were_not_accepted(run, finished, monkeypatch):
    critic = Says(True)
    record = judged_by(critic, run, finished, monkeypatch, refused=False)
    steps = len(Episodes.read(run.episodes).episodes[0].subtasks)
    assert critic.asked == record.critic.judged == record.earlier_critic.judged == steps
    assert record.differences == [] and record.not_kept == 0


def test_a_rejected_episode_raises_no_question(run, finished, monkeypatch):
    collected = Episodes.read(run.episodes)
    rejected = [e.model_copy(update={"accepted": False, "file": None}) for e in collected.episodes]
    collected.model_copy(update={"episodes": rejected}).write(run.episodes)
    seal(Episodes.read(run.episodes), run.episodes)
    critic = Says(True)
    record = judged_by(critic, run, finished, monkeypatch, refused=False)
    assert (critic.asked, record.episodes, record.critic.judged) == (0, {}, 0)


def test_a_later_request_for_rejected_attempts_is_refused(run, finished, monkeypatch):
    judged_by(Says(True), run, finished, monkeypatch, refused=False)
    with pytest.raises(StaleStage, match="refused"):
        judged_by(Says(True), run, finished, monkeypatch, refused=True)


def test_a_second_critic_differs_by_saying_no_where_the_first_said_yes(run, finished, monkeypatch):
    record = judged_by(Says(False), run, finished, monkeypatch)
    (episode,) = Episodes.read(run.episodes).episodes
    assert [d.subtask for d in record.differences] == episode.subtasks
    for found in record.differences:
        assert (found.earlier_verdict.accepted, found.verdict.accepted, found.truth.success) == (True, False, True)
        assert found.verdict.reason == "it always says so"
        assert found.text
        for name in (*found.verdict.pictures, *found.earlier_verdict.pictures):
            assert (run.verdicts.parent / name).is_file()


def test_both_critics_are_counted_over_refused_attempts_too(run, finished, monkeypatch):
    steps = len(Episodes.read(run.episodes).episodes[0].subtasks)
    record = judged_by(Says(True), run, finished, monkeypatch)
    assert record.earlier_critic == CriticCounts.of([(True, True)] * steps + [(False, True), (False, False)])
    assert record.critic == CriticCounts.of([(True, True)] * (steps + 1) + [(True, False)])
    assert [d.attempt for d in record.differences] == [7, 8]


def test_the_verdicts_of_accepted_episodes_are_of_their_verified_attempts_alone(run, finished, monkeypatch):
    record = judged_by(Says(True), run, finished, monkeypatch)
    (episode,) = Episodes.read(run.episodes).episodes
    ((file, verdicts),) = record.episodes.items()
    assert file == episode.file
    assert [v.pictures for v in verdicts] == [[f"../episodes/{p}" for p in v.pictures] for v in episode.verdicts]


def test_every_difference_has_a_picture_to_look_at(run, finished, monkeypatch):
    record = judged_by(Says(False), run, finished, monkeypatch)
    drawn = [run.verdicts.parent / found.picture for found in record.differences]
    assert drawn and sorted(drawn) == sorted((run.verdicts.parent / "differences").iterdir())
    assert all(read_picture(path).shape[1] == 2 * VIEW + 3 * EDGE for path in drawn)


def test_the_same_critic_differs_nowhere_from_itself(finished):
    record = Verdicts.read(finished.run.verdicts)
    assert record.differences == [] and record.not_kept == 0
    assert record.critic == record.earlier_critic == Episodes.read(finished.run.episodes).critic
    assert not (finished.run.verdicts.parent / "differences").exists()


def test_an_attempt_that_lost_a_picture_is_left_out_and_counted(run, finished, monkeypatch):
    (run.episodes.parent / read_log(run.episodes.parent)[0].verdict.pictures[0]).unlink()
    record = judged_by(Says(True), run, finished, monkeypatch)
    assert record.not_kept == 1
    assert [d.attempt for d in record.differences] == [8]
    assert record.critic.judged == record.earlier_critic.judged == len(read_log(run.episodes.parent)) - 1


def test_a_warning_says_that_no_attempt_has_stored_pictures(run, finished, monkeypatch, caplog):
    attempts = read_log(run.episodes.parent)
    write_log(run, [a.model_copy(update={"truth": None}) for a in attempts])
    told = verify.summary(judged_by(Says(False), run, finished, monkeypatch))
    assert f"none of {len(attempts)} judged attempts" in caplog.text
    assert (told["critic"]["judged"], told["differ"], told["not_kept"]) == (0, 0, len(attempts))
    assert told["critic"]["recall"]["share"] is None


def test_a_model_behind_an_endpoint_is_compared_by_the_command(run, monkeypatch, capsys):
    attempts = read_log(run.episodes.parent)
    no = {"observations": "none", "done": "no", "reason": "I see no block", "failure": "lost", "confidence": 0.7}
    no["also_moved"] = []
    with ModelServer() as server:
        monkeypatch.setenv("VCAGE_GEMINI_API_KEY", server.key)
        monkeypatch.setenv("VCAGE_GEMINI_BASE_URL", server.url)
        server.queue(*[text_answer(json.dumps(no))] * len(attempts))
        told = command(capsys, "verify", "--run", run.root, "--models", "gemini", "--refused").record["summary"]
    asked = {attempt.verdict.question for attempt in attempts if attempt.verdict}
    assert len(server.requests) == len(asked), "of the same pictures it is asked once"
    assert told["critic"]["recall"] == {"some": 0, "of": len(attempts) - 1, "share": 0.0, "low": 0.0} | {
        "high": told["critic"]["recall"]["high"]
    }
    assert told["differ"] == told["earlier_critic"]["true_accepted"] == len(attempts) - 2
    assert {d.verdict.reason for d in Verdicts.read(run.verdicts).differences} == {"I see no block"}


def test_another_log_is_judged_again(finished, tmp_path):
    run = copied(finished.run, tmp_path / "run")
    write_log(run, read_log(run.episodes.parent)[:-1])
    done = verify.execute(run, OPTIONS, finished.context)
    assert done.fresh and done.record.critic.judged == Verdicts.read(finished.run.verdicts).critic.judged - 1


def test_a_damaged_line_of_the_log_is_reported_in_one_line(finished, tmp_path):
    run = copied(finished.run, tmp_path / "run")
    log = log_path(run.episodes.parent)
    write_text(log, log.read_text() + '{"episode": -1}\n')
    with pytest.raises(DamagedFile, match=r"log\.jsonl, line \d+: field \w+: ") as caught:
        read_log(run.episodes.parent)
    assert "\n" not in caught.value.message and "http" not in caught.value.message


def test_without_the_picture_of_the_empty_table_the_stage_that_takes_it_is_named(finished, tmp_path):
    run = copied(finished.run, tmp_path / "run", before="verify")
    next((run.episodes.parent / "critic").glob("*-background-top.png")).unlink()
    with pytest.raises(MissingStage, match=r"background-top\.png") as caught:
        verify.execute(run, OPTIONS, finished.context)
    assert caught.value.maker == "collect"


# --- one pair ------------------------------------------------------------------------------------------


def test_a_pair_is_judged_by_its_pictures(finished):
    subtask, before, after = pair(finished)
    done = judge_pair(finished.run, finished.context, subtask, before, after)
    idle = judge_pair(finished.run, finished.context, subtask, before, before)
    assert isinstance(done, SingleVerdict) and done.verdict.accepted
    assert not idle.verdict.accepted and idle.verdict.reason


@pytest.mark.parametrize(("ends", "alone"), [(True, False), (False, True)])
def test_only_the_end_of_an_attempt_brings_its_other_pictures(finished, monkeypatch, ends: bool, alone: bool):
    subtask, before, after = pair(finished)
    shown = []
    said = Verdict(accepted=False, reason="not asked", confidence=0.5, provider="none")
    monkeypatch.setattr(second_judge, "verdict", lambda context, scene, asking: shown.append(asking.seen) or said)
    judge_pair(finished.run, finished.context, subtask, before, after if ends else before)
    assert all(list(by) == ["top"] for by in shown[0].values()) is alone


def test_an_unknown_subtask_error_lists_the_known_ones(finished):
    subtask, before, after = pair(finished)
    with pytest.raises(UnknownName, match=subtask):
        judge_pair(finished.run, finished.context, "fly-to-the-moon", before, after)


def test_a_missing_picture_is_named(finished, tmp_path):
    subtask, before, _ = pair(finished)
    with pytest.raises(MissingStage, match=r"nowhere\.png"):
        judge_pair(finished.run, finished.context, subtask, before, tmp_path / "nowhere.png")


def test_a_file_without_a_picture_is_named(finished, tmp_path):
    subtask, before, _ = pair(finished)
    (tmp_path / "text.png").write_text("not a picture")
    with pytest.raises(DamagedFile, match=r"text\.png"):
        judge_pair(finished.run, finished.context, subtask, before, tmp_path / "text.png")


def test_pictures_of_another_camera_s_size_are_refused(finished, tmp_path):
    subtask, before, after = pair(finished)
    small = write_picture(tmp_path / "small.png", np.ascontiguousarray(read_picture(after)[::2, ::2]))
    with pytest.raises(InputFileError, match=r"small\.png"):
        judge_pair(finished.run, finished.context, subtask, before, small)


def test_verdicts_of_another_layout_are_stale(finished, tmp_path):
    run = copied(finished.run, tmp_path / "run")
    write_json(run.layout, {**read_json(run.layout), "checks": {}})
    with pytest.raises(StaleStage, match=r"optimize/scene\.json"):
        verify.execute(run, OPTIONS, finished.context)
