"""The number of verified episodes that a collection needs of each chain, which to begin next, and which it lacks."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from vcage.base.errors import TooFewVerified
from vcage.schema.episodes import Episode, Episodes
from vcage.schema.subtasks import Subtasks

RUNS_PER_EPISODE = 3
"""Episodes tried for each that is wanted, before the collection gives up."""


@dataclass(frozen=True)
class Wanted:
    """The number of verified episodes to collect.

    Args:
        chains: how many there are; the n-th episode of chain c has the number n · chains + c.
        each: verified episodes of each chain.
    """

    chains: int
    each: int

    @classmethod
    def of(cls, episodes: int | None, subtasks: Subtasks) -> Wanted:
        """Count the requested episodes; without a number, three of an instruction and one of each sub-task."""
        return cls(len(subtasks.chains), episodes or (1 if subtasks.instruction is None else 3))

    @property
    def total(self) -> int:
        return self.chains * self.each

    def missing(self, episodes: Sequence[Episode]) -> int:
        """Missing verified episodes."""
        verified = Counter(episode.chain for episode in episodes if episode.accepted)
        return sum(max(self.each - verified[chain], 0) for chain in range(self.chains))

    def next(self, episodes: Sequence[Episode], running: Collection[int]) -> list[int]:
        """Numbers of the episodes to begin, all of them needed even if every running one is accepted."""
        ran, verified = Counter(e.chain for e in episodes), Counter(e.chain for e in episodes if e.accepted)
        busy, numbers = Counter(number % self.chains for number in running), []
        for chain in range(self.chains):
            begun = ran[chain] + busy[chain]
            needed = min(self.each - verified[chain] - busy[chain], RUNS_PER_EPISODE * self.each - begun)
            numbers += [n * self.chains + chain for n in range(begun, begun + needed)]
        return sorted(numbers)

    def shortfall(self, record: Episodes) -> TooFewVerified | None:
        """Return the error of a collection with fewer verified episodes than were asked for, or None."""
        missing, ran = self.missing(record.episodes), len(record.episodes)
        if missing == 0:
            return None
        reasons = Counter(episode.reason for episode in record.episodes if not episode.accepted)
        asked, never = self.total, never_verified(record)
        without = f"; none of {len(never)} of {self.chains} sub-tasks" if never else ""
        return TooFewVerified(
            f"asked for {asked} episodes, verified {asked - missing} of the {ran} that were run{without}: "
            f"{reasons.most_common(1)[0][0]}",
            hint="those that were verified are kept; another --seed gives another layout",
            details={
                "asked": asked,
                "verified": asked - missing,
                "ran": ran,
                "never_verified": never,
                "reasons": dict(reasons.most_common(5)),
            },
        )


def never_verified(record: Episodes) -> dict[str, str]:
    """Name the chains without a verified episode, by ids of their sub-tasks, and why the last one was not."""
    verified = {episode.chain for episode in record.episodes if episode.accepted}
    last = {episode.chain: episode.reason for episode in record.episodes if episode.chain not in verified}
    return {" ".join(record.chains[number].subtasks): reason for number, reason in last.items()}
