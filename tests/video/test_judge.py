"""The judge encodes no more than it must, and scores no pair of pictures twice; the losses are those of the whole."""

from __future__ import annotations

import numpy as np
import pytest

from tests.recordings import FPS, clip
from vcage.base.errors import DamagedFile
from vcage.base.videos import decode
from vcage.video.choices import Criterion
from vcage.video.codec import EncoderSettings, encode
from vcage.video.encoders import CODECS
from vcage.video.judge import Judge, KnownLosses, excerpt

FRAMES = clip(47)
SCORED = [0, 13, 17, 38, 46]
CAUSAL = [name for name, codec in CODECS.items() if codec.causal]


def test_groups_with_scored_frames_are_encoded_as_far_as_the_last_of_them():
    part = excerpt(47, SCORED, CODECS["hevc"], [10])
    assert part.frames == (0, *range(10, 18), *range(30, 39), *range(40, 47))
    assert part.starts == {0, 1, 9, 18}
    assert set(SCORED) <= set(part.frames)


def test_compared_gops_encode_the_same_frames():
    part = excerpt(100, [35, 61], CODECS["hevc"], [10, 15])
    assert part.frames == (*range(30, 36), *range(60, 62))


@pytest.mark.parametrize("name", sorted(CODECS.keys() - set(CAUSAL)))
def test_an_encoder_that_looks_ahead_gets_the_whole_video(name):
    part = excerpt(47, SCORED, CODECS[name], [10])
    assert part.frames == tuple(range(47))


@pytest.mark.parametrize("gop", [1, 7, 10, 30])
@pytest.mark.parametrize("effort", ["fast", "default", "best"])
@pytest.mark.parametrize("name", CAUSAL)
def test_frames_of_an_excerpt_match_the_whole_video_bit_for_bit(name, effort, gop):
    settings = EncoderSettings(name, effort=effort, gop=gop)
    part = excerpt(len(FRAMES), SCORED, settings.facts, [gop])
    whole = decode(encode(FRAMES, FPS, settings, 22), list(part.frames))
    assert np.array_equal(decode(encode(FRAMES[list(part.frames)], FPS, settings, 22, part.starts)), whole)


@pytest.mark.parametrize("pixel_format", CODECS["hevc"].pixel_formats + CODECS["hevc"].other_formats)
def test_that_holds_in_every_pixel_format_and_at_every_quality(pixel_format):
    settings = EncoderSettings("hevc", pixel_format)
    part = excerpt(len(FRAMES), SCORED, settings.facts, [10])
    for crf in (2, 34):
        whole = decode(encode(FRAMES, FPS, settings, crf), list(part.frames))
        assert np.array_equal(decode(encode(FRAMES[list(part.frames)], FPS, settings, crf, part.starts)), whole)


# --- losses that are known ---

PICTURES = clip(6)


class Counting:
    """A metric whose losses are differences, and its questions."""

    def __init__(self):
        self.asked: list[int] = []

    def loss(self, test, reference):
        self.asked.append(len(test))
        return np.abs(test.astype(float) - reference).mean(axis=(1, 2, 3))


def test_losses_match_the_metric():
    worse = PICTURES // 2
    assert KnownLosses(Counting()).loss(worse, PICTURES).tolist() == Counting().loss(worse, PICTURES).tolist()


def test_a_judged_video_is_not_judged_again():
    metric, worse = Counting(), PICTURES // 2
    known = KnownLosses(metric)
    known.loss(worse[:4], PICTURES[:4])
    known.loss(worse[2:6], PICTURES[2:6])
    assert metric.asked == [4, 2]


def test_equal_pairs_are_judged_once():
    metric, still = Counting(), np.repeat(PICTURES[:1], 3, axis=0)
    assert len(set(KnownLosses(metric).loss(still // 2, still))) == 1
    assert metric.asked == [1]


@pytest.mark.parametrize("changed", [0, 1])
def test_a_pair_with_another_picture_is_judged_again(changed):
    metric = Counting()
    known = KnownLosses(metric)
    pair = [PICTURES[:1], PICTURES[:1]]
    known.loss(*pair)
    pair[changed] = pair[changed] ^ np.uint8(1)
    known.loss(*pair)
    assert metric.asked == [1, 1]


@pytest.mark.parametrize("frames", [0, 3])
def test_a_whole_video_that_lacks_frames_is_refused(frames):
    judge = Judge(PICTURES, [0, 2], 10.0, Criterion(), Counting())
    short = encode(PICTURES[:-1], 10.0, EncoderSettings(), 20)
    with pytest.raises(DamagedFile, match=f"holds {len(PICTURES) - 1} of {len(PICTURES)} frames"):
        judge.losses(short, range(frames))
