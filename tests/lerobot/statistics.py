"""The statistics with which a policy normalises, as lerobot returns them, against the recording."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from tests.lerobot.expected import Episode
from tests.lerobot.loading import DataSet
from tests.lerobot.report import Report

SAMPLES = 50
"""Pictures of an episode that its statistics are made of at most, evenly spaced."""

SHARES = (1, 10, 50, 90, 99)
"""Of the numbers, percent, that lie below LeRobot's quantiles."""

CLOSE = 1e-5
CLOSE_PICTURES = 0.01
"""Of the range from 0 to 1; lerobot merges statistics of episodes in its own way."""


def check_statistics(report: Report, dataset: DataSet, episodes: list[Episode], quantiles: bool) -> None:
    """Statistics of states, actions and pixels over the whole data set.

    Args:
        report: is told.
        dataset: the data set.
        episodes: the recordings.
        quantiles: True if it has exact ones. lerobot's averages are only near them, and v2.1 has none.
    """
    found = dataset.open().meta.stats
    for name in episodes[0].vectors:
        values = np.concatenate([episode.vectors[name] for episode in episodes]).astype(float)
        wanted = _statistics(values, quantiles, "linear")
        wrong = [
            f"{key} is {found[name].get(key)}"
            for key, value in wanted.items()
            if key not in found[name] or not np.allclose(found[name][key], value, atol=CLOSE)
        ]
        report.check(f"{dataset.name}: statistics of {name}", ", ".join(wanted), wrong)
    for name, video in episodes[0].videos.items():
        if video.originals is None:
            continue
        wanted = _statistics(_sampled_pixels(episodes, name), quantiles, "inverted_cdf")
        wrong = [
            f"{key} is {found[name].get(key)}"
            for key, value in wanted.items()
            if np.shape(found[name].get(key)) != (3, 1, 1)
            or not np.allclose(np.ravel(found[name][key]), value, atol=CLOSE_PICTURES)
        ]
        report.check(f"{dataset.name}: statistics of {name}", ", ".join(wanted), wrong)


def _statistics(
    values: NDArray[np.floating[Any]], quantiles: bool, method: Literal["linear", "inverted_cdf"]
) -> dict[str, NDArray[np.floating[Any]]]:
    """LeRobot's name → (D,), of (N, D) values; ``method`` is that of :func:`numpy.quantile`."""
    found = {key: getattr(values, key)(axis=0) for key in ("min", "max", "mean", "std")}
    shares = SHARES if quantiles else ()
    return found | {f"q{share:02}": np.quantile(values, share / 100, axis=0, method=method) for share in shares}


def _sampled_pixels(episodes: list[Episode], name: str) -> NDArray[np.float32]:
    """(N, 3) pixels of the recorded pictures, from 0 to 1."""
    pictures = []
    for episode in episodes:
        sample = np.unique(np.linspace(0, len(episode) - 1, SAMPLES).astype(int)).tolist()
        pictures.append(episode.videos[name].originals[sample].reshape(-1, 3))
    return np.concatenate(pictures).astype(np.float32) / 255
