"""Judging again: all accepted episodes from the pictures that were kept, or one pair."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.runs import OPTIONS, copied
from vcage.base.errors import DamagedFile, InputFileError, MissingStage, StaleStage, UnknownName
from vcage.base.files import read_json, write_json
from vcage.base.pictures import read_picture, write_picture
from vcage.schema.episodes import Episodes, SingleVerdict, Verdicts
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


def test_another_picture_is_judged_anew(finished, tmp_path):
    run = copied(finished.run, tmp_path / "run", before="verify")
    (episode,) = Episodes.read(run.episodes).episodes
    before, after = tops(run, episode)
    write_picture(after, read_picture(before))
    record = verify.execute(run, OPTIONS, finished.context).record
    assert record.taken_over == len(episode.subtasks) - 1
    assert not record.episodes[episode.file][0].accepted


def test_a_pair_is_judged_by_what_it_shows(finished):
    subtask, before, after = pair(finished)
    done = verify.judge_pair(finished.run, finished.context, subtask, before, after)
    idle = verify.judge_pair(finished.run, finished.context, subtask, before, before)
    assert isinstance(done, SingleVerdict) and done.verdict.accepted
    assert not idle.verdict.accepted and idle.verdict.reason


def test_an_unknown_subtask_lists_those_there_are(finished):
    subtask, before, after = pair(finished)
    with pytest.raises(UnknownName, match=subtask):
        verify.judge_pair(finished.run, finished.context, "fly-to-the-moon", before, after)


def test_a_missing_picture_is_named(finished, tmp_path):
    subtask, before, _ = pair(finished)
    with pytest.raises(MissingStage, match=r"nowhere\.png"):
        verify.judge_pair(finished.run, finished.context, subtask, before, tmp_path / "nowhere.png")


def test_what_is_no_picture_is_named(finished, tmp_path):
    subtask, before, _ = pair(finished)
    (tmp_path / "text.png").write_text("not a picture")
    with pytest.raises(DamagedFile, match=r"text\.png"):
        verify.judge_pair(finished.run, finished.context, subtask, before, tmp_path / "text.png")


def test_pictures_of_another_camera_s_size_are_refused(finished, tmp_path):
    subtask, before, after = pair(finished)
    small = write_picture(tmp_path / "small.png", np.ascontiguousarray(read_picture(after)[::2, ::2]))
    with pytest.raises(InputFileError, match=r"small\.png"):
        verify.judge_pair(finished.run, finished.context, subtask, before, small)


def test_other_episodes_make_the_verdicts_stale(finished, tmp_path):
    run = copied(finished.run, tmp_path / "run")
    write_json(run.episodes, {**read_json(run.episodes), "instruction": "something else"})
    with pytest.raises(StaleStage, match=r"episodes/episodes\.json"):
        verify.execute(run, OPTIONS, finished.context)
