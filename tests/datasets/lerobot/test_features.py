"""When another episode agrees with what a data set says of itself."""

from __future__ import annotations

import copy

import pytest

from vcage.base.errors import UsageError
from vcage.datasets.lerobot.features import ENCODER, admit

KEY = "observation.images.cam_high"


@pytest.fixture
def info() -> dict:
    return {
        "total_episodes": 3,
        "fps": 10,
        "robot_type": "arm",
        "features": {
            "action": {"dtype": "float32", "shape": [2], "names": ["x", "y"]},
            KEY: {
                "dtype": "video",
                "shape": [48, 64, 3],
                "names": ["height", "width", "channels"],
                "info": {"video.codec": "hevc", "video.crf": 18},
            },
            "index": {"dtype": "int64", "shape": [1], "names": None},
            "subtask_index": {"dtype": "int64", "shape": [1], "names": None},
        },
    }


def changed(info: dict, *path: str, to) -> dict:
    """A copy with the entry at ``path`` replaced, or left out where ``to`` is Ellipsis."""
    whole = copy.deepcopy(info)
    inner = whole
    for name in path[:-1]:
        inner = inner[name]
    if to is ...:
        del inner[path[-1]]
    else:
        inner[path[-1]] = to
    return whole


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("fps",), 10.0),
        (("robot_type",), None),
        (("robot_type",), ...),
        (("features", "action", "names"), None),
        (("features", "action", "names"), {"motors": ["x", "y"]}),
        (("features", "action", "names"), {"x": 0, "y": 1}),
        (("features", KEY, "names"), ["height", "width", "channel"]),
        (("features", KEY, "info", "video.crf"), ...),
        (("features", "subtask_index"), ...),
    ],
)
def test_what_a_data_set_leaves_open_or_says_in_other_words_agrees(info, path, value):
    admit(3, info, changed(info, *path, to=value))


@pytest.mark.parametrize(
    ("path", "value", "what"),
    [
        (("fps",), 12.5, "frame rate"),
        (("robot_type",), "aloha", "robot"),
        (("features", "action", "names"), ["y", "x"], "names of action"),
        (("features", "action", "shape"), [3], "size of action"),
        (("features", "action", "dtype"), "float64", "type of action"),
        (("features", "action"), ..., "columns"),
        (("features", "next.reward"), {"dtype": "float32", "shape": [1], "names": None}, "columns"),
        (("features", KEY), ..., "cameras"),
        (("features", KEY, "shape"), [96, 64, 3], f"size of {KEY}"),
        (("features", KEY, "info", "video.codec"), "av1", f"video.codec of {KEY}"),
    ],
)
def test_what_differs_is_named(info, path, value, what):
    with pytest.raises(UsageError, match="episode 3 has other") as caught:
        admit(3, info, changed(info, *path, to=value))
    assert caught.value.details == {"episode": 3, "what": what}


@pytest.mark.parametrize("fact", ENCODER)
@pytest.mark.parametrize("name", ["info", "video_info"])
def test_where_videos_were_compressed_by_different_degrees_the_data_set_stops_telling(info, fact, name):
    described = changed(info, "features", KEY, "info", fact, to="this")
    feature = {"dtype": "video", "shape": [48, 64, 3], name: {"video.codec": "hevc", fact: "that"}}
    data_set = changed(info, "features", KEY, to=feature)
    admit(3, described, data_set)
    assert data_set["features"][KEY][name] == {"video.codec": "hevc"}


def test_the_videos_of_a_data_set_that_is_begun_are_compressed_alike(info):
    begun = changed(info, "total_episodes", to=...)
    with pytest.raises(UsageError, match=r"other video\.crf.*\(18\).*\(20\)"):
        admit(3, info, changed(begun, "features", KEY, "info", "video.crf", to=20))


def test_what_is_true_of_all_videos_stays_told(info):
    data_set = copy.deepcopy(info)
    admit(3, info, data_set)
    assert data_set == info


def test_an_episode_that_is_refused_leaves_the_description_as_it_was(info):
    data_set = changed(changed(info, "fps", to=12.5), "features", KEY, "info", "video.crf", to=30)
    before = copy.deepcopy(data_set)
    with pytest.raises(UsageError, match="frame rate"):
        admit(3, info, data_set)
    assert data_set == before


def test_another_codec_is_refused_with_the_option_that_mends_it(info):
    with pytest.raises(UsageError, match=r"other video\.codec") as caught:
        admit(3, info, changed(info, "features", KEY, "info", "video.codec", to="av1"))
    assert "--codec av1" in caught.value.hint
