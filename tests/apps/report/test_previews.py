"""Previews: what the cameras saw, side by side, in the order of the episodes."""

from __future__ import annotations

import base64

import numpy as np
import pytest

from tests.recordings import CAMERAS, FPS, HEIGHT, WIDTH, clip, written
from vcage.apps.report.previews import GAP_PX, previews
from vcage.base.errors import DamagedFile
from vcage.base.videos import decode, frame_rate


def video(url: str) -> bytes:
    return base64.b64decode(url.removeprefix("data:video/mp4;base64,"))


def test_all_cameras_are_seen_side_by_side_as_fast_as_they_saw(tmp_path):
    (shown,) = previews([(written(tmp_path / "a.hdf5", 12), FPS)])
    frames = decode(video(shown.url))
    assert shown.cameras == list(CAMERAS)
    assert frames.shape == (12, HEIGHT, len(CAMERAS) * (WIDTH + GAP_PX) - GAP_PX, 3)
    assert frame_rate(video(shown.url)) == FPS
    for number in range(len(CAMERAS)):
        left = number * (WIDTH + GAP_PX)
        seen = frames[:, :, left : left + WIDTH].astype(float)
        away = [np.abs(seen - clip(12, other)).mean() for other in range(len(CAMERAS))]
        assert min(away) == away[number] < 15


def test_episodes_keep_their_order(tmp_path):
    files = [(written(tmp_path / f"{frames}.hdf5", frames), FPS) for frames in (9, 3, 6, 4)]
    assert [len(decode(video(shown.url))) for shown in previews(files)] == [9, 3, 6, 4]


def test_a_damaged_episode_is_named(tmp_path):
    whole, damaged = written(tmp_path / "a.hdf5", 3), tmp_path / "b.hdf5"
    damaged.write_bytes(whole.read_bytes()[:2000])
    with pytest.raises(DamagedFile, match=r"b\.hdf5"):
        previews([(whole, FPS), (damaged, FPS)])
