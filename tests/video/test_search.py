"""The search finds the CRF that trying them all would find, in few trials, and believes nothing unchecked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.recordings import FPS, clip
from vcage.base.errors import UsageError
from vcage.base.videos import decode
from vcage.video import judge
from vcage.video import search as search_module
from vcage.video.choices import LOSSLESS, Choices, Criterion
from vcage.video.codec import EncoderSettings, encode
from vcage.video.encoders import CODECS
from vcage.video.jod import JodMetric
from vcage.video.judge import Judge
from vcage.video.search import held_out_frames, search_clip

MAX_CRF = CODECS["hevc"].max_crf
CHOICES = Choices(effort="fast", pixel_formats=("yuv444p10le",))
SETTINGS = CHOICES.settings("yuv444p10le")
KEYFRAMES = [0, 5, 9]


@pytest.fixture(scope="module")
def metric():
    return JodMetric()


def search(frames, metric, *, choices=CHOICES, keyframes=KEYFRAMES, threshold=0.1, guard=False, reduce="max"):
    return search_clip(Judge(frames, keyframes, FPS, Criterion(threshold, reduce, guard), metric), choices)


@pytest.mark.slow
def test_the_search_agrees_with_trying_every_crf(metric):
    frames = clip(10)
    reference = frames[KEYFRAMES]
    thresholds, losses = (0.02, 0.1, 0.3), []
    while not losses or losses[-1] < max(thresholds):
        video = encode(frames, FPS, SETTINGS, len(losses))
        losses.append(metric.loss(decode(video, KEYFRAMES), reference).max())
    for threshold in thresholds:
        result = search(frames, metric, threshold=threshold)
        first_failure = next(crf for crf, loss in enumerate(losses) if loss >= threshold)
        assert result.crf == first_failure - 1
        assert result.loss_max == pytest.approx(losses[first_failure - 1])


def test_the_video_of_a_result_is_the_judged_one(metric):
    frames = clip(10)
    result = search(frames, metric)
    assert result.video == encode(frames, FPS, result.settings, result.crf)
    assert result.loss_max < 0.1
    whole = next(trial for trial in result.trials if trial.crf == result.crf and trial.frames == len(frames))
    assert whole.bytes == len(result.video)


def test_where_nothing_passes_the_video_is_lossless(metric):
    frames = np.random.default_rng(0).integers(0, 256, (4, 48, 64, 3), np.uint8)
    result = search(frames, metric, keyframes=[0, 3], threshold=1e-5)
    assert result.crf is None
    assert result.loss_max == 0.0
    assert np.array_equal(decode(result.video), frames)
    assert min(trial.crf for trial in result.trials if trial.crf is not None) == 0


def test_h264_without_loss_is_rgb(metric):
    result = search(
        clip(4), metric, keyframes=[0, 3], choices=Choices("h264", "fast", ("yuv444p10le",), upper=LOSSLESS)
    )
    assert (result.crf, result.pixel_format, result.trials[-1].pixel_format) == (None, "rgb24", "rgb24")
    assert np.array_equal(decode(result.video), clip(4))


def test_a_codec_without_a_lossless_form_reports_the_cost_of_colour(metric):
    frames = np.random.default_rng(0).integers(0, 256, (2, 48, 64, 3), np.uint8)
    with pytest.raises(UsageError, match=r"av1 video stays under 0\.001 JOD.*half the size") as caught:
        search(frames, metric, keyframes=[0, 1], threshold=0.001, choices=Choices(codec="av1"))
    assert "--codec hevc" in caught.value.hint


def test_where_the_bound_of_another_clip_passes_nothing_is_searched(metric):
    result = search(clip(10), metric, threshold=5.0, choices=replace(CHOICES, upper=7))
    assert result.crf == 7
    assert [(trial.crf, trial.frames) for trial in result.trials] == [(7, 10)]


def test_a_search_encodes_the_whole_clip_once_and_otherwise_the_scored_frames(metric):
    frames = clip(40)
    result = search(frames, metric, keyframes=[0, 13, 39])
    *searched, whole = result.trials
    assert {trial.frames for trial in searched} == {1 + 4 + 10}
    assert whole.frames == 40
    found = next(trial for trial in searched if trial.crf == result.crf)
    assert (found.loss_max, found.loss_mean) == (whole.loss_max, whole.loss_mean)


def test_no_crf_for_an_earlier_clip_means_lossless_at_once(metric):
    result = search(clip(4), metric, keyframes=[0, 3], choices=replace(CHOICES, upper=LOSSLESS))
    assert result.crf is None and [trial.crf for trial in result.trials] == [None]
    assert np.array_equal(decode(result.video), clip(4))


def flickering(frames: int = 34) -> np.ndarray:
    """Still and grey, but for one held-out frame of noise that no keyframe sees."""
    pictures = np.full((frames, 48, 64, 3), 128, np.uint8)
    pictures[16] = np.random.default_rng(0).integers(0, 256, (48, 64, 3), np.uint8)
    return pictures


def test_the_guard_adds_a_held_out_frame_that_fails_and_searches_again(metric):
    frames = flickering()
    careless = search(frames, metric, keyframes=[0, 33], guard=False)
    guarded = search(frames, metric, keyframes=[0, 33], guard=True)
    assert (careless.held_out.frame, careless.added) == (16, [])
    assert careless.held_out.worst >= 0.1
    assert 16 in guarded.added
    assert guarded.crf < careless.crf
    assert guarded.loss_max < 0.1
    assert metric.loss(decode(guarded.video, [16]), frames[[16]]).max() < 0.1


def test_the_mean_lets_a_single_bad_frame_pass(metric):
    frames = flickering()
    strict = search(frames, metric, keyframes=[0, 16, 33])
    mild = search(frames, metric, keyframes=[0, 16, 33], reduce="mean")
    assert mild.crf > strict.crf
    assert mild.loss_mean < 0.1 <= mild.loss_max


def test_a_longer_gop_is_taken_where_it_passes_with_fewer_bytes(metric):
    still = np.repeat(clip(1), 24, axis=0)
    short = search(still, metric, keyframes=[0, 23])
    free = search(still, metric, keyframes=[0, 23], choices=replace(CHOICES, gops=(10, 120)))
    assert free.settings.gop == 120
    assert free.loss_max < 0.1
    assert len(free.video) < len(short.video)


def test_of_all_pixel_formats_that_with_the_fewest_bytes_is_taken(metric):
    result = search(clip(10), metric, choices=Choices(effort="fast"))
    assert result.loss_max < 0.1
    assert len(result.video) == min(t.bytes for t in result.trials if t.crf == result.crf and t.loss_max < 0.1)


def test_a_pixel_format_whose_conversion_alone_loses_too_much_is_not_tried(metric):
    choices = Choices(effort="fast", pixel_formats=("yuv420p",))
    stripes = np.zeros((3, 48, 64, 3), np.uint8)
    stripes[:, :, ::2, 0] = stripes[:, :, 1::2, 2] = 255
    both = replace(choices, pixel_formats=("yuv420p", "yuv444p10le"))
    assert {t.pixel_format for t in search(stripes, metric, keyframes=[0, 2], choices=both).trials} == {"yuv444p10le"}


def test_a_pixel_format_whose_conversion_alone_loses_too_much_is_not_encoded(metric, monkeypatch):
    encoded = []
    monkeypatch.setattr(judge, "encode", lambda *a, **k: encoded.append(a[2].pixel_format) or encode(*a, **k))
    stripes = np.zeros((3, 48, 64, 3), np.uint8)
    stripes[:, :, ::2, 0] = stripes[:, :, 1::2, 2] = 255
    search(stripes, metric, keyframes=[0, 2], choices=Choices(effort="fast"))
    assert set(encoded) == {"yuv444p10le"}


def test_pictures_of_odd_size_go_into_full_colour(metric):
    result = search(clip(3)[:, :47, :63], metric, keyframes=[0, 2], choices=Choices(effort="fast"))
    assert decode(result.video).shape == (3, 47, 63, 3)


def test_a_size_that_no_format_takes_is_refused(metric):
    with pytest.raises(UsageError, match="8x8"):
        search(clip(3)[:, :8, :8], metric, keyframes=[0, 2], choices=Choices())


def test_a_size_that_does_not_fit_the_only_format_is_refused(metric):
    with pytest.raises(UsageError, match="63x47 do not fit the pixel format yuv420p"):
        search(clip(3)[:, :47, :63], metric, keyframes=[0, 2], choices=Choices(pixel_formats=("yuv420p",)))


# --- with losses that are made up ----------------------------------------------------------------------

FORMATS = BEST, CHEAP = "yuv444p10le", "yuv420p10le"
NO_LOSS = -1
LONG = np.arange(60, dtype=np.uint8)[:, None, None, None] * np.ones((1, 48, 64, 3), np.uint8)
"""Frames that say which they are."""


class Losses:
    """Stands for encoder, decoder and metric: what a frame loses is a function of pixel format, CRF and the frame."""

    def __init__(self, patch: pytest.MonkeyPatch, loss_of, cheap: int = 500):
        self.loss_of, self.sizes = loss_of, {BEST: 1000, CHEAP: cheap}
        self.encoded: list[tuple[str, int, int]] = []
        patch.setattr(judge, "encode", self._encode)
        patch.setattr(judge, "decode", self._decode)
        patch.setattr(judge, "decode_whole", self._decode_whole)
        patch.setattr(search_module, "only_converted", lambda pictures, _name: np.full((len(pictures), 3), NO_LOSS))

    def _encode(self, frames, _fps, settings: EncoderSettings, crf: int, _starts=()) -> bytes:
        self.encoded.append((settings.pixel_format, crf, len(frames)))
        size = self.sizes[settings.pixel_format] - crf
        places = " ".join(str(number) for number in frames[:, 0, 0, 0])
        return f"{settings.pixel_format} {crf} {places}".encode().ljust(size)

    def _decode(self, video: bytes, indices: list[int]) -> np.ndarray:
        name, crf, *places = video.decode().split()
        return np.array([(FORMATS.index(name), int(crf), int(places[index])) for index in indices])

    def _decode_whole(self, video: bytes, indices: list[int]) -> tuple[np.ndarray, int]:
        return self._decode(video, indices), len(video.decode().split()) - 2

    def loss(self, test, _reference) -> np.ndarray:
        return np.array(
            [0.0 if crf == NO_LOSS else self.loss_of(FORMATS[name], crf, frame) for name, crf, frame in test]
        )


def growing(crf: int) -> float:
    """A loss that is 0.1 between 15 and 16."""
    return 0.1 * np.exp(0.17 * (crf - 15.5))


def test_where_held_out_frames_fail_in_a_cheaper_format_the_best_one_gets_its_turn(monkeypatch):
    def loss_of(name: str, crf: int, frame: int) -> float:
        return 1.0 if name == CHEAP and frame not in (0, 59) else growing(crf)

    metric = Losses(monkeypatch, loss_of)
    result = search(LONG, metric, keyframes=[0, 59], guard=True, choices=Choices(pixel_formats=(BEST, CHEAP)))
    assert (result.pixel_format, result.crf) == (BEST, 15)
    assert result.added and result.held_out is None


@pytest.mark.parametrize(("size", "taken"), [(900, CHEAP), (980, BEST)])
def test_a_pixel_format_with_less_colour_must_save_a_twentieth_of_the_bytes(monkeypatch, size, taken):
    metric = Losses(monkeypatch, lambda _name, crf, _frame: growing(crf), cheap=size)
    result = search(LONG, metric, keyframes=[0, 59], choices=Choices(pixel_formats=(BEST, CHEAP)))
    assert (result.pixel_format, result.crf) == (taken, 15)


def test_many_frames_are_first_encoded_alone_and_then_the_worst_in_their_groups(monkeypatch):
    keyframes = list(range(0, 60, 6))

    def loss_of(_name: str, crf: int, frame: int) -> float:
        return growing(crf) * (0.5 + frame / 60)

    metric = Losses(monkeypatch, loss_of)
    result = search(LONG, metric, keyframes=keyframes, choices=Choices(pixel_formats=(BEST,)))
    first, *others, whole = [frames for *_, frames in metric.encoded]
    assert (first, whole) == (len(keyframes), len(LONG))
    assert others and max(others) <= 7 + 9 + 5  # up to the last of 36, 42, 48 and 54 in each group
    assert [trial.gop for trial in result.trials] == [1, *(10 for _ in (*others, whole))]
    assert result.loss_max < 0.1 <= loss_of(BEST, result.crf + 1, keyframes[-1])


def test_a_frame_that_only_turns_out_to_be_the_worst_at_another_crf_is_seen_in_the_whole(monkeypatch):
    def loss_of(_name: str, crf: int, frame: int) -> float:
        return growing(crf) * (1 + frame / 600 if crf >= 16 else 2.0 if frame == 0 else 1)

    metric = Losses(monkeypatch, loss_of)
    result = search(LONG, metric, keyframes=list(range(0, 60, 6)), choices=Choices(pixel_formats=(BEST,)))
    assert result.crf is not None
    assert max(loss_of(BEST, result.crf, frame) for frame in range(0, 60, 6)) == pytest.approx(result.loss_max)
    assert result.loss_max < 0.1


@pytest.mark.parametrize("factor", [1.1, 1.5, 3.0])
def test_a_finding_of_the_guard_costs_one_more_whole_encoding(monkeypatch, factor):
    def loss_of(_name: str, crf: int, frame: int) -> float:
        return growing(crf) * (1 if frame in (0, 59) else factor)

    metric = Losses(monkeypatch, loss_of)
    result = search(LONG, metric, keyframes=[0, 59], guard=True, choices=Choices(pixel_formats=(BEST,)))
    assert result.added and result.loss_max < 0.1 <= growing(result.crf + 1) * factor
    assert sum(frames == len(LONG) for *_, frames in metric.encoded) == 2


BOUND = Choices(pixel_formats=(BEST,), upper=20)
"""The CRF of an earlier clip."""


@pytest.mark.parametrize("keyframes", [[0, 30, 59], list(range(0, 60, 3))])
def test_a_clip_that_fails_at_its_bound_is_searched_below_and_encoded_whole_twice(monkeypatch, keyframes):
    metric = Losses(monkeypatch, lambda _name, crf, frame: growing(crf) * (1 + frame / 6000))
    result = search(LONG, metric, keyframes=keyframes, guard=True, choices=BOUND)
    assert (result.crf, result.pixel_format) == (15, BEST)
    assert [crf for _, crf, frames in metric.encoded if frames == len(LONG)] == [20, 15]
    assert all(frames <= 5 * 10 for _, _, frames in metric.encoded[1:-1])
    assert result.added == [] and result.held_out is not None


def test_a_clip_that_fails_at_its_bound_on_held_out_frames_alone_gets_a_lower_crf(monkeypatch):
    metric = Losses(monkeypatch, lambda _name, crf, frame: growing(crf) if frame % 59 else 0.01)
    result = search(LONG, metric, keyframes=[0, 59], guard=True, choices=BOUND)
    assert result.crf == 15 and result.added


def test_a_clip_that_passes_at_nothing_below_its_bound_is_without_loss(metric):
    frames = np.random.default_rng(0).integers(0, 256, (4, 48, 64, 3), np.uint8)
    result = search(frames, metric, keyframes=[0, 3], threshold=1e-5, choices=BOUND)
    assert (result.crf, result.pixel_format) == (None, "gbrp")
    assert np.array_equal(decode(result.video), frames)


def test_a_fixed_crf_is_encoded_once_at_any_loss(metric):
    result = search(clip(10), metric, threshold=float("inf"), choices=replace(CHOICES, upper=40))
    assert (result.crf, len(result.trials)) == (40, 1)
    assert result.settings == EncoderSettings(effort="fast")


# --- frames that no search has seen ---


def test_one_of_every_ten_frames_is_held_out_unless_it_was_scored():
    assert held_out_frames(40, [16]) == [3, 29, 32]


def test_even_a_short_clip_has_held_out_frames_that_are_no_keyframes():
    assert held_out_frames(13, [0, 12]) == [3, 10]
    assert held_out_frames(1, [0]) == []


def test_held_out_frames_do_not_keep_step_with_any_gop():
    places = held_out_frames(100, [])
    assert sorted(place % 10 for place in places) == list(range(10))
