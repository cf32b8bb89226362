"""Stages of the chain that are made again from other files, and those that are refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.run_folders import Finished, copied, digests
from vcage.base.errors import StaleStage
from vcage.base.files import RunFolder, read_json, sha256_file, write_json
from vcage.base.progress import silent
from vcage.stages import export
from vcage.stages.chain import up_to_date

pytestmark = pytest.mark.slow


@pytest.fixture
def run(finished: Finished, tmp_path: Path) -> RunFolder:
    return copied(finished.run, tmp_path / "run")


def test_an_export_from_other_verdicts_is_made_again(run: RunFolder, finished: Finished) -> None:
    verdicts = read_json(run.verdicts)
    next(iter(verdicts["episodes"].values()))[0]["reason"] = "as I saw it"
    write_json(run.verdicts, verdicts)
    done = up_to_date("export", export, run, export.Options(), finished.context, silent)
    assert done.fresh and done.record.provenance.inputs["verify/verdicts.json"] == sha256_file(run.verdicts)


def test_an_export_with_other_options_is_left_alone(run: RunFolder, finished: Finished) -> None:
    files = digests(run.root)
    with pytest.raises(StaleStage, match="option formats"):
        up_to_date("export", export, run, export.Options(formats=("lerobot-v3.0",)), finished.context, silent)
    assert digests(run.root) == files
