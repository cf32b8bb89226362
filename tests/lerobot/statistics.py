"""The statistics with which a policy normalises, as lerobot hands them out, against those of what was recorded."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tests.lerobot.expected import Episode
from tests.lerobot.loading import DataSet
from tests.lerobot.report import Report

SAMPLES = 50
"""Pictures of an episode that its statistics are made of at most, evenly spaced."""

CLOSE = 1e-5
CLOSE_PICTURES = 0.01
"""Of the range from 0 to 1; lerobot merges statistics of episodes in its own way."""


def check_statistics(report: Report, dataset: DataSet, episodes: list[Episode]) -> None:
    """Smallest, largest, mean and standard deviation of states, actions and pixels over the whole data set."""
    found = dataset.open().meta.stats
    for name in episodes[0].vectors:
        values = np.concatenate([episode.vectors[name] for episode in episodes]).astype(float)
        wrong = [
            f"{key} is {found[name][key]}"
            for key in ("min", "max", "mean", "std")
            if not np.allclose(found[name][key], getattr(values, key)(axis=0), atol=CLOSE)
        ]
        report.check(f"{dataset.name}: statistics of {name}", "min, max, mean, std", wrong)
    for name, video in episodes[0].videos.items():
        if video.originals is None:
            continue
        pixels = _sampled_pixels(episodes, name)
        wrong = [
            f"{key} is {found[name][key]}"
            for key in ("min", "max", "mean", "std")
            if np.shape(found[name][key]) != (3, 1, 1)
            or not np.allclose(np.ravel(found[name][key]), getattr(pixels, key)(axis=0), atol=CLOSE_PICTURES)
        ]
        report.check(f"{dataset.name}: statistics of {name}", "min, max, mean, std", wrong)


def _sampled_pixels(episodes: list[Episode], name: str) -> NDArray[np.float32]:
    """(N, 3) pixels of the recorded pictures, from 0 to 1."""
    pictures = []
    for episode in episodes:
        sample = np.unique(np.linspace(0, len(episode) - 1, SAMPLES).astype(int)).tolist()
        pictures.append(episode.videos[name].originals[sample].reshape(-1, 3))
    return np.concatenate(pictures).astype(np.float32) / 255
