"""What ``meta/info.json`` says of a data set's frames, and whether another episode agrees with it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from vcage.dataset.lerobot.episode import ACTION, STATE, LeRobotEpisode
from vcage.dataset.lerobot.video import video_info, whole
from vcage.errors import UsageError

SUBTASK = "subtask_index"
"""The one column that is not LeRobot's own; a data set that has none is added to without."""

SCALARS = ("timestamp", "frame_index", "episode_index", "index", "task_index", SUBTASK)

CAMERA = "observation.images."


def video_key(camera: str) -> str:
    """LeRobot's name of a camera's feature."""
    return f"{CAMERA}{camera}"


def other_columns(features: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Names of features that no episode of ours fills, such as rewards."""
    ours = (STATE, ACTION, *SCALARS)
    return sorted(name for name, feature in features.items() if feature["dtype"] != "video" and name not in ours)


def describe(episode: LeRobotEpisode, encodings: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """``fps``, ``robot_type`` and ``features`` of a data set of such episodes.

    Args:
        episode: one that has nothing to complain of.
        encodings: camera → facts about its encoding that its file does not tell, such as ``{"video.crf": 18}``; None
            for what its file tells but the data set leaves open, as its episodes differ in it.

    Raises:
        DamagedFile: a video is unreadable, or does not show the episode's frames.
    """
    features: dict[str, dict[str, Any]] = {}
    for name, names in episode.vector_names.items():
        features[name] = {"dtype": "float32", "shape": [len(names)], "names": names}
    for camera in sorted(episode.videos):
        info = video_info(episode.videos[camera], episode.length, episode.fps)
        told = {**info, **encodings.get(camera, {})}
        features[video_key(camera)] = {
            "dtype": "video",
            "shape": [info["video.height"], info["video.width"], 3],
            "names": ["height", "width", "channels"],
            "info": {fact: value for fact, value in told.items() if value is not None},
        }
    for name in SCALARS:
        features[name] = {"dtype": "float32" if name == "timestamp" else "int64", "shape": [1], "names": None}
    return {"robot_type": episode.robot, "fps": whole(episode.fps), "features": features}


def require_alike(episode: int, described: Mapping[str, Any], data_set: Mapping[str, Any]) -> None:
    """Raise UsageError unless all that a data set says of its episodes is true of another one too.

    Args:
        episode: its number in the data set, for the message.
        described: what :func:`describe` says of it.
        data_set: ``meta/info.json``; what it does not tell (None, or no such entry) may be anything.
    """
    mine, theirs = _facts(described), _facts(data_set)
    for what, value in theirs.items():
        if value is not None and mine.get(what) != value:
            raise UsageError(
                f"episode {episode} has other {what} ({_told(mine.get(what))}) than the data set ({_told(value)})",
                hint="put episodes of one robot, one set of cameras and one encoding together",
                details={"episode": episode, "what": what},
            )


def _told(value: Any) -> str:
    return "unknown" if value is None else str(value)


def _facts(info: Mapping[str, Any]) -> dict[str, Any]:
    """Name in plain words → what must be the same in all episodes."""
    features = info["features"]
    videos = [key for key, feature in features.items() if feature["dtype"] == "video"]
    facts: dict[str, Any] = {
        "frame rate": float(info["fps"]),
        "robot": info.get("robot_type"),
        "cameras": sorted(key.removeprefix(CAMERA) for key in videos),
        "columns": sorted(set(features) - set(videos) - {SUBTASK}),
    }
    for key, feature in features.items():
        if key in videos:
            facts[f"size of {key}"] = list(feature["shape"])
            told = {**feature.get("video_info", {}), **feature.get("info", {})}
            facts |= {f"{fact} of {key}": value for fact, value in told.items()}
        elif key not in SCALARS:
            facts[f"type of {key}"] = feature["dtype"]
            facts[f"size of {key}"] = list(feature["shape"])
            facts[f"names of {key}"] = _names(feature.get("names"))
    return facts


def _names(names: Any) -> list[str] | None:
    """Names of a vector's numbers; LeRobot also has them in groups, ``{"motors": […]}``, or numbered, ``{"x": 0}``."""
    if isinstance(names, Mapping):
        names = [one for name, group in names.items() for one in (group if isinstance(group, list) else [name])]
    return [str(name) for name in names] if names else None
