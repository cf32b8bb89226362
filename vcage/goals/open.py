"""Open: a drawer, door, lid or screen is open."""

from __future__ import annotations

from vcage.goals.kind import GoalKind, State, Stated
from vcage.goals.parts import LISTED, of_share, opened
from vcage.goals.thresholds import THRESHOLDS


def _complaint(goal: Stated, state: State) -> str | None:
    return of_share(goal, state, "open", least=THRESHOLDS.opened_share)


OPEN = GoalKind(
    word="open",
    complaint=_complaint,
    evidence="part",
    meaning=opened,
    says="open opened",
    claims="open opened",
    listed=LISTED,
    plain="{thing} is open",
    commands="Open {0}.|Open up {0}.|Pull {0} open.|Get {0} open.|Please open {0}.|{1} should be open."
    "|Make sure {0} is open.|Could you open {0}?|Could you get {0} open?|Have {0} opened.",
    part_of="subject",
    acts_on="open",
    opposite="closed",
)
