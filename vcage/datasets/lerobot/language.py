"""LeRobot's columns of language: the sub-tasks in words, in every frame of their episode.

https://huggingface.co/docs/lerobot/language_and_recipes. LeRobot calls a data set that has them v3.1, and its
``codebase_version`` stays v3.0. ``language_persistent`` holds the same rows in all frames of an episode, each valid
from its timestamp on until the next of its style; ``language_events`` holds events of one frame alone, of which
episodes have none.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from vcage.datasets.lerobot.episode import SubtaskSpan

PERSISTENT, EVENTS = "language_persistent", "language_events"
LANGUAGE = (PERSISTENT, EVENTS)

FEATURE: dict[str, Any] = {"dtype": "language", "shape": [1], "names": None}
"""Entry of ``info.json`` for each of the columns."""

STYLE, ROLE = "subtask", "assistant"
"""Of a sub-task's row, as in lerobot's own annotations: the output of a policy that plans."""

_EVENT = [
    pa.field("role", pa.string(), nullable=False),
    pa.field("content", pa.string()),
    pa.field("style", pa.string()),
    pa.field("camera", pa.string()),
    pa.field("tool_calls", pa.list_(pa.string())),
]
EVENT_ROW = pa.struct(_EVENT)
PERSISTENT_ROW = pa.struct([*_EVENT[:3], pa.field("timestamp", pa.float32(), nullable=False), *_EVENT[3:]])


def with_language(frames: pa.Table, spans: Sequence[SubtaskSpan], timestamps: NDArray[np.float32]) -> pa.Table:
    """Return the frames of an episode with the columns of language.

    Args:
        frames: T rows.
        spans: recorded sub-tasks in order; if there is none, no frame has a row.
        timestamps: (T,) those of the frames: readers compare them with those of the rows, to the bit.
    """
    starts = span_starts(spans)
    rows = [
        {"role": ROLE, "content": span.text, "style": STYLE, "timestamp": timestamps[start]}
        for span, start in zip(spans, starts, strict=True)
    ]
    count, length = len(rows), len(timestamps)
    every = pa.array(rows, PERSISTENT_ROW).take(pa.array(np.tile(np.arange(count), length)))
    persistent = pa.ListArray.from_arrays(pa.array(np.arange(length + 1, dtype=np.int32) * count), every)
    events = pa.array([[]] * length, pa.list_(EVENT_ROW))
    return frames.append_column(PERSISTENT, persistent).append_column(EVENTS, events)


def span_starts(spans: Sequence[SubtaskSpan]) -> list[int]:
    """Return the first frame of each sub-task: that of the episode, and the end of the sub-task before."""
    return [0, *(span.end for span in spans[:-1])][: len(spans)]
