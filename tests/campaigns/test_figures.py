"""Figures of a campaign in words."""

from __future__ import annotations

import pytest

from vcage.campaigns.figures import duration


@pytest.mark.parametrize(
    ("hours", "words"), [(0.001, "1 min"), (0.05, "3 min"), (1, "1.0 h"), (99.94, "99.9 h"), (2400, "100.0 days")]
)
def test_a_time_is_told_in_the_unit_that_fits(hours: float, words: str):
    assert duration(hours) == words
