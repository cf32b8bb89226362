from __future__ import annotations

import numpy as np

from vcage.video.choices import Criterion

LOSSES = np.array([0.05, 0.099, 0.09])


def test_the_worst_frames_decide_and_those_that_lose_almost_as_much():
    assert Criterion().deciding([3, 5, 8], LOSSES) == [5, 8]


def test_all_frames_decide_where_their_mean_counts():
    assert Criterion(reduce="mean").deciding([3, 5, 8], LOSSES) == [3, 5, 8]
