"""``python -m benchmarks chain``: which stage took the seconds."""

from __future__ import annotations

import numpy as np

from benchmarks._process_times import Mark, Timed
from benchmarks.chain import Chain, _stages

MARKS = [
    Mark("[1/9] select_place", 2.0, 3.0),
    Mark("place: [1/2] draws", 2.5, 3.5),
    Mark("[2/9] inpaint_plan", 4.0, 6.0),
]


def test_each_stage_lasts_until_the_next_one_begins_and_all_add_up() -> None:
    done = Timed(0, "", wall_s=10.0, cpu_s=20.0, marks=MARKS)
    spent = {stage: both.tolist() for stage, both in _stages(done).items()}
    assert spent == {"start": [2, 3], "select_place": [2, 3], "inpaint_plan": [6, 14]}


def test_the_floor_is_drawing_and_encoding_without_the_start_of_their_process() -> None:
    floor = {"draw": (1.0, 1.0), "encode": (2.0, 1.5), "start": (9.0, 9.0)}
    figures = Chain(3.0, 5.0, {}, {part: np.array(spent) for part, spent in floor.items()}, 40.0, 4).figures()
    assert (figures["floor_seconds"], figures["floor_cpu_seconds"], figures["floor_ratio"]) == (3.0, 2.5, 2.0)
