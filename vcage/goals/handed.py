"""Handed: one arm gave an object to another, in the air."""

from __future__ import annotations

from vcage.goals.kind import GoalKind, Shown, State, Stated, too_short
from vcage.goals.thresholds import THRESHOLDS, Thresholds


def _meaning(limits: Thresholds) -> str:
    return f"""
    Handed to an arm: another arm held the thing alone, then this arm held it alone for {limits.handed_s:g} s,
    and in between nothing but hands touched it. Where it is put afterwards does not matter.
    """


def _complaint(goal: Stated, state: State) -> str | None:
    if not state.lasted_s(goal):
        return f"the {goal.reference} arm did not take {goal.subject} from the hand of another"
    return too_short(goal, state, THRESHOLDS.handed_s)


def _happens(goal: Stated, state: State, notes: set[str]) -> bool:
    """True where the arm alone holds what another held alone, and nothing but hands has touched it since."""
    touching = state.touching(goal.subject)
    if not touching or not touching <= {*state.arms}:
        notes.clear()
        return False
    if len(touching) > 1:
        return False
    (arm,) = touching
    held = state.holds(arm, goal.subject)
    if held and arm != goal.reference:
        notes.add("given")
    return held and arm == goal.reference and "given" in notes


HANDED = GoalKind(
    word="handed",
    complaint=_complaint,
    evidence="handed",
    meaning=_meaning,
    says="hand handed pass give transfer arm hands",
    listed='`subject` given to the robot\'s other arm; `reference` is "left" or "right", the arm that has it then.',
    plain="{thing} was handed to the {reference} arm",
    commands="Hand {0} to the {2} arm, which puts it down.|Hand {0} over to the {2} arm.|Pass {0} to the {2} arm."
    "|Give {0} to the {2} arm.|Hand {0} from one arm to the other.|Pass {0} from hand to hand."
    "|Let the {2} arm take {0} over from the other arm.|Please hand {0} to the {2} arm."
    "|Could you pass {0} to the {2} arm?|Move {0} over into the {2} arm's gripper.|Transfer {0} to the {2} arm."
    "|{1} is handed over to the {2} arm.",
    refers_to="arm",
    event=True,
    happens=_happens,
    shown=Shown(customer=True, moment=True, in_the_air=True),
)
