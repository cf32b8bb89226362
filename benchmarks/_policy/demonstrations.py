"""Demonstrations as a lab reads them: the columns of an exported LeRobot v3.0 data set."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
from numpy.typing import NDArray

STATE, OBJECTS, ACTION = "observation.state", "observation.environment_state", "action"
SUBTASK, EPISODE = "subtask_index", "episode_index"


@dataclass(frozen=True)
class Demonstrations:
    """All frames of some episodes, one episode after the other: F frames, D numbers of a state, M of the objects.

    Args:
        states: (F, D) float64, measured: radians, grippers from 0 closed to 1 open.
        objects: (F, M) float64, poses of objects.
        actions: (F, D) float64, targets of the next frame, in the units of states.
        steps: (F,) number of the sub-task under way, in the order of the episode.
        ends: (E,) the frame behind the last of each episode.
        names: of the D numbers.
        object_names: of the M numbers.
    """

    states: NDArray[np.float64]
    objects: NDArray[np.float64]
    actions: NDArray[np.float64]
    steps: NDArray[np.int64]
    ends: NDArray[np.int64]
    names: tuple[str, ...]
    object_names: tuple[str, ...]

    @classmethod
    def read(cls, data_set: Path, episodes: int | None = None) -> Demonstrations:
        """Read a data set, or its first episodes.

        Raises:
            FileNotFoundError: it is no LeRobot v3.0 data set.
            KeyError: it was exported without ``--environment-state``.
        """
        features = json.loads((data_set / "meta" / "info.json").read_text())["features"]
        names, object_names = (tuple(features[key]["names"]) for key in (STATE, OBJECTS))
        files = sorted((data_set / "data").glob("chunk-*/file-*.parquet"))
        tables = [pq.read_table(file, columns=[STATE, OBJECTS, ACTION, SUBTASK, EPISODE]) for file in files]
        index = np.concatenate([table[EPISODE].to_numpy() for table in tables])
        chosen = index < (np.inf if episodes is None else episodes)

        def column(name: str) -> NDArray[np.float64]:
            rows = [np.stack(table[name].to_numpy()) for table in tables]
            return np.concatenate(rows).astype(np.float64)[chosen]

        return cls(
            states=column(STATE),
            objects=column(OBJECTS),
            actions=column(ACTION),
            steps=_steps(np.concatenate([table[SUBTASK].to_numpy() for table in tables])[chosen], index[chosen]),
            ends=np.flatnonzero(np.diff(index[chosen], append=-1)) + 1,
            names=names,
            object_names=object_names,
        )

    def episodes(self) -> NDArray[np.int64]:
        """(F,) the number of the episode of each frame."""
        return np.searchsorted(self.ends, np.arange(len(self.states)), side="right")

    def releases(self, presses: NDArray[np.bool_]) -> NDArray[np.int64]:
        """(F,) the last frame of each frame's sub-task in which a hand presses on something; without one, its last.

        Args:
            presses: (F,) a hand does.
        """
        begins = (np.diff(self.steps, prepend=-1) != 0) | (np.diff(self.episodes(), prepend=-1) != 0)
        part, where = np.cumsum(begins) - 1, np.flatnonzero(presses)
        last = np.append(np.flatnonzero(begins)[1:], len(begins)) - 1
        last[part[where]] = where  # of several frames of one sub-task the last remains
        return last[part]

    def next_of(self, marked: NDArray[np.bool_]) -> NDArray[np.int64]:
        """(F,) the next marked frame of each one, itself included; else the last of its episode.

        Args:
            marked: (F,) frames.
        """
        stops = marked.copy()
        stops[self.ends - 1] = True
        where = np.flatnonzero(stops)
        return where[np.searchsorted(where, np.arange(len(stops)))]

    def next_frames(self, length: int) -> NDArray[np.int64]:
        """(F, length) the frames from each one on; behind the end of an episode its last one again."""
        last = self.ends[self.episodes()] - 1
        return np.minimum(np.arange(len(self.states))[:, None] + np.arange(length), last[:, None])


def _steps(subtasks: NDArray[np.int64], episodes: NDArray[np.int64]) -> NDArray[np.int64]:
    """(F,) changes of the sub-task since the episode of each frame began."""
    begins = np.diff(episodes, prepend=-1) != 0
    changes = np.cumsum((np.diff(subtasks, prepend=-1) != 0) & ~begins)
    return changes - changes[np.maximum.accumulate(np.where(begins, np.arange(len(begins)), 0))]
