from __future__ import annotations

import numpy as np

from vcage.video.choices import Criterion

FRAMES = range(0, 40, 2)
LOSSES = np.random.default_rng(0).permutation(len(FRAMES)) / 100


def test_the_worst_frames_decide_in_order_of_time():
    deciding = Criterion().deciding(FRAMES, LOSSES)
    assert deciding == sorted(deciding) and len(deciding) == 4
    assert min(LOSSES[frame // 2] for frame in deciding) == sorted(LOSSES)[-4]


def test_all_frames_decide_where_their_mean_counts():
    assert Criterion(reduce="mean").deciding(FRAMES, LOSSES) == list(FRAMES)
