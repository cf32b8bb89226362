"""What a sub-task is called: one sentence for the critic and the log, and others that say the same, for training."""

from __future__ import annotations

from collections.abc import Mapping

from vcage.schema.goals import Goal, part_words

_INTO = ("into", "in", "inside")
_ONTO = ("onto", "on", "on top of")
_MOVES = ("Put", "Place", "Set", "Move", "Bring", "Transfer", "Take")
_PATTERNS: Mapping[str, str] = {
    "open": "Open {0}.|Open up {0}.|Pull {0} open.|Get {0} open.|Please open {0}.|{1} should be open."
    "|Make sure {0} is open.|Could you open {0}?|Bring {0} into its open position.|Have {0} opened.",
    "closed": "Close {0}.|Shut {0}.|Push {0} shut.|Get {0} closed.|Please close {0}.|{1} should be closed."
    "|Make sure {0} is closed.|Could you shut {0}?|Bring {0} back into its closed position.|Have {0} closed.",
    "pressed": "Press {0}.|Push {0}.|Push down {0}.|Press {0} down.|Press down on {0}.|Please press {0}."
    "|Give {0} a press.|Could you press {0}?|Hit {0}.|Have {0} pressed.",
    "turned": "Turn {0}.|Turn {0} on.|Rotate {0}.|Twist {0}.|Give {0} a turn.|Please turn {0}."
    "|Turn {0} as far as it goes.|Could you turn {0}?|Swing {0} round.|Have {0} turned.",
}


def wordings(goal: Goal, phrases: Mapping[str, str]) -> list[str]:
    """Sentences that ask for a goal, ten and more, the plainest first.

    Args:
        goal: of the closed vocabulary.
        phrases: what to call each object, by id.
    """
    if goal.relation in ("inside", "on"):
        return _placing(goal, phrases)
    part = f"the {part_words(goal.part or '')} of the {phrases[goal.subject]}"
    return [p.format(part, part[0].upper() + part[1:]) for p in _PATTERNS[goal.relation].split("|")]


def _placing(goal: Goal, phrases: Mapping[str, str]) -> list[str]:
    thing = f"the {phrases[goal.subject]}"
    owner = phrases.get(goal.reference or "", str(goal.reference))
    place = f"the {part_words(goal.part)} of the {owner}" if goal.part else f"the {owner}"
    preps = _INTO if goal.relation == "inside" else _ONTO
    commands = [f"{move} {thing} {prep} {place}." for prep in preps for move in _MOVES[: 7 if prep == preps[0] else 3]]
    wishes = [
        f"Pick up {thing} and put it {preps[0]} {place}.",
        f"T{thing[1:]} goes {preps[1]} {place}.",
        f"Could you put {thing} {preps[1]} {place}?",
    ]
    return [*commands, *wishes]
