"""Jobs whose actors were lost while they ran, until nothing holds them any more."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass

from vcage.base.errors import FolderInUse
from vcage.campaigns.folder import CampaignFolder
from vcage.campaigns.hanging import HangWatch
from vcage.campaigns.job import Outcome, lost_job
from vcage.campaigns.plan import Job


@dataclass(frozen=True)
class _Lost:
    """A job, when its try began and its actor was lost (:func:`time.monotonic`), and how."""

    job: Job
    began: float
    since: float
    how: str


class Stranded:
    """Waits for the processes of lost actors to release their jobs.

    Such a process may run on, as on a node that lost the cluster: it settles its job, or ends. One that is silent for
    longer than any step takes, on a node that hangs, cannot be ended from here: the job is taken from it. Should it
    wake, it ends at its next step (:meth:`CampaignFolder.beat`).

    Args:
        folder: of the campaign.
        watch: of the jobs.
        freed_within_s: time within which a process that was killed has released its job.
    """

    def __init__(self, folder: CampaignFolder, watch: HangWatch, freed_within_s: float):
        self._folder, self._watch, self._freed_within_s = folder, watch, freed_within_s
        self._lost: list[_Lost] = []

    def __bool__(self) -> bool:
        return bool(self._lost)

    def add(self, job: Job, began: float, how: str) -> None:
        """Add a job.

        Args:
            job: whose actor was lost.
            began: when its try did (:func:`time.monotonic`).
            how: the actor was lost.
        """
        self._lost.append(_Lost(job, began, time.monotonic(), how))

    def outcomes(self) -> Iterator[Outcome]:
        """Yield the outcomes of those that nothing holds any more."""
        for lost in list(self._lost):
            outcome = self._outcome(lost)
            if not isinstance(outcome.error, FolderInUse):
                self._lost.remove(lost)
                yield outcome

    def _outcome(self, lost: _Lost) -> Outcome:
        outcome, now = lost_job(self._folder.root, lost.job, lost.how), time.monotonic()
        if not isinstance(outcome.error, FolderInUse) or now - lost.since < self._freed_within_s:
            return outcome
        if self._watch.seconds_left(lost.job, now - lost.began) > 0:
            return outcome
        self._folder.take_back(lost.job)
        return lost_job(self._folder.root, lost.job, lost.how)
