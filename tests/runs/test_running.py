"""A run folder is one process's at a time, and says how long its stages took."""

from __future__ import annotations

import os

import pytest

from vcage.base.commands import CALLED, vcage_command
from vcage.base.errors import AnswerNeeded, EndpointFailed, FolderInUse, MissingStage, StageInterrupted
from vcage.base.files import RunFolder, write_json
from vcage.runs.by_products import note_seconds, read_timings, unfinished
from vcage.runs.context import StageContext
from vcage.runs.running import at_work, run_stage
from vcage.runs.stage import Job, StageOptions
from vcage.schema.export import Export


@pytest.fixture
def run(tmp_path) -> RunFolder:
    return RunFolder(tmp_path / "run")


def test_a_stage_that_fails_leaves_no_empty_run_folder(run):
    with pytest.raises(RuntimeError), at_work(run):
        Job(run=run, output=run.scene).do(Export, lambda *_: (_ for _ in ()).throw(RuntimeError()))
    assert not run.root.exists()


def test_two_processes_do_not_work_on_one_run_and_the_second_learns_of_the_first(run):
    with at_work(run):
        with (
            pytest.raises(FolderInUse, match=rf"in use by process {os.getpid()} on ") as refused,
            at_work(run),
        ):
            pass
        assert "wait" in refused.value.hint
    with at_work(run):
        assert [path.name for path in run.root.iterdir()] == ["in-use"]


def test_seconds_of_a_stage_that_grew_are_added_and_of_one_made_again_replaced(run):
    run.make()
    note_seconds(run, "collect", 3.0)
    note_seconds(run, "collect", 2.0, grown=True)
    assert read_timings(run) == {"collect": 5.0}
    note_seconds(run, "collect", 1.0)
    assert read_timings(run) == {"collect": 1.0}


class Fails:
    """A stage that tells how far it is, and fails."""

    Options, __name__ = StageOptions, "vcage.stages.collect"

    def __init__(self, error: BaseException):
        self.error = error

    def execute(self, run, options, context, progress):
        progress("2 episodes run", 2, 5)
        raise self.error

    def job(self, run, options, context):
        return Job(run=run, output=run.episodes)

    def summary(self, record): ...


def after_collecting_that_failed_by(error: BaseException, run: RunFolder) -> dict:
    run.layout.parent.mkdir(parents=True, exist_ok=True)
    CALLED.set(vcage_command("collect", "--run", run, "--episodes", 5))
    with pytest.raises(type(error)):
        run_stage(Fails(error), run, context=StageContext("offline"))
    return unfinished(run)


@pytest.mark.parametrize("error", [KeyboardInterrupt(), EndpointFailed("gone for now")], ids=repr)
def test_a_stage_after_an_interrupted_one_names_it_with_its_progress_and_the_resuming_command(run, error):
    after_collecting_that_failed_by(error, run)
    needing = Fails(MissingStage("verify needs episodes.json", maker="collect"))
    needing.__name__ = "vcage.stages.verify"
    with pytest.raises(StageInterrupted, match="collect was interrupted after 2 of 5 episodes") as told:
        run_stage(needing, run, context=StageContext("offline"))
    assert (told.value.command, told.value.exit_code) == (vcage_command("collect", "--run", run, "--episodes", 5), 7)
    assert list(unfinished(run)) == ["collect"]


FOREIGN_COMMANDS = {
    "another program": "rm -rf /home",
    "another run": vcage_command("collect", "--run", "/elsewhere"),
    "two commands": "{ours} --seed 1; rm -rf /home",
    "a script to execute": "{ours} --script {run}/subtasks/x.py",
    "an open quote": "vcage '",
    "a list": ["rm", "-rf"],
}


@pytest.mark.parametrize("command", FOREIGN_COMMANDS.values(), ids=FOREIGN_COMMANDS)
def test_a_command_planted_in_the_folder_is_not_shown(run, command):
    ours = vcage_command("collect", "--run", run)
    command = command.format(ours=ours, run=run) if isinstance(command, str) else command
    write_json(run.scene, {})
    write_json(run.unfinished, {"collect": {"command": command, "done": 2, "total": 5}})
    needing = Fails(MissingStage("verify needs episodes.json", maker="collect"))
    with pytest.raises((StageInterrupted, MissingStage)) as told:
        run_stage(needing, run, context=StageContext("offline"))
    assert (told.value.command, told.value.maker) == ("", "collect")


def test_a_stage_with_an_error_of_its_own_is_not_called_interrupted(run):
    after_collecting_that_failed_by(EndpointFailed("gone for now"), run)
    assert after_collecting_that_failed_by(MissingStage("no scene", maker="optimize"), run) == {}
    assert not run.unfinished.exists()


def test_a_stage_that_waits_for_an_answer_was_not_interrupted(run, tmp_path):
    assert after_collecting_that_failed_by(AnswerNeeded.of(tmp_path, "critic", 1, "", []), run) == {}


def test_the_second_process_learns_the_progress_of_the_first(run):
    with at_work(run):
        run.unfinished.write_text('{"collect": {"command": "", "done": 2, "total": 5}}')
        with pytest.raises(FolderInUse) as refused, at_work(run):
            pass
    assert refused.value.details["done_so_far"]["collect"]["done"] == 2
