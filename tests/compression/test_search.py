"""The search finds the CRF that trying them all would find, in few trials."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.recordings import FPS, clip
from vcage.compression.codec import MAX_CRF, EncoderSettings, encode
from vcage.compression.jod import JodMetric
from vcage.compression.search import BUDGET, highest_passing, search_clip
from vcage.videos import decode

SETTINGS = EncoderSettings(preset="ultrafast")
KEYFRAMES = [0, 5, 9]


@pytest.fixture(scope="module")
def metric():
    return JodMetric()


@given(
    losses=st.lists(st.floats(1e-7, 2), min_size=MAX_CRF + 1, max_size=MAX_CRF + 1).map(sorted),
    threshold=st.floats(0.01, 1),
    upper=st.integers(-1, MAX_CRF),
    first=st.integers(0, MAX_CRF),
)
def test_any_growing_loss_is_searched_exactly_within_the_budget(losses, threshold, upper, first):
    tried = []

    def loss_at(crf: int) -> float:
        tried.append(crf)
        return losses[crf]

    found = highest_passing(loss_at, threshold, upper=upper, first=first)
    passing = [crf for crf in range(upper + 1) if losses[crf] < threshold]
    assert found == (max(passing) if passing else None)
    assert len(tried) <= BUDGET
    assert len(set(tried)) == len(tried)


def test_a_loss_that_grows_as_usual_takes_few_trials():
    tried = []

    def loss_at(crf: int) -> float:
        tried.append(crf)
        return 0.1 * np.exp(0.16 * (crf - 15.5))

    assert highest_passing(loss_at, 0.1) == 15
    assert len(tried) <= 4


@pytest.mark.slow
def test_the_search_agrees_with_trying_every_crf(metric):
    frames = clip(10)
    reference = frames[KEYFRAMES]
    losses = [
        metric.loss(decode(encode(frames, FPS, SETTINGS, crf), KEYFRAMES), reference).max()
        for crf in range(MAX_CRF + 1)
    ]
    for threshold in (0.02, 0.1, 0.3):
        result = search_clip(frames, KEYFRAMES, FPS, SETTINGS, metric, threshold=threshold)
        first_failure = next(crf for crf, loss in enumerate(losses) if loss >= threshold)
        assert result.crf == first_failure - 1
        assert result.loss_max == pytest.approx(losses[first_failure - 1])


def test_the_video_of_a_result_is_the_one_that_was_judged(metric):
    frames = clip(10)
    result = search_clip(frames, KEYFRAMES, FPS, SETTINGS, metric, threshold=0.1)
    assert result.video == encode(frames, FPS, SETTINGS, result.crf)
    assert result.loss_max < 0.1
    assert next(t for t in result.trials if t.crf == result.crf).bytes == len(result.video)


def test_where_nothing_passes_the_video_is_lossless(metric):
    frames = np.random.default_rng(0).integers(0, 256, (4, 48, 64, 3), np.uint8)
    result = search_clip(frames, [0, 3], FPS, SETTINGS, metric, threshold=1e-5)
    assert result.crf is None
    assert result.loss_max == 0.0
    assert np.array_equal(decode(result.video), frames)
    assert min(trial.crf for trial in result.trials) == 0


def test_a_bound_of_an_earlier_clip_is_tried_first_and_kept(metric):
    result = search_clip(clip(10), KEYFRAMES, FPS, SETTINGS, metric, threshold=5.0, upper=7)
    assert result.crf == 7
    assert [trial.crf for trial in result.trials] == [7]


def test_no_crf_for_an_earlier_clip_means_lossless_at_once(metric):
    result = search_clip(clip(4), [0, 3], FPS, SETTINGS, metric, threshold=0.1, upper=-1)
    assert result.crf is None and result.trials == []
    assert np.array_equal(decode(result.video), clip(4))
