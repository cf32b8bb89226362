"""What was judged is not judged again, and nothing else is taken for it."""

from __future__ import annotations

import numpy as np

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


def test_losses_are_those_of_the_metric_and_computed_once():
    metric, worse = Counting(), PICTURES // 2
    known = KnownLosses(metric)
    first = known.loss(worse[:4], PICTURES[:4])
    assert first.tolist() == metric.loss(worse[:4], PICTURES[:4]).tolist()
    assert known.loss(worse[2:6], PICTURES[2:6])[:2].tolist() == first[2:].tolist()
    assert metric.asked == [4, 4, 2]


def test_another_picture_or_another_reference_is_judged_anew():
    metric = Counting()
    known = KnownLosses(metric)
    known.loss(PICTURES[:1], PICTURES[:1])
    changed = PICTURES.copy()
    changed[0, 0, 0, 0] ^= 1
    known.loss(changed[:1], PICTURES[:1])
    known.loss(PICTURES[:1], changed[:1])
    assert metric.asked == [1, 1, 1]


def test_what_is_known_is_taken_over():
    known = KnownLosses(Counting())
    known.loss(PICTURES[:2] // 2, PICTURES[:2])
    other = Counting()
    assert KnownLosses(other, known.losses).loss(PICTURES[:2] // 2, PICTURES[:2]).tolist() == [*known.losses.values()]
    assert other.asked == []
