"""An excerpt has the score of the whole video, to the last bit."""

from __future__ import annotations

import numpy as np
import pytest

from tests.recordings import FPS, clip
from vcage.base.videos import decode
from vcage.video.codec import EncoderSettings, encode
from vcage.video.encoders import CODECS
from vcage.video.excerpt import excerpt

FRAMES = clip(47)
SCORED = [0, 13, 17, 38, 46]
CAUSAL = [name for name, codec in CODECS.items() if codec.causal]


def test_groups_with_scored_frames_are_encoded_as_far_as_the_last_of_them():
    part = excerpt(47, SCORED, CODECS["hevc"], [10])
    assert part.frames == (0, *range(10, 18), *range(30, 39), *range(40, 47))
    assert part.starts == {0, 1, 9, 18}
    assert [part.frames[place] for place in part.places(SCORED)] == SCORED


def test_gops_that_are_compared_encode_the_same_frames():
    part = excerpt(100, [35, 61], CODECS["hevc"], [10, 15])
    assert part.frames == (*range(30, 36), *range(60, 62))


@pytest.mark.parametrize("name", sorted(CODECS.keys() - set(CAUSAL)))
def test_an_encoder_that_looks_ahead_gets_the_whole_video(name):
    part = excerpt(47, SCORED, CODECS[name], [10])
    assert part.frames == tuple(range(47))


@pytest.mark.parametrize("gop", [1, 7, 10, 30])
@pytest.mark.parametrize("effort", ["fast", "default", "best"])
@pytest.mark.parametrize("name", CAUSAL)
def test_frames_of_an_excerpt_are_those_of_the_whole_video_bit_for_bit(name, effort, gop):
    settings = EncoderSettings(name, effort=effort, gop=gop)
    part = excerpt(len(FRAMES), SCORED, settings.facts, [gop])
    whole = decode(encode(FRAMES, FPS, settings, 22), list(part.frames))
    assert np.array_equal(decode(part.encoded(FRAMES, FPS, settings, 22)), whole)


@pytest.mark.parametrize("pixel_format", CODECS["hevc"].pixel_formats + CODECS["hevc"].other_formats)
def test_that_holds_in_every_pixel_format_and_at_every_quality(pixel_format):
    settings = EncoderSettings("hevc", pixel_format)
    part = excerpt(len(FRAMES), SCORED, settings.facts, [10])
    for crf in (2, 34):
        whole = decode(encode(FRAMES, FPS, settings, crf), list(part.frames))
        assert np.array_equal(decode(part.encoded(FRAMES, FPS, settings, crf)), whole)
