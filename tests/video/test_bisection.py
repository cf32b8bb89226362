"""The highest CRF that passes is found as trying them all would find it."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from vcage.video.bisection import BUDGET, highest_passing

MAX_CRF = 51


@given(
    losses=st.lists(st.floats(1e-7, 2), min_size=MAX_CRF + 1, max_size=MAX_CRF + 1).map(sorted),
    threshold=st.floats(0.01, 1),
    upper=st.integers(-1, MAX_CRF),
    first=st.integers(0, MAX_CRF),
)
def test_any_growing_loss_is_searched_exactly_within_the_budget(losses, threshold, upper, first):
    tried = []

    def loss_at(crf: int) -> float:
        tried.append(crf)
        return losses[crf]

    found = highest_passing(loss_at, threshold, upper, first)
    passing = [crf for crf in range(upper + 1) if losses[crf] < threshold]
    assert found == (max(passing) if passing else None)
    assert len(tried) <= BUDGET
    assert len(set(tried)) == len(tried)


@given(
    losses=st.lists(st.floats(1e-7, 2), min_size=MAX_CRF + 1, max_size=MAX_CRF + 1).map(sorted),
    threshold=st.floats(0.01, 1),
    first=st.integers(-5, MAX_CRF + 5),
    budget=st.integers(0, 4),
)
def test_a_budget_too_small_still_finds_one_that_passes_and_goes_on_no_longer_than_that(
    losses, threshold, first, budget
):
    tried = []

    def loss_at(crf: int) -> float:
        tried.append(crf)
        return losses[crf]

    found = highest_passing(loss_at, threshold, MAX_CRF, first, budget=budget)
    assert found == max((crf for crf in tried if losses[crf] < threshold), default=None)
    assert (found is None) == (losses[0] >= threshold)
    assert all(losses[crf] >= threshold for crf in tried[budget:-1])
    assert len(tried) <= budget + 7


def test_a_loss_that_grows_as_usual_takes_few_trials():
    tried = []

    def loss_at(crf: int) -> float:
        tried.append(crf)
        return 0.1 * np.exp(0.16 * (crf - 15.5))

    assert highest_passing(loss_at, 0.1, MAX_CRF, first=18) == 15
    assert len(tried) <= 4
