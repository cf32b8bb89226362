from __future__ import annotations

import pytest

from vcage.base.errors import UnknownName, UsageError
from vcage.datasets.packing.settings import CompressionSettings
from vcage.video.choices import LOSSLESS


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"codec": "vp9"}, "codec 'vp9'"),
        ({"effort": "hasty"}, "effort 'hasty'"),
        ({"pixel_format": "yuv999p"}, "pixel format of hevc 'yuv999p'"),
        ({"codec": "av1", "pixel_format": "yuv444p"}, "pixel format of av1"),
    ],
)
def test_a_name_unknown_to_the_codec_is_refused_beside_the_known_ones(changes, named):
    with pytest.raises(UnknownName, match=named):
        CompressionSettings(**changes)


@pytest.mark.parametrize(
    "changes",
    [
        {"crf": 52},
        {"crf": -2},
        {"codec": "av1", "crf": 64},
        {"codec": "av1", "crf": LOSSLESS},
        {"max_loss": 0.0},
        {"max_loss": -1},
        {"gop": 0},
    ],
)
def test_a_number_out_of_range_is_refused(changes):
    with pytest.raises(UsageError):
        CompressionSettings(**changes)


def test_open_options_are_left_to_the_search():
    choices = CompressionSettings(gop="auto").choices()
    assert (choices.pixel_formats, choices.gops, choices.upper) == ((), CompressionSettings.GOPS, None)


def test_a_pixel_format_that_is_given_is_the_only_choice():
    assert CompressionSettings(pixel_format="yuv420p").choices().pixel_formats == ("yuv420p",)


@pytest.mark.parametrize("crf", [0, 18, LOSSLESS])
def test_a_crf_that_is_given_leaves_nothing_to_search_and_always_passes(crf):
    settings = CompressionSettings(crf=crf, gop="auto")
    choices = settings.choices()
    assert (len(choices.pixel_formats), len(choices.gops), choices.upper) == (1, 1, crf)
    assert settings.criterion().threshold == float("inf") and not settings.criterion().guard
