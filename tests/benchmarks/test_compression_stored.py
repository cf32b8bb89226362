"""Clips on the disk: what comes back, and how many bytes it takes."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from benchmarks._compression_stored import Video, random_decode_ms, store_pictures
from tests.recordings import FPS, clip
from vcage.video.codec import EncoderSettings, encode

FRAMES = clip(6)


def test_png_pictures_come_back_as_they_were(tmp_path: Path) -> None:
    stored = store_pictures(FRAMES, tmp_path / "clip.hdf5", ".png", [])
    np.testing.assert_array_equal(stored.read([1, 4]), FRAMES[[1, 4]])


def test_jpeg_pictures_keep_red_and_blue_apart(tmp_path: Path) -> None:
    red = np.full((1, 48, 64, 3), (200, 90, 40), np.uint8)
    stored = store_pictures(red, tmp_path / "clip.hdf5", ".jpg", [cv2.IMWRITE_JPEG_QUALITY, 95])
    np.testing.assert_allclose(stored.read([0]), red, atol=3)


def test_bytes_match_the_encoded_pictures(tmp_path: Path) -> None:
    stored = store_pictures(FRAMES, tmp_path / "clip.hdf5", ".png", [])
    assert stored.bytes == sum(len(cv2.imencode(".png", frame[..., ::-1])[1]) for frame in FRAMES)
    assert stored.bytes < stored.path.stat().st_size


def test_a_video_is_read_at_any_frame(tmp_path: Path) -> None:
    path = tmp_path / "clip.mp4"
    path.write_bytes(encode(FRAMES, FPS, EncoderSettings(gop=2), 4))
    video = Video(path)
    assert video.bytes == path.stat().st_size
    assert np.abs(video.read([5])[0].astype(int) - FRAMES[5]).mean() < 3


def test_the_time_of_a_random_frame_is_positive(tmp_path: Path) -> None:
    assert random_decode_ms(store_pictures(FRAMES, tmp_path / "clip.hdf5", ".png", []), len(FRAMES)) > 0
