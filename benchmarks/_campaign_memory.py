"""Growth of the memory of a process that runs one job of a campaign after the other."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate
from typing import Any

import numpy as np

from vcage.campaigns.record import JobRecord


def growth(records: Sequence[JobRecord]) -> dict[str, Any]:
    """Largest memory of a process in each of its jobs, and a line through it over the episodes run before.

    The line begins at half of the jobs: in the first ones the process loads modules and shaders, and fills caches.

    Args:
        records: of jobs that one process ran, in that order; six or more.

    Returns:
        - ``jobs`` and ``verified`` episodes; ``tried``, with the rejected ones;
        - ``mb``, the largest memory in each job;
        - ``mb_per_episode``, the slope per tried episode in the second half of the jobs, and its standard error
          ``mb_per_episode_error``.
    """
    largest = [record.memory_bytes / 1e6 for record in records]
    before = [0, *accumulate(record.tried for record in records)]
    half = len(records) // 2
    (slope, _), covariance = np.polyfit(before[half:-1], largest[half:], 1, cov=True)
    return {
        "jobs": len(records),
        "verified": sum(record.verified for record in records),
        "tried": before[-1],
        "mb": [round(one) for one in largest],
        "mb_per_episode": round(float(slope), 3),
        "mb_per_episode_error": round(float(covariance[0, 0] ** 0.5), 3),
    }
