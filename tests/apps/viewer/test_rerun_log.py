from __future__ import annotations

import numpy as np
import pytest

from vcage.apps.viewer.rerun_log import Clock, entity, xyzw


def test_times_are_rounded_to_the_nearest_nanosecond():
    clock = Clock(np.arange(3), np.array([0.1, 0.7, 1.1]))
    _, time = clock.columns()
    assert [int(t.value) for t in time.times] == [100_000_000, 700_000_000, 1_100_000_000]


def test_rows_of_a_clock_keep_their_frames_and_times():
    some = Clock.steady(10, 5.0).at([2, 7])
    assert (some.frames.tolist(), some.seconds.tolist(), len(some)) == ([2, 7], [0.4, 1.4], 2)


def test_quaternions_change_their_order():
    assert xyzw([[1, 2, 3, 4]]).tolist() == [[2, 3, 4, 1]] and xyzw([1, 2, 3, 4]).tolist() == [2, 3, 4, 1]


@pytest.mark.parametrize("name", ["front camera", "a/b", "cam.1", "größe"])
def test_any_name_is_one_part_of_a_path(name):
    assert entity("cameras", name).replace("\\/", "").count("/") == 2
