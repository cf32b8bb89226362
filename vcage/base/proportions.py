"""Confidence intervals of proportions."""

from __future__ import annotations

import math
from statistics import NormalDist

LEVEL = 0.95
"""Confidence of the intervals."""


def wilson(some: int, of: int) -> tuple[float, float]:
    """The Wilson score interval of a proportion at 95 %; (0, 1) of nothing.

    Without SciPy, whose import takes half a second that most runs need for nothing else.

    Source: Wilson, E. B. (1927), Probable inference, the law of succession, and statistical inference, JASA 22.
    """
    if of == 0:
        return 0.0, 1.0
    z, share = NormalDist().inv_cdf((1 + LEVEL) / 2), some / of
    middle = (share + z**2 / (2 * of)) / (1 + z**2 / of)
    half = z / (1 + z**2 / of) * math.sqrt(share * (1 - share) / of + z**2 / (4 * of**2))
    return middle - half if some > 0 else 0.0, middle + half if some < of else 1.0
