"""Statistics of a LeRobot data set: of vectors over frames, and of pictures over pixels."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

QUANTILES = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}
LEVELS = 256

Statistics = dict[str, Any]
"""``min, max, mean, std, count`` and the :data:`QUANTILES` of one feature, as nested lists."""


def vector_statistics(values: NDArray[Any]) -> Statistics:
    """Statistics over the N frames of (N, D) values; every entry has D numbers, ``count`` has one."""
    values = np.asarray(values, np.float64)
    quantiles = np.quantile(values, list(QUANTILES.values()), axis=0)
    return {
        "min": values.min(axis=0).tolist(),
        "max": values.max(axis=0).tolist(),
        "mean": values.mean(axis=0).tolist(),
        "std": values.std(axis=0).tolist(),
        "count": [len(values)],
        **dict(zip(QUANTILES, quantiles.tolist(), strict=True)),
    }


class Moments:
    """``min, max, mean, std, count`` of everything whose statistics were added, without keeping it.

    Merged as in Chan, Golub and LeVeque, "Updating formulae and a pairwise algorithm for computing sample variances"
    (1979): https://doi.org/10.1007/978-3-642-51461-6_3, which is exact but for rounding.
    """

    def __init__(self) -> None:
        self.count = 0
        self._min: NDArray[np.float64] = np.array(np.inf)
        self._max: NDArray[np.float64] = np.array(-np.inf)
        self._mean: NDArray[np.float64] = np.array(0.0)
        self._squares: NDArray[np.float64] = np.array(0.0)  # summed squares of the distance to the mean

    def add(self, part: Statistics) -> None:
        """Take in a part; all parts have entries of one shape."""
        count = int(part["count"][0])
        mean, std = np.asarray(part["mean"], np.float64), np.asarray(part["std"], np.float64)
        total = self.count + count
        distance = mean - self._mean
        self._squares = self._squares + std**2 * count + distance**2 * (self.count * count / total)
        self._mean = self._mean + distance * (count / total)
        self._min = np.minimum(self._min, part["min"])
        self._max = np.maximum(self._max, part["max"])
        self.count = total

    def statistics(self) -> Statistics:
        """All that was added, without quantiles; at least one part was."""
        return {
            "min": self._min.tolist(),
            "max": self._max.tolist(),
            "mean": self._mean.tolist(),
            "std": np.sqrt(self._squares / self.count).tolist(),
            "count": [self.count],
        }


def picture_histogram(pictures: NDArray[np.uint8]) -> NDArray[np.int64]:
    """How often each level occurs in each channel of (N, H, W, 3) pictures: (3, 256), which can be added up."""
    return np.stack([np.bincount(pictures[..., c].ravel(), minlength=LEVELS) for c in range(3)]).astype(np.int64)


def picture_statistics(histogram: NDArray[np.int64], frames: int) -> Statistics:
    """Statistics of pixels in [0, 1] from a (3, 256) histogram; entries have the shape (3, 1, 1), as LeRobot wants.

    Args:
        histogram: counts of each level per channel.
        frames: how many pictures it holds, the ``count`` of LeRobot.
    """
    levels = np.arange(LEVELS) / (LEVELS - 1)
    share = histogram / histogram.sum(axis=1, keepdims=True)
    mean = share @ levels
    variance = np.maximum(share @ levels**2 - mean**2, 0)
    below = np.cumsum(share, axis=1)
    found = [np.flatnonzero(channel) for channel in histogram]
    columns = {
        "min": [levels[present[0]] for present in found],
        "max": [levels[present[-1]] for present in found],
        "mean": mean,
        "std": np.sqrt(variance),
        # the first level that a share q of the pixels does not exceed; a little less than q, for rounding
        **{name: [levels[np.searchsorted(c, q - 1e-12)] for c in below] for name, q in QUANTILES.items()},
    }
    return {**{name: [[[float(x)]] for x in column] for name, column in columns.items()}, "count": [frames]}
