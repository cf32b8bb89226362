"""The search finds the CRF that trying them all would find, in few trials, and believes nothing unchecked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.recordings import FPS, clip
from vcage.compression.bisection import BUDGET
from vcage.compression.choices import Choices, Criterion
from vcage.compression.codec import EncoderSettings, encode
from vcage.compression.encoders import CODECS
from vcage.compression.jod import JodMetric
from vcage.compression.search import held_out_frames, search_clip
from vcage.errors import UsageError
from vcage.videos import decode

MAX_CRF = CODECS["hevc"].max_crf
CHOICES = Choices(preset="ultrafast", pixel_formats=("yuv444p10le",))
SETTINGS = CHOICES.settings("yuv444p10le")
KEYFRAMES = [0, 5, 9]


@pytest.fixture(scope="module")
def metric():
    return JodMetric()


def search(frames, metric, *, choices=CHOICES, keyframes=KEYFRAMES, threshold=0.1, guard=False, reduce="max"):
    return search_clip(frames, keyframes, FPS, choices, Criterion(threshold, reduce, guard), metric)


@pytest.mark.slow
def test_the_search_agrees_with_trying_every_crf(metric):
    frames = clip(10)
    reference = frames[KEYFRAMES]
    losses = [
        metric.loss(decode(encode(frames, FPS, SETTINGS, crf), KEYFRAMES), reference).max()
        for crf in range(MAX_CRF + 1)
    ]
    for threshold in (0.02, 0.1, 0.3):
        result = search(frames, metric, threshold=threshold)
        first_failure = next(crf for crf, loss in enumerate(losses) if loss >= threshold)
        assert result.crf == first_failure - 1
        assert result.loss_max == pytest.approx(losses[first_failure - 1])


def test_the_video_of_a_result_is_the_one_that_was_judged(metric):
    frames = clip(10)
    result = search(frames, metric)
    assert result.video == encode(frames, FPS, result.settings, result.crf)
    assert result.loss_max < 0.1
    assert next(t for t in result.trials if t.crf == result.crf).bytes == len(result.video)


def test_where_nothing_passes_the_video_is_lossless(metric):
    frames = np.random.default_rng(0).integers(0, 256, (4, 48, 64, 3), np.uint8)
    result = search(frames, metric, keyframes=[0, 3], threshold=1e-5)
    assert result.crf is None
    assert result.loss_max == 0.0
    assert np.array_equal(decode(result.video), frames)
    assert min(trial.crf for trial in result.trials if trial.crf is not None) == 0


def test_a_codec_without_a_lossless_form_says_what_its_colour_costs(metric):
    frames = np.random.default_rng(0).integers(0, 256, (2, 48, 64, 3), np.uint8)
    with pytest.raises(UsageError, match=r"av1 video stays under 0\.001 JOD.*half the size") as caught:
        search(frames, metric, keyframes=[0, 1], threshold=0.001, choices=Choices(codec="av1"))
    assert "--codec hevc" in caught.value.hint


def test_a_bound_of_an_earlier_clip_is_tried_first_and_kept(metric):
    result = search(clip(10), metric, threshold=5.0, choices=CHOICES.fixed(SETTINGS, 7))
    assert result.crf == 7
    assert [trial.crf for trial in result.trials] == [7]


def test_no_crf_for_an_earlier_clip_means_lossless_at_once(metric):
    result = search(clip(4), metric, keyframes=[0, 3], choices=CHOICES.fixed(SETTINGS, -1))
    assert result.crf is None and [trial.crf for trial in result.trials] == [None]
    assert np.array_equal(decode(result.video), clip(4))


def test_one_of_every_ten_frames_is_held_out_unless_it_was_scored():
    assert held_out_frames(40, [13]) == [0, 26, 39]


def test_held_out_frames_do_not_keep_step_with_any_gop():
    places = held_out_frames(100, [])
    assert sorted(place % 10 for place in places) == list(range(10))


def flickering(frames: int = 34) -> np.ndarray:
    """Still and grey, but for one held-out frame of noise that no keyframe sees."""
    pictures = np.full((frames, 48, 64, 3), 128, np.uint8)
    pictures[13] = np.random.default_rng(0).integers(0, 256, (48, 64, 3), np.uint8)
    return pictures


def test_the_guard_adds_a_held_out_frame_that_fails_and_searches_again(metric):
    frames = flickering()
    careless = search(frames, metric, keyframes=[0, 33], guard=False)
    guarded = search(frames, metric, keyframes=[0, 33], guard=True)
    assert (careless.held_out.frame, careless.added) == (13, [])
    assert careless.held_out.worst >= 0.1
    assert 13 in guarded.added
    assert guarded.crf < careless.crf
    assert guarded.loss_max < 0.1
    assert metric.loss(decode(guarded.video, [13]), frames[[13]]).max() < 0.1


def test_the_mean_lets_a_single_bad_frame_pass(metric):
    frames = flickering()
    strict = search(frames, metric, keyframes=[0, 13, 33])
    mild = search(frames, metric, keyframes=[0, 13, 33], reduce="mean")
    assert mild.crf > strict.crf
    assert mild.loss_mean < 0.1 <= mild.loss_max


def test_a_longer_gop_is_taken_where_it_passes_with_fewer_bytes(metric):
    still = np.repeat(clip(1), 24, axis=0)
    short = search(still, metric, keyframes=[0, 23])
    free = search(still, metric, keyframes=[0, 23], choices=replace(CHOICES, gops=(10, 120)))
    assert free.settings.gop == 120
    assert free.loss_max < 0.1
    assert len(free.video) < len(short.video)


def test_of_all_pixel_formats_one_is_found_that_passes_within_the_budget(metric):
    result = search(clip(10), metric, choices=Choices(preset="ultrafast"))
    assert result.loss_max < 0.1
    assert len(result.trials) <= BUDGET
    assert len(result.video) == min(t.bytes for t in result.trials if t.crf == result.crf and t.loss_max < 0.1)


def test_a_pixel_format_whose_conversion_alone_loses_too_much_is_not_tried(metric):
    choices = Choices(preset="ultrafast", pixel_formats=("yuv420p",))
    stripes = np.zeros((3, 48, 64, 3), np.uint8)
    stripes[:, :, ::2, 0] = stripes[:, :, 1::2, 2] = 255
    both = replace(choices, pixel_formats=("yuv420p", "yuv444p10le"))
    assert {t.pixel_format for t in search(stripes, metric, keyframes=[0, 2], choices=both).trials} == {"yuv444p10le"}


def test_pictures_of_odd_size_go_into_full_colour(metric):
    result = search(clip(3)[:, :47, :63], metric, keyframes=[0, 2], choices=Choices(preset="ultrafast"))
    assert decode(result.video).shape == (3, 47, 63, 3)


def test_a_size_that_no_format_takes_is_refused(metric):
    with pytest.raises(UsageError, match="8x8"):
        search(clip(3)[:, :8, :8], metric, keyframes=[0, 2], choices=Choices())


def test_a_fixed_crf_is_encoded_once_whatever_it_loses(metric):
    result = search(clip(10), metric, threshold=float("inf"), choices=replace(CHOICES, upper=40))
    assert (result.crf, len(result.trials)) == (40, 1)
    assert result.settings == EncoderSettings(preset="ultrafast")
