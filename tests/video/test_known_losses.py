"""The metric judges each pair of pictures once, and confuses none."""

from __future__ import annotations

import numpy as np
import pytest

from tests.recordings import clip
from vcage.video.known_losses import KnownLosses

PICTURES = clip(6)


class Counting:
    """A metric whose losses are differences, and what it was asked."""

    def __init__(self):
        self.asked: list[int] = []

    def loss(self, test, reference):
        self.asked.append(len(test))
        return np.abs(test.astype(float) - reference).mean(axis=(1, 2, 3))


def test_losses_are_those_of_the_metric():
    worse = PICTURES // 2
    assert KnownLosses(Counting()).loss(worse, PICTURES).tolist() == Counting().loss(worse, PICTURES).tolist()


def test_what_was_judged_is_not_judged_again():
    metric, worse = Counting(), PICTURES // 2
    known = KnownLosses(metric)
    known.loss(worse[:4], PICTURES[:4])
    known.loss(worse[2:6], PICTURES[2:6])
    assert metric.asked == [4, 2]


def test_equal_pairs_are_judged_once():
    metric, still = Counting(), np.repeat(PICTURES[:1], 3, axis=0)
    assert len(set(KnownLosses(metric).loss(still // 2, still))) == 1
    assert metric.asked == [1]


@pytest.mark.parametrize("changed", [0, 1])
def test_where_either_picture_is_another_it_is_judged_anew(changed):
    metric = Counting()
    known = KnownLosses(metric)
    pair = [PICTURES[:1], PICTURES[:1]]
    known.loss(*pair)
    pair[changed] = pair[changed] ^ np.uint8(1)
    known.loss(*pair)
    assert metric.asked == [1, 1]
