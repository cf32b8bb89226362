"""A share of the jobs of a campaign."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Shard:
    """The jobs whose place in the plan leaves ``index`` when divided by ``count``."""

    index: int = 0
    count: int = 1

    def has(self, place: int) -> bool:
        """True if the job at a place in the plan is one of them."""
        return place % self.count == self.index


EVERY_JOB = Shard()
