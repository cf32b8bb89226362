"""A finished stage is left alone, a stale one is refused, a killed one leaves the previous state."""

from __future__ import annotations

import pytest

from vcage.base.errors import DamagedFile, MissingStage, OutputFolderError, StaleStage
from vcage.base.files import RunFolder, write_text
from vcage.runs.stage import Job
from vcage.schema.export import Export


def job(run: RunFolder, **changes) -> Job:
    write_text(run.compression, "{}") if not run.compression.exists() else None
    return Job(**{"run": run, "output": run.export, "inputs": [run.compression], **changes})


def make(_folder, provenance) -> Export:
    return Export(provenance=provenance, datasets=[])


@pytest.fixture
def run(tmp_path) -> RunFolder:
    return RunFolder(tmp_path / "run")


def test_a_stage_writes_its_record(run):
    result = job(run).do(Export, make)
    assert result.fresh
    assert Export.read(run.export).provenance.inputs.keys() == {"compress/compression.json"}


def test_a_finished_stage_does_nothing(run):
    job(run).do(Export, make)

    def never(*_):
        raise AssertionError("made again")

    assert not job(run).do(Export, never).fresh


def test_another_seed_makes_it_stale_and_says_so(run):
    job(run).do(Export, make)
    with pytest.raises(StaleStage, match="another seed") as caught:
        job(run, seed=1).do(Export, make)
    assert "another run folder" in caught.value.hint


def test_another_option_is_named_with_both_values(run):
    job(run, options={"robot": "dual_panda"}).do(Export, make)
    with pytest.raises(StaleStage, match=r"option robot \(dual_panda before, aloha_agilex now\)") as caught:
        job(run, options={"robot": "aloha_agilex"}).do(Export, make)
    assert "the same options as before" in caught.value.hint


def test_a_changed_input_makes_it_stale(run):
    job(run).do(Export, make)
    write_text(run.compression, "{ }")
    with pytest.raises(StaleStage, match=r"input compress/compression\.json") as caught:
        job(run).do(Export, make)
    assert caught.value.hint.startswith("put back what changed")


def test_an_input_that_is_gone_is_named_as_such(run):
    write_text(run.verdicts, "{}")
    job(run, inputs=[run.compression, run.verdicts]).do(Export, make)
    run.verdicts.unlink()
    with pytest.raises(StaleStage, match=r"input verify/verdicts\.json, which is gone"):
        job(run).do(Export, make)


def test_force_makes_it_again(run):
    job(run).do(Export, make)
    assert job(run, seed=1).do(Export, make, force=True).record.provenance.seed == 1


def test_a_failing_stage_leaves_the_previous_state(run):
    job(run).do(Export, make)
    before = run.export.read_bytes()
    with pytest.raises(RuntimeError):
        job(run).do(Export, lambda *_: (_ for _ in ()).throw(RuntimeError()), force=True)
    assert run.export.read_bytes() == before


def test_a_missing_input_names_the_stage_that_writes_it(run):
    run.root.mkdir()
    with pytest.raises(MissingStage, match="export needs") as caught:
        Job(run=run, output=run.export, inputs=[run.compression]).do(Export, make)
    assert caught.value.hint.startswith("run compress first")


def test_a_damaged_output_names_the_stage_that_makes_it_again(run):
    job(run).do(Export, make)
    run.export.write_text("{")
    with pytest.raises(DamagedFile) as caught:
        job(run).do(Export, make)
    assert caught.value.maker == "export"


def test_files_that_no_stage_made_are_left_alone_unless_forced(run):
    mine = write_text(run.export.parent / "mine.txt", "mine")
    with pytest.raises(OutputFolderError, match="in the way") as caught:
        job(run).do(Export, make)
    assert mine.read_text() == "mine"
    assert "--force" in caught.value.hint
    assert job(run).do(Export, make, force=True).fresh
