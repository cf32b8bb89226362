"""Verdicts and acceptance that a person decided by editing a file."""

from __future__ import annotations

from typing import TypeVar

from vcage.schema.episodes import BY_HAND, Episode, Verdict

DECISIONS = ("accepted", "reason", "confidence")
"""Fields of an episode or a verdict that a person decides; all else was recorded."""

D = TypeVar("D", Episode, Verdict)


def decided(was: D, now: D) -> D:
    """Return a decision that may have been edited, with a reason of its own and with who decided.

    Args:
        was: as it was written.
        now: as it is in the edited file.
    """
    if now == was:
        return was
    reason = now.reason
    if was.accepted != now.accepted and was.reason == now.reason:  # which says why of the contrary
        reason = "accepted by hand" if now.accepted else "refused by hand"
    decision = {"reason": reason}
    if isinstance(now, Verdict):
        decision |= {"provider": BY_HAND, "failure": None if now.accepted else now.failure}
    return now.model_copy(update=decision)
