"""Encoded frames come back: as many, in the same colours, from any core count."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import av
import cv2
import numpy as np
import pytest

from tests.recordings import FPS, clip
from vcage.base.errors import MissingDependency, UsageError
from vcage.base.videos import decode
from vcage.video.codec import EncoderSettings, encode, only_converted
from vcage.video.encoders import CODECS, encoder_version, kept_priority

SETTINGS = EncoderSettings()
FORMATS = CODECS["hevc"].pixel_formats + CODECS["hevc"].other_formats


@pytest.fixture(scope="module")
def frames():
    return clip(25)


@pytest.fixture(scope="module")
def video(frames):
    return encode(frames, FPS, SETTINGS, 4)


def test_as_many_frames_come_out_as_went_in_in_their_order(frames, video):
    decoded = decode(video)
    assert decoded.shape == frames.shape
    assert np.abs(decoded.astype(int) - frames).mean() < 1.5


def test_a_seek_gives_the_same_frame_as_decoding_from_the_start(video, tmp_path):
    path = tmp_path / "video.mp4"
    path.write_bytes(video)
    linear = decode(path)
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        for wanted in (3, 10, 17, 23):
            container.seek(round(wanted / FPS / stream.time_base), stream=stream)
            frame = next(f for f in container.decode(video=0) if round(f.time * FPS) == wanted)
            assert np.array_equal(frame.to_ndarray(format="rgb24"), linear[wanted])


@pytest.mark.parametrize("pixel_format", ["yuv420p", "yuv444p", "yuv420p10le", "yuv444p10le", "gbrp"])
@pytest.mark.parametrize("colour", [(220, 30, 40), (30, 200, 60), (20, 40, 210)])
def test_colours_stay_in_every_pixel_format(pixel_format, colour):
    patch = np.full((3, 32, 32, 3), colour, np.uint8)
    decoded = decode(encode(patch, FPS, EncoderSettings(pixel_format=pixel_format), 8))
    assert np.abs(decoded.astype(int) - colour).max() <= 4


def test_a_reader_that_ignores_the_colour_tags_sees_the_same_colours(tmp_path):
    path = tmp_path / "red.mp4"
    path.write_bytes(encode(np.full((3, 64, 64, 3), (220, 30, 40), np.uint8), FPS, SETTINGS, 8))
    found, picture = cv2.VideoCapture(str(path)).read()
    assert found
    assert np.abs(picture[..., ::-1].astype(int) - (220, 30, 40)).max() <= 4


def test_the_file_says_its_rate_matrix_and_range(video, tmp_path):
    path = tmp_path / "video.mp4"
    path.write_bytes(video)
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        assert float(stream.average_rate) == FPS
        assert (stream.codec_context.pix_fmt, stream.codec_context.color_range) == ("yuv444p10le", 1)
        assert stream.codec_context.colorspace == 6


def test_lossless_is_bit_exact():
    noise = np.random.default_rng(0).integers(0, 256, (5, 48, 64, 3), np.uint8)
    assert np.array_equal(decode(encode(noise, FPS, SETTINGS, None)), noise)


def test_a_higher_crf_takes_fewer_bytes(frames, video):
    assert len(encode(frames, FPS, SETTINGS, 30)) < len(video)


@pytest.mark.slow
@pytest.mark.parametrize("codec", CODECS)
def test_one_core_gives_the_same_bytes_as_several(codec):
    cores = sorted(os.sched_getaffinity(0))
    code = (
        f"import os, sys; os.sched_setaffinity(0, [{cores[0]}])\n"
        "from tests.recordings import FPS, clip\n"
        "from vcage.video.codec import EncoderSettings, encode\n"
        f"sys.stdout.buffer.write(encode(clip(25), FPS, EncoderSettings({codec!r}), 4))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    assert done.stdout == encode(clip(25), FPS, EncoderSettings(codec), 4)


def test_one_frame_is_a_video_too():
    assert decode(encode(clip(1), FPS, SETTINGS, 10)).shape == (1, 48, 64, 3)


@pytest.mark.parametrize("size", [(47, 63), (17, 33), (16, 16)])
@pytest.mark.parametrize("crf", [4, None])
def test_odd_sizes_are_kept_in_full_colour(size, crf):
    frames = clip(3)[:, : size[0], : size[1]]
    assert decode(encode(frames, FPS, SETTINGS, crf)).shape == frames.shape


def test_an_odd_size_with_halved_colour_is_refused_with_a_fitting_one():
    with pytest.raises(UsageError, match="63x48") as caught:
        encode(np.zeros((2, 48, 63, 3), np.uint8), FPS, EncoderSettings(pixel_format="yuv420p"), 10)
    assert "yuv444p10le" in caught.value.hint


@pytest.mark.parametrize(("codec", "size"), [("hevc", (8, 64)), ("av1", (48, 63))])
def test_sizes_that_an_encoder_does_not_take_are_refused(codec, size):
    with pytest.raises(UsageError, match=f"{size[1]}x{size[0]}.*{codec}"):
        encode(np.zeros((2, *size, 3), np.uint8), FPS, EncoderSettings(codec), 10)


@pytest.mark.parametrize("codec", ["h264", "av1"])
def test_other_codecs_give_the_frames_back_too(codec, frames):
    decoded = decode(encode(frames, FPS, EncoderSettings(codec), 8))
    assert decoded.shape == frames.shape
    assert np.abs(decoded.astype(int) - frames).mean() < (2 if codec == "h264" else 8)  # half of the colour is left


def test_h264_has_a_lossless_form_and_av1_says_that_it_has_none(frames):
    assert np.array_equal(decode(encode(frames, FPS, EncoderSettings("h264"), None)), frames)
    with pytest.raises(UsageError, match="av1 has no lossless form"):
        encode(frames, FPS, EncoderSettings("av1"), None)


def test_the_conversion_alone_is_the_base_the_codec_adds_its_loss_to(frames):
    error = {name: np.abs(only_converted(frames[:2], name).astype(int) - frames[:2]).mean() for name in FORMATS}
    assert error["gbrp"] == error["yuv444p10le"] == 0
    assert 0 < error["yuv444p"] < error["yuv420p"]


def test_the_conversion_alone_matches_a_decoder(frames):
    almost = decode(encode(frames[:2], FPS, EncoderSettings(pixel_format="yuv420p"), 0))
    assert np.abs(almost.astype(int) - only_converted(frames[:2], "yuv420p")).mean() < 1


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"codec": "vp9"}, "unknown codec 'vp9'"),
        ({"pixel_format": "yuv410p"}, "unknown pixel format of hevc"),
        ({"effort": "swift"}, "unknown effort"),
        ({"gop": 0}, "gop is 0"),
    ],
)
def test_settings_that_no_encoder_knows_are_refused(wrong, message):
    with pytest.raises(UsageError, match=message):
        EncoderSettings(**wrong)


def test_a_codec_missing_from_the_build_is_reported_before_anything_is_written(frames, monkeypatch):
    monkeypatch.setattr(av, "codecs_available", {"libx264"})
    with pytest.raises(MissingDependency, match="libx265"):
        encode(frames, FPS, SETTINGS, 10)


def test_the_version_of_an_encoder_matches_its_streams():
    assert re.match(r"\d+\.\d+.*, libavcodec \d+", encoder_version("hevc"))
    assert encoder_version("h264").startswith("core ")


def test_a_crf_out_of_range_is_refused(frames):
    with pytest.raises(UsageError, match="52"):
        encode(frames, FPS, SETTINGS, 52)


def test_no_encoder_keeps_this_process_at_real_time_priority():
    before = scheduling()
    encode(clip(2), FPS, EncoderSettings("av1", effort="fast"), 40)
    assert scheduling() == before


def test_an_encoder_that_fails_to_open_leaves_the_scheduling_unchanged():
    before = scheduling()
    with pytest.raises(av.FFmpegError), kept_priority():
        os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
        raise av.ExternalError(0, "it does not open")
    assert scheduling() == before


def scheduling() -> set[int]:
    """Policies of the threads of this process."""
    return {os.sched_getscheduler(int(thread.name)) for thread in Path("/proc/self/task").glob("*")}
