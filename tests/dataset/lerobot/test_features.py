"""When another episode agrees with what a data set says of itself."""

from __future__ import annotations

import copy

import pytest

from vcage.dataset.lerobot.features import require_alike
from vcage.errors import UsageError

KEY = "observation.images.cam_high"


@pytest.fixture
def info() -> dict:
    return {
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
    require_alike(3, info, changed(info, *path, to=value))


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
        (("features", KEY, "info", "video.preset"), "slow", f"video.preset of {KEY}"),
    ],
)
def test_what_differs_is_named(info, path, value, what):
    with pytest.raises(UsageError, match="episode 3 has other") as caught:
        require_alike(3, info, changed(info, *path, to=value))
    assert caught.value.details == {"episode": 3, "what": what}
