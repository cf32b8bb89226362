"""Verbs by which an instruction asks for a goal that is not a place of a thing."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from vcage.models.phrases import compiled, phrase


@dataclass(frozen=True)
class Verb:
    """The verbs that ask for one goal.

    Args:
        words: any that may; a match of the whole word.
        only: phrases that ask for this goal and no other.
    """

    words: re.Pattern[str]
    only: re.Pattern[str] | None = None


def _verb(words: str, *only: str) -> Verb:
    return Verb(compiled(phrase(f"({words})")), compiled(*only) if only else None)


VERBS: Mapping[str, Verb] = {
    "scanned": _verb("scan*", phrase("scan")),
    "weighed": _verb("weigh*", phrase("weigh")),
    "pressed": _verb("press*|push*|ring*|rung*|rang*|click*", phrase("ring", not_before="up"), phrase("press")),
    "open": _verb("open|opened|opening|pull*", phrase("open (the|it|that|both)")),
    "closed": _verb("clos*|shut*|push*", phrase("(shut|close) (the|it|that|both)")),
    "turned": _verb("turn*|switch*|start*|run*", phrase("(turn|switch) on")),
    "back": _verb("back|return*"),
    "presented": _verb("present*|show*|giv*|hand*|offer*"),
}
"""The verbs by the word of the goal."""
