"""Pictures of episodes for the policy benchmark."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from benchmarks._policy.localiser import View
from benchmarks._policy.pictures import shrunk_pictures
from tests.recordings import CAMERAS, collected
from vcage.datasets.reader import EpisodeReader
from vcage.runs.accepted import accepted_episodes

FRAMES = 4


def test_pictures_come_one_episode_after_the_other_in_the_size_of_the_view(tmp_path: Path) -> None:
    run = collected(tmp_path / "run", count=2, frames=FRAMES)
    view = View(CAMERAS[0], None, 12, 16)
    found = shrunk_pictures(run, "raw", [view], 2, tmp_path)[view.camera]
    assert found.shape == (2 * FRAMES, 12, 16, 3)
    with EpisodeReader(run.file(str(accepted_episodes(run)[1].file))) as reader:
        assert np.array_equal(found[FRAMES], view.shrunk(reader.images(view.camera)[0]))


def test_a_kept_video_is_written_anew_for_a_newer_episode(tmp_path: Path) -> None:
    run = collected(tmp_path / "run", count=1, frames=FRAMES)
    view = View(CAMERAS[0], None, 12, 16)
    first = shrunk_pictures(run, "lerobot", [view], 1, tmp_path / "kept")[view.camera]
    (video,) = (tmp_path / "kept").iterdir()
    video.write_bytes(b"of an earlier episode")
    os.utime(video, (0, 0))
    assert np.array_equal(shrunk_pictures(run, "lerobot", [view], 1, tmp_path / "kept")[view.camera], first)
