"""Statistics of a whole LeRobot data set while it grows: ``meta/stats.json``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import DamagedFile
from vcage.base.files import read_json, write_json
from vcage.datasets.lerobot.features import video_key
from vcage.datasets.lerobot.statistics import LEVELS, QUANTILES, Moments, Statistics, picture_statistics
from vcage.datasets.parquet_files import MEND, read_batches
from vcage.datasets.quantiles import exact_quantiles

STATS = Path("meta/stats.json")

LEVEL_COUNTS = Path("meta/picture_levels.json")
"""How often each level occurs in the pictures of each camera: what the quantiles of a set that is added to are
made of. LeRobot does not read it."""


class Totals:
    """``min, max, mean, std, count`` by merging those of the episodes; quantiles by counting.

    The quantiles of columns are exact: the written files are read again when the set is finished, three times at most
    but for numbers beyond 2³². Those of pictures come from the added histograms.
    """

    def __init__(self) -> None:
        self._moments: dict[str, Moments] = {}
        self._levels: dict[str, NDArray[np.int64]] = {}
        self._uncounted: dict[str, Statistics] = {}

    def add(self, statistics: Mapping[str, Statistics], histograms: Mapping[str, NDArray[np.int64]]) -> None:
        """Take in an episode: feature → statistics, and camera → (3, 256) counts of levels."""
        for feature, entry in statistics.items():
            self._moments.setdefault(feature, Moments()).add(entry)
        for camera, histogram in histograms.items():
            key = video_key(camera)
            self._levels[key] = self._levels.get(key, 0) + np.asarray(histogram, np.int64)

    def resume(self, root: Path, features: Mapping[str, Any]) -> None:
        """Take in a finished data set.

        A set that was not written here has no counts of levels, or old ones: the quantiles of its pictures are then
        averaged with those of the new ones, weighted by numbers of pictures, as LeRobot does.

        Raises:
            DamagedFile: its statistics are missing or incomplete.
        """
        if not (root / STATS).is_file():
            raise DamagedFile(f"{root / STATS} is missing", hint=MEND)
        try:
            stats = read_json(root / STATS)
            for feature in features:
                self._moments[feature] = Moments()
                self._moments[feature].add(stats[feature])
            counted = read_json(root / LEVEL_COUNTS) if (root / LEVEL_COUNTS).exists() else {}
            for key in (key for key, feature in features.items() if feature["dtype"] == "video"):
                if counted.get(key, {}).get("count") == stats[key]["count"]:
                    self._levels[key] = np.array(counted[key]["levels"], np.int64).reshape(3, LEVELS)
                else:
                    self._uncounted[key] = stats[key]
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise DamagedFile(f"{root / STATS} does not describe all features: {error!r}", hint=MEND) from error

    def write(self, folder: Path, data: Sequence[Path], features: Mapping[str, Any]) -> None:
        """Write ``meta/stats.json`` and the counts of levels.

        Args:
            folder: of the data set.
            data: all its tables of frames.
            features: as in ``info.json``.
        """
        stats = {name: self._moments[name].statistics() for name in features}
        columns = [name for name in features if name not in self._levels]
        quantiles = self._column_quantiles(data, columns, features)
        for name, entry in stats.items():
            entry |= self._picture_quantiles(name) if name in self._levels else quantiles[name]
        write_json(folder / STATS, stats)
        counted = {
            key: {"count": stats[key]["count"], "levels": levels.tolist()}
            for key, levels in self._levels.items()
            if key not in self._uncounted
        }
        if counted:
            write_json(folder / LEVEL_COUNTS, counted)

    def _column_quantiles(
        self, data: Sequence[Path], columns: Sequence[str], features: Mapping[str, Any]
    ) -> dict[str, Statistics]:
        ranges = {}
        for name in columns:
            found, dtype = self._moments[name].statistics(), np.dtype(features[name]["dtype"])
            ranges[name] = (np.array(found["min"], dtype), np.array(found["max"], dtype))
        count = self._moments["index"].count
        found = exact_quantiles(lambda names: read_batches(data, names), ranges, count, list(QUANTILES.values()))
        return {name: dict(zip(QUANTILES, values.tolist(), strict=True)) for name, values in found.items()}

    def _picture_quantiles(self, key: str) -> Statistics:
        old = self._uncounted.get(key)
        count = self._moments[key].count
        new = count - (old["count"][0] if old else 0)
        found = picture_statistics(self._levels[key], new)
        if old is None:
            return {name: found[name] for name in QUANTILES}
        return {
            name: (np.array(found[name]) + (np.array(old[name]) - found[name]) * (1 - new / count)).tolist()
            for name in QUANTILES
            if name in old
        }
