"""A small LeRobot data set in both versions."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.recordings import CAMERAS, FPS, clip, episode
from vcage.compression.codec import EncoderSettings, encode
from vcage.dataset.lerobot import LeRobotEpisode, gather
from vcage.dataset.lerobot_v3 import export_v3
from vcage.dataset.lerobot_v21 import export_v21
from vcage.dataset.statistics import picture_histogram

LENGTHS = (12, 9)


@pytest.fixture(scope="session")
def episodes(tmp_path_factory) -> list[LeRobotEpisode]:
    folder = tmp_path_factory.mktemp("videos")
    return [_episode(folder, index, length) for index, length in enumerate(LENGTHS)]


def _episode(folder: Path, index: int, length: int) -> LeRobotEpisode:
    videos = {}
    for number, camera in enumerate(CAMERAS):
        videos[camera] = folder / f"{index}.{camera}.mp4"
        videos[camera].write_bytes(encode(clip(length, number), FPS, EncoderSettings(), 10))
    histograms = {camera: picture_histogram(clip(length, number)) for number, camera in enumerate(CAMERAS)}
    return LeRobotEpisode(episode(length), videos, histograms, length)


@pytest.fixture(scope="session")
def contents(episodes):
    return gather(episodes, {"cam_high": {"video.crf": 10}})


@pytest.fixture(scope="session")
def v3(contents, tmp_path_factory) -> Path:
    return export_v3(contents, tmp_path_factory.mktemp("v3") / "set")


@pytest.fixture(scope="session")
def v21(contents, tmp_path_factory) -> Path:
    return export_v21(contents, tmp_path_factory.mktemp("v21") / "set")
