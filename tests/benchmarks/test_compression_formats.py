"""Formats of the compression benchmark on a small clip: LeRobot's own, and the searched ones."""

from __future__ import annotations

from pathlib import Path

import av
import pytest

from benchmarks._compression_clips import Film
from benchmarks._compression_formats import LEROBOT, LIMIT, PNG, Found, Made, Searched, formats
from tests.recordings import FPS, clip
from vcage.video.choices import Choices
from vcage.video.jod import JodMetric
from vcage.video.search import held_out_frames

KEYFRAMES = [0, 5, 11]
FILM = Film(clip(12), FPS, KEYFRAMES, held_out_frames(12, KEYFRAMES))
HEVC = Choices("hevc", pixel_formats=("yuv444p10le",), gops=(4,))


@pytest.fixture(scope="module")
def metric() -> JodMetric:
    return JodMetric()


def loss(made: Made, metric: JodMetric) -> float:
    return float(metric.loss(made.stored.read(KEYFRAMES), FILM.frames[KEYFRAMES]).max())


@pytest.mark.parametrize("quick", [True, False])
def test_every_format_comes_after_its_dependencies(quick: bool) -> None:
    seen: set[str | None] = {None}
    for form in formats(quick):
        assert not isinstance(form, Searched) or {form.like, form.after} <= seen
        assert form.name not in seen
        seen.add(form.name)


def test_ours_come_with_gops_of_two_ten_and_the_default() -> None:
    names = {form.name for form in formats(quick=False)}
    assert {"vcage-g2", "vcage-g10", "vcage-g250", "vcage-g2-as-lerobot"} <= names


def test_av1_and_another_codec_are_searched_too() -> None:
    assert any(form.name == "av1-g10" for form in formats(quick=True))
    assert sum(isinstance(form, Searched) for form in formats(quick=True)) >= 4


def test_png_loses_nothing(tmp_path: Path, metric: JodMetric) -> None:
    assert loss(PNG.make(FILM, metric, tmp_path, {}), metric) == 0


def test_lerobots_video_is_av1_with_every_other_frame_a_keyframe(tmp_path: Path, metric: JodMetric) -> None:
    made = LEROBOT.make(FILM, metric, tmp_path, {})
    with av.open(str(made.stored.path)) as container:
        stream = container.streams.video[0]
        assert (stream.codec_context.name, stream.pix_fmt, stream.frames) == ("libdav1d", "yuv420p", 12)
        packets = [packet for packet in container.demux(stream) if packet.size]
    assert sum(packet.is_keyframe for packet in packets) == 6


def test_a_searched_video_stays_below_the_limit_with_its_gop(tmp_path: Path, metric: JodMetric) -> None:
    made = Searched("hevc", HEVC).make(FILM, metric, tmp_path, {})
    assert loss(made, metric) < LIMIT == made.limit
    assert made.gop == 4 and 1 <= made.encodes <= 8
    assert 0 < made.encode_ms < made.search_ms


def test_a_video_that_may_lose_as_much_as_another_is_smaller(tmp_path: Path, metric: JodMetric) -> None:
    found = {"other": Found(0.5, 30, "yuv420p")}
    strict = Searched("strict", HEVC).make(FILM, metric, tmp_path, {})
    lax = Searched("lax", HEVC, like="other").make(FILM, metric, tmp_path, found)
    assert lax.limit == 0.5
    assert lax.stored.bytes < strict.stored.bytes


def test_another_gop_begins_where_the_first_ended(tmp_path: Path, metric: JodMetric) -> None:
    found = {"first": Found(0.05, 12, "yuv444p")}
    choices = Choices("hevc", gops=(2,))
    made = Searched("second", choices, after="first").make(FILM, metric, tmp_path, found)
    assert made.pixel_format == "yuv444p" and made.gop == 2
    assert made.crf is not None and made.crf <= 15


def test_another_gop_starts_over_where_the_first_had_to_be_lossless(tmp_path: Path, metric: JodMetric) -> None:
    made = Searched("second", HEVC, after="first").make(FILM, metric, tmp_path, {"first": Found(0.0, None, "gbrp")})
    assert made.pixel_format == "yuv444p10le" and made.crf is not None


def test_a_codec_without_a_lossless_form_is_searched_for_its_best_quality(tmp_path: Path, metric: JodMetric) -> None:
    made = Searched("av1", Choices("av1", gops=(4,))).make(FILM, metric, tmp_path, {})
    assert made.limit is not None and made.limit >= LIMIT
    assert loss(made, metric) < made.limit
