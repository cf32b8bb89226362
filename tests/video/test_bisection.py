"""The highest CRF that passes is found as trying them all would find it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vcage.video.bisection import SETTINGS, highest_passing

MAX_CRF = 51
HALVINGS = 6
"""Of a range of all CRFs."""


@given(
    losses=st.lists(st.floats(0, 2), min_size=MAX_CRF + 1, max_size=MAX_CRF + 1).map(sorted),
    threshold=st.floats(0.01, 1),
    upper=st.integers(-1, MAX_CRF),
    first=st.integers(-5, MAX_CRF + 5),
)
def test_any_growing_loss_is_searched_exactly_and_no_crf_twice(losses, threshold, upper, first):
    tried = []

    def loss_at(crf: int) -> float:
        tried.append(crf)
        return losses[crf]

    found = highest_passing(loss_at, threshold, upper, first)
    passing = [crf for crf in range(upper + 1) if losses[crf] < threshold]
    assert found == (max(passing) if passing else None)
    assert len(tried) <= SETTINGS.guesses + HALVINGS
    assert len(set(tried)) == len(tried)


@pytest.mark.parametrize("growth", [0.12, 0.16, 0.18, 0.22])
@pytest.mark.parametrize("last", [8, 15, 24])
def test_a_loss_that_grows_evenly_takes_few_trials(growth, last):
    tried = []

    def loss_at(crf: int) -> float:
        tried.append(crf)
        return 0.1 * np.exp(growth * (crf - last - 0.5))

    assert highest_passing(loss_at, 0.1, MAX_CRF, first=16) == last
    assert len(tried) <= 4


def test_a_bound_that_passes_takes_one_trial():
    tried = []
    assert highest_passing(lambda crf: tried.append(crf) or 0.09, 0.1, upper=17, first=17) == 17
    assert tried == [17]
