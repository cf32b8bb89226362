"""Confidence intervals of proportions."""

from __future__ import annotations

LEVEL = 0.95
"""Confidence of the intervals."""


def wilson(some: int, of: int) -> tuple[float, float]:
    """The Wilson score interval of a proportion at 95 %; (0, 1) of nothing.

    Source: Wilson, E. B. (1927), Probable inference, the law of succession, and statistical inference, JASA 22.
    """
    from scipy.stats import binomtest  # half a second, which most runs do not need

    if of == 0:
        return 0.0, 1.0
    found = binomtest(some, of).proportion_ci(LEVEL, method="wilson")
    return float(found.low), float(found.high)
