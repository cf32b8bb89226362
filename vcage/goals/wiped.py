"""Wiped: the pad of a tool in a hand passed over the flat top of an object, which stayed where it was."""

from __future__ import annotations

import numpy as np

from vcage.goals.kind import GoalKind, Shown, State, Stated, Thing, cm, degrees, percent
from vcage.goals.thresholds import THRESHOLDS, Thresholds


def _meaning(limits: Thresholds) -> str:
    return f"""
    Wiped: the lower side of a tool that an arm holds lay on the flat top of the thing, and was drawn over
    {percent(limits.wiped_share)} of it or more: `moment` shows it where a stroke begins, and `later` farther on.
    Held over the thing, or beside it, or at one spot alone is not wiped. The thing stayed within
    {cm(limits.wiped_moved_m)} of where it stood, and turned and tipped by less than
    {degrees(limits.wiped_turned_rad)}. It does not matter where the tool was put afterwards: it does not count as
    also moved.
    """


def _happens(goal: Stated, state: State, notes: set[str]) -> bool:
    """True once enough of the top was passed over, for as long as the thing stays.

    ``notes`` keeps the cells that were passed over, and one line that says where the thing stood before.
    """
    thing, (now, total) = state.thing(goal.subject), state.wiping(goal.subject)
    stood = next((note for note in notes if note.startswith("stood ")), None)
    if stood is None or not _stays(thing, np.array(stood.split()[1:], float)):
        notes.clear()
        notes.add(" ".join(["stood", *map(str, [*thing.pose.p, *thing.pose.q])]))
    notes |= {str(cell) for cell in now}
    return total > 0 and len(notes) - 1 >= THRESHOLDS.wiped_share * total


def _stays(thing: Thing, stood: np.ndarray) -> bool:
    """True where a thing is at (7,) its place and orientation before."""
    moved = float(np.linalg.norm(thing.pose.p - stood[:3]))
    turned = 2 * float(np.arccos(np.clip(abs(thing.pose.q @ stood[3:]), 0, 1)))
    return moved <= THRESHOLDS.wiped_moved_m and turned <= THRESHOLDS.wiped_turned_rad


def _complaint(goal: Stated, state: State) -> str | None:
    lasted = state.lasted_s(goal)
    if lasted >= THRESHOLDS.wiped_s:
        return None
    if lasted > 0:
        return f"{goal.subject} did not stay where it was when it was wiped"
    least = percent(THRESHOLDS.wiped_share)
    return f"the pad of a tool in a hand did not pass over {least} of the flat top of {goal.subject} as it lay there"


WIPED = GoalKind(
    word="wiped",
    event=True,
    happens=_happens,
    complaint=_complaint,
    meaning=_meaning,
    evidence="wiped",
    shown=Shown(customer=True, moment=True, later=True),
    tool="wipes",
    stays_m=THRESHOLDS.wiped_moved_m,
    says="wipe wiped wipes clean cleaned cleans",
    claims="wipe wipes wiped",
    gloss=" (with a tool)",
    plain="{thing} was wiped with a tool",
    commands="Wipe {0} with {tool}.|Wipe off {0} with {tool}.|Clean {0} with {tool}.|Use {tool} to wipe {0}."
    "|Take {tool} and wipe {0} with it.|Wipe down {0} with {tool}.|Please wipe {0} with {tool}."
    "|Could you wipe {0} with {tool}?|Give {0} a wipe with {tool}.|Have {0} wiped with {tool}."
    "|With {tool}, wipe {0}.|{1} must be wiped with {tool}.",
)
