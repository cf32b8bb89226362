"""What is read from a video file, and which files are refused."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest

from tests.recordings import clip
from vcage.base.errors import DamagedFile
from vcage.datasets.lerobot.video import video_info
from vcage.video.codec import EncoderSettings, encode


def encoded(path: Path, frames: int = 12, codec: str = "libx264", *, times=None, sound=False, options=None) -> Path:
    """A video at 10 fps of pictures shown at ``times``, in tenths of a second."""
    with av.open(str(path), "w", options=options or {}) as container:
        stream = container.add_stream(codec, rate=10, width=64, height=48)
        stream.codec_context.time_base = Fraction(1, 10)
        audio = container.add_stream("aac", rate=8000, layout="mono") if sound else None
        for picture, time in zip(clip(frames), times or range(frames), strict=True):
            frame = av.VideoFrame.from_ndarray(picture, format="rgb24").reformat(format="yuv420p")
            frame.pts, frame.time_base = time, Fraction(1, 10)
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
        if audio is not None:
            silence = av.AudioFrame.from_ndarray(np.zeros((1, 1024), np.float32), format="fltp", layout="mono")
            silence.sample_rate = 8000
            container.mux(audio.encode(silence))
            container.mux(audio.encode(None))
    return path


def test_the_facts_of_our_own_videos(tmp_path):
    path = tmp_path / "a.mp4"
    path.write_bytes(encode(clip(12), 10.0, EncoderSettings(pixel_format="yuv420p"), 20))
    assert video_info(path, 12, 10.0) == {
        "video.height": 48,
        "video.width": 64,
        "video.channels": 3,
        "video.codec": "hevc",
        "video.pix_fmt": "yuv420p",
        "video.fps": 10,
        "video.is_depth_map": False,
        "has_audio": False,
    }


@pytest.mark.parametrize(("codec", "name"), [("libx264", "h264"), ("libsvtav1", "av1")])
def test_videos_of_other_encoders_with_reordered_frames_fit_too(tmp_path, codec, name):
    assert video_info(encoded(tmp_path / "a.mp4", 40, codec), 40, 10)["video.codec"] == name


def test_sound_is_told(tmp_path):
    assert video_info(encoded(tmp_path / "a.mp4", sound=True), 12, 10)["has_audio"]


def test_frame_rates_that_are_no_whole_numbers_are_kept(tmp_path):
    path = tmp_path / "a.mp4"
    path.write_bytes(encode(clip(40), 16.67, EncoderSettings(), 20))
    assert video_info(path, 40, 16.67)["video.fps"] == 16.67


def test_another_number_of_frames_is_refused(tmp_path):
    with pytest.raises(DamagedFile, match=r"a\.mp4 has 12 frames, its episode 13"):
        video_info(encoded(tmp_path / "a.mp4"), 13, 10)


def test_another_frame_rate_is_refused(tmp_path):
    with pytest.raises(DamagedFile, match=r"frame 1 at 0\.1000 s, its episode has 25"):
        video_info(encoded(tmp_path / "a.mp4"), 12, 25)


def test_pictures_at_uneven_times_are_refused(tmp_path):
    path = encoded(tmp_path / "a.mp4", times=[*range(11), 14])
    with pytest.raises(DamagedFile, match=r"frame 11 at 1\.4000 s"):
        video_info(path, 12, 10)


def test_another_container_is_refused(tmp_path):
    with pytest.raises(DamagedFile, match="Matroska"):
        video_info(encoded(tmp_path / "a.mkv"), 12, 10)


@pytest.mark.parametrize("options", [{}, {"movflags": "faststart"}], ids=["index last", "index first"])
def test_a_file_that_is_cut_off_is_refused(tmp_path, options):
    path = encoded(tmp_path / "a.mp4", 40, options=options)
    path.write_bytes(path.read_bytes()[: int(path.stat().st_size * 0.8)])
    with pytest.raises(DamagedFile, match=r"a\.mp4"):
        video_info(path, 40, 10)


@pytest.mark.parametrize("content", [None, b"", b"no video"])
def test_what_is_no_video_is_refused(tmp_path, content):
    path = tmp_path / "a.mp4"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(DamagedFile, match=r"a\.mp4 cannot be"):
        video_info(path, 12, 10)


def test_a_file_without_pictures_is_refused(tmp_path):
    path = tmp_path / "a.mp4"
    with av.open(str(path), "w") as container:
        stream = container.add_stream("aac", rate=8000, layout="mono")
        silence = av.AudioFrame.from_ndarray(np.zeros((1, 1024), np.float32), format="fltp", layout="mono")
        silence.sample_rate = 8000
        container.mux(stream.encode(silence))
        container.mux(stream.encode(None))
    with pytest.raises(DamagedFile, match="no video stream"):
        video_info(path, 12, 10)
