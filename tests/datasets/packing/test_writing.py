from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.recordings import CAMERAS, FPS, INSTRUCTION, STATE_NAMES, episode, wordings_of, written
from vcage.datasets.lerobot.episode import SubtaskSpan
from vcage.datasets.packing.output import OutputSpec
from vcage.datasets.packing.writing import lerobot_episode
from vcage.datasets.recordings.opening import open_hdf5


def test_our_own_episodes_have_nothing_to_complain_of(tmp_path):
    recording = open_hdf5(written(tmp_path / "a.hdf5", 12))
    one = lerobot_episode(recording, dict.fromkeys(CAMERAS, Path("a.mp4")), OutputSpec())
    assert list(one.complaints()) == []
    assert (one.length, one.robot, one.task, one.fps) == (12, "dual_panda", INSTRUCTION, FPS)
    assert one.vector_names == {"observation.state": STATE_NAMES, "action": STATE_NAMES}
    np.testing.assert_allclose(one.vectors["observation.state"], episode(12).qpos, atol=1e-6)
    assert one.subtasks == [
        SubtaskSpan("lift block", 0, 6, wordings_of("lift-block")),
        SubtaskSpan("place block", 6, 12, wordings_of("place-block")),
    ]
