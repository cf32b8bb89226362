"""Data sets that grow from run to run."""

from __future__ import annotations

import json

import pytest

from tests.recordings import collected
from vcage.dataset.recordings.opening import open_recordings
from vcage.errors import MissingStage, UsageError
from vcage.files import RunFolder
from vcage.packing.settings import CompressionSettings
from vcage.pipeline import compress
from vcage.pipeline.appending import append_to
from vcage.pipeline.settings import ExportSettings, Settings
from vcage.pipeline.workbench import Workbench

BOTH = ("lerobot-v2.1", "lerobot-v3.0")
SETTINGS = Settings(seed=7, models="offline", workers=1, compression=CompressionSettings(crf=8, preset="ultrafast"))


def run_of(root, count: int) -> RunFolder:
    run = collected(root, count=count, frames=6)
    compress.execute(run, SETTINGS, Workbench("offline"))
    return run


@pytest.fixture(scope="module")
def runs(tmp_path_factory) -> tuple[RunFolder, RunFolder]:
    root = tmp_path_factory.mktemp("runs")
    return run_of(root / "a", 1), run_of(root / "b", 2)


@pytest.mark.parametrize("version", BOTH)
def test_the_episodes_of_two_runs_are_one_data_set(runs, tmp_path, version):
    for run in runs:
        sets = append_to(tmp_path / "all", run, SETTINGS)
    info = json.loads((sets[version] / "meta/info.json").read_text())
    assert (info["total_episodes"], info["total_frames"]) == (3, 18)
    assert [recording.index for recording in open_recordings(sets[version])] == [0, 1, 2]


def test_a_run_is_added_once(runs, tmp_path):
    for _ in range(2):
        sets = append_to(tmp_path / "all", runs[1], SETTINGS)
    assert json.loads((sets["lerobot-v3.0"] / "meta/info.json").read_text())["total_episodes"] == 2


def test_a_run_that_is_not_compressed_leaves_the_data_set_as_it_was(runs, tmp_path):
    sets = append_to(tmp_path / "all", runs[0], SETTINGS)
    before = (sets["lerobot-v3.0"] / "meta/info.json").read_bytes()
    with pytest.raises(MissingStage):
        append_to(tmp_path / "all", collected(tmp_path / "raw", frames=6), SETTINGS)
    assert (sets["lerobot-v3.0"] / "meta/info.json").read_bytes() == before


def test_only_lerobot_data_sets_grow(runs, tmp_path):
    settings = Settings(seed=7, export=ExportSettings(formats=("robotwin",)))
    with pytest.raises(UsageError, match="only LeRobot"):
        append_to(tmp_path / "all", runs[0], settings)
