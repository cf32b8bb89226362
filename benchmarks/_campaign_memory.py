"""Growth of the memory of a process that runs one job of a campaign after the other."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from typing import Any

import numpy as np

from vcage.campaigns.record import JobRecord

WARM_UP = 1
"""First jobs that are left out of the slope: they load modules, shaders and models."""


def growth(records: Sequence[JobRecord]) -> dict[str, Any]:
    """Largest memory of a process in each of its jobs, as a line over the episodes that it has run before.

    Args:
        records: of jobs that one process ran, in that order; at least three after the :data:`WARM_UP`.

    Returns:
        - ``jobs`` and ``verified`` episodes; ``tried``, with the rejected ones;
        - ``first_mb``, ``second_mb``, ``last_mb`` and ``largest_mb``, the largest memory in these jobs;
        - ``mb_per_episode``, the slope per tried episode after the first job, and its standard error
          ``mb_per_episode_error``.
    """
    largest = [record.memory_bytes / 1e6 for record in records]
    before = [0, *accumulate(record.tried for record in records)]
    (slope, _), covariance = np.polyfit(before[WARM_UP:-1], largest[WARM_UP:], 1, cov=True)
    return {
        "jobs": len(records),
        "verified": sum(record.verified for record in records),
        "tried": before[-1],
        "first_mb": round(largest[0]),
        "second_mb": round(largest[1]),
        "last_mb": round(largest[-1]),
        "largest_mb": round(max(largest)),
        "mb_per_episode": round(float(slope), 3),
        "mb_per_episode_error": round(float(covariance[0, 0] ** 0.5), 3),
    }
