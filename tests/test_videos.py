from __future__ import annotations

import numpy as np
import pytest

from tests.recordings import FPS, clip
from vcage.compression.codec import EncoderSettings, encode
from vcage.errors import DamagedFile, UsageError
from vcage.videos import decode


@pytest.fixture(scope="module")
def video():
    return encode(clip(25), FPS, EncoderSettings(), 4)


def test_chosen_frames_are_those_of_the_whole_video(video):
    assert np.array_equal(decode(video, [0, 7, 24]), decode(video)[[0, 7, 24]])


def test_a_video_that_is_cut_off_is_damaged(video, tmp_path):
    path = tmp_path / "video.mp4"
    path.write_bytes(video[:300])
    with pytest.raises(DamagedFile, match=r"video\.mp4"):
        decode(path)


def test_a_frame_beyond_the_end_is_refused(video):
    with pytest.raises(UsageError, match="25 frames"):
        decode(video, [25])
