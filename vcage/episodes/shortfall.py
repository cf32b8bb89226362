"""Episodes that a collection lacks, and why."""

from __future__ import annotations

from collections import Counter

from vcage.base.errors import TooFewVerified
from vcage.episodes.quota import Wanted
from vcage.schema.episodes import Episodes


def shortfall(record: Episodes, wanted: Wanted) -> TooFewVerified | None:
    """Return the error of a collection with fewer verified episodes than were asked for, or None."""
    missing, ran = wanted.missing(record.episodes), len(record.episodes)
    if missing == 0:
        return None
    reasons = Counter(episode.reason for episode in record.episodes if not episode.accepted)
    asked, never = wanted.total, never_verified(record)
    without = f"; none of {len(never)} of {wanted.chains} sub-tasks" if never else ""
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
