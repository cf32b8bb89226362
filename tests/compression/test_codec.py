"""What goes into the encoder comes out again: as many frames, in the same colours, from any core count."""

from __future__ import annotations

import os
import subprocess
import sys

import av
import cv2
import numpy as np
import pytest

from tests.recordings import FPS, clip
from vcage.compression.codec import EncoderSettings, encode
from vcage.errors import UsageError
from vcage.videos import decode

SETTINGS = EncoderSettings()


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


def test_one_core_gives_the_same_bytes_as_several(video):
    cores = sorted(os.sched_getaffinity(0))
    code = (
        f"import os, sys; os.sched_setaffinity(0, [{cores[0]}])\n"
        "from tests.recordings import FPS, clip\n"
        "from vcage.compression.codec import EncoderSettings, encode\n"
        "sys.stdout.buffer.write(encode(clip(25), FPS, EncoderSettings(), 4))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    assert done.stdout == video


def test_one_frame_is_a_video_too():
    assert decode(encode(clip(1), FPS, SETTINGS, 10)).shape == (1, 48, 64, 3)


@pytest.mark.parametrize("shape", [(2, 48, 63, 3), (2, 47, 64, 3), (2, 16, 16, 3)])
def test_sizes_that_no_reader_takes_are_refused(shape):
    with pytest.raises(UsageError, match=f"{shape[2]}x{shape[1]}"):
        encode(np.zeros(shape, np.uint8), FPS, SETTINGS, 10)


def test_a_crf_out_of_range_is_refused(frames):
    with pytest.raises(UsageError, match="52"):
        encode(frames, FPS, SETTINGS, 52)
