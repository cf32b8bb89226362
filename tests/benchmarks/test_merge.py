"""The runs that are merged are as stages leave them, and no two episodes are the same."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks._merge_runs import RunSpec, make_run
from vcage.apps.run_episodes import additions_of, motion_key
from vcage.datasets.reader import EpisodeReader
from vcage.runs.raw_pictures import accepted_files, holds_links


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    root = tmp_path_factory.mktemp("runs")
    return [make_run(root / str(seed), RunSpec(seed=seed, episodes=2, frames=6)) for seed in (0, 1)]


def test_pictures_lie_in_videos_beside_the_episodes(runs):
    for file in accepted_files(runs[0]):
        assert holds_links(file.path)
        with EpisodeReader(file.path) as reader:
            block = np.abs(reader.images("cam_high")[0][20:28, 6:16].astype(int) - (200, 30, 40))
        assert block.mean() < 12


def test_no_two_episodes_are_the_same(runs):
    additions = [addition for run in runs for addition in additions_of(run, run.root.name)]
    assert len({addition.drawn for addition in additions}) == 4
    assert len({motion_key(addition.load()) for addition in additions}) == 4
