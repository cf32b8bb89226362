"""Jobs that hang: no step for longer than any step takes, or more seconds than the plan allows."""

from __future__ import annotations

import time
from pathlib import Path

from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.plan import Job, Plan


class HangWatch:
    """Limits how long a job may be silent.

    It compares a job's beats only with each other, and measures time by this process's monotonic clock. So neither a
    clock that jumps nor that of another machine matters.

    Args:
        root: the folder of the campaign.
        look_every_s: longest time between two looks.
    """

    def __init__(self, root: Path, look_every_s: float = 10.0):
        self._folder, self._every_s = CampaignFolder(root), look_every_s
        self._seen: dict[str, tuple[int, float]] = {}

    def seconds_left(self, job: Job, elapsed: float) -> float:
        """Seconds until the next look; 0 or less if the job hangs.

        Args:
            job: that runs.
            elapsed: seconds since its try began.
        """
        now, beat = time.monotonic(), self._folder.last_beat(job)
        seen, since = self._seen.get(job.id, (0, 0.0))
        if beat != seen or now - since > elapsed:  # it got on, or this is another try
            seen, since = self._seen[job.id] = beat, now
        limits = self._folder.plan.limits
        left = silence_limit(self._folder.plan) - (now - since)
        if limits.seconds is not None:
            left = min(left, limits.seconds - elapsed)
        return min(left, self._every_s)


def silence_limit(plan: Plan, hang_factor: float = 1.5, start_s: float = 60.0) -> float:
    """Seconds without a step after which a job hangs: its longest step is an episode, which ends itself before.

    Args:
        plan: of the campaign.
        hang_factor: times the limit of an episode,
        start_s: and so many seconds for the start of a process.
    """
    return hang_factor * plan.chain_options.episode_limit + start_s
