"""A run folder is one process's at a time, and says how long its stages took."""

from __future__ import annotations

import os

import pytest

from vcage.base.errors import OutputFolderError
from vcage.base.files import RunFolder
from vcage.schema.export import Export
from vcage.stages.running import at_work, note_seconds, read_timings
from vcage.stages.stage import Job


@pytest.fixture
def run(tmp_path) -> RunFolder:
    return RunFolder(tmp_path / "run")


def test_a_stage_that_fails_leaves_no_empty_run_folder(run):
    with pytest.raises(RuntimeError), at_work(run):
        Job(run=run, output=run.scene).do(Export, lambda *_: (_ for _ in ()).throw(RuntimeError()))
    assert not run.root.exists()


def test_two_processes_do_not_work_on_one_run_and_the_second_is_told_of_the_first(run):
    with at_work(run):
        with (
            pytest.raises(OutputFolderError, match=rf"in use by process {os.getpid()} on ") as refused,
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
