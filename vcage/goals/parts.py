"""Goals about a moving part: its joint tells how far it is, as a share of its range."""

from __future__ import annotations

from vcage.goals.kind import State, Stated
from vcage.goals.thresholds import Thresholds

LISTED = "the moving `part` of `subject` (drawer, door, lid, button, dial, lever)."


def part_words(part: str) -> str:
    """Name a moving part in words: ``drawer_top`` is the top drawer."""
    kind, *which = part.split("_")
    return " ".join([*which, kind])


def of_share(goal: Stated, state: State, how: str, *, least: float = -1.0, most: float = 2.0) -> str | None:
    """Why a part is not within two shares of its range; ``how`` names the measured share: open, turned."""
    share = state.share(goal.subject, str(goal.part))
    within = least <= share <= most
    return None if within else f"the {part_words(str(goal.part))} of {goal.subject} is {how} by {100 * share:.0f} %"


def opened(limits: Thresholds) -> str:
    """The meaning of ``open`` and ``turned``."""
    return f"Open, turned: the part is at {100 * limits.opened_share:g} % or more of its way."
