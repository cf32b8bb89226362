"""Hit: the head of a tool in a hand came down on the middle of an object, which stayed where it was."""

from __future__ import annotations

import numpy as np

from vcage.goals.kind import GoalKind, Shown, State, Stated, Thing, cm, degrees
from vcage.goals.thresholds import THRESHOLDS, Thresholds


def _meaning(limits: Thresholds) -> str:
    return f"""
    Hit: the head of a tool that an arm holds touched the thing from above, the middle of the head at most
    {cm(limits.hit_off_m)} beside the middle of the thing; `moment` shows it. The thing stayed within
    {cm(limits.hit_moved_m)} of where it stood, and upright to within {degrees(limits.tipped_rad)}. It does not matter
    where the tool was put afterwards: it does not count as also moved.
    """


def _happens(goal: Stated, state: State, notes: set[str]) -> bool:
    """True from the touch on, for as long as the thing stays.

    ``notes`` keeps one line: ``hit``; ``free``; or ``pushed`` while the head is on a thing that did not stay, which is
    no new hit; and where the thing stood before the touch.
    """
    thing, touched = state.thing(goal.subject), state.is_hit(goal.subject)
    before, _, stood = next(iter(notes), "").partition(" ")
    hit = before == "hit" or (before == "free" and touched)
    if not hit or not _stays(thing, np.array(stood.split(), float)):
        hit, stood = False, " ".join(map(str, _standing(thing).tolist()))
    now = "hit" if hit else "pushed" if touched else "free"
    notes.clear()
    notes.add(f"{now} {stood}")
    return hit


def _standing(thing: Thing) -> np.ndarray:
    """(6,) where a thing stands, and the direction of its axis."""
    return np.concatenate([thing.pose.p, thing.pose.rotation()[:, 2]])


def _stays(thing: Thing, stood: np.ndarray) -> bool:
    """True where a thing is as (6,) its place and axis were."""
    now = _standing(thing)
    tilt = np.arccos(np.clip(now[3:] @ stood[3:], -1, 1))
    return bool(np.linalg.norm(now[:3] - stood[:3]) <= THRESHOLDS.hit_moved_m and tilt <= THRESHOLDS.tipped_rad)


def _complaint(goal: Stated, state: State) -> str | None:
    lasted = state.lasted_s(goal)
    if lasted >= THRESHOLDS.hit_s:
        return None
    if lasted > 0:
        return f"{goal.subject} did not stay where it was when it was hit"
    return f"no head of a tool in a hand touched the middle of {goal.subject}"


HIT = GoalKind(
    word="hit",
    event=True,
    happens=_happens,
    complaint=_complaint,
    meaning=_meaning,
    evidence="hit",
    shown=Shown(customer=True, moment=True),
    tool="hits",
    stays_m=THRESHOLDS.hit_moved_m,
    says="hit hits beat beats strike strikes tap taps",
    claims="beat beats strike strikes",
    gloss=" (with a tool)",
    plain="{thing} was hit with a tool",
    commands="Hit {0} with {tool}.|Beat {0} with {tool}.|Tap {0} with {tool}.|Use {tool} to hit {0}."
    "|Take {tool} and hit {0} with it.|Strike {0} with {tool}.|Please hit {0} with {tool}."
    "|Could you hit {0} with {tool}?|Give {0} a tap with {tool}.|Have {0} hit with {tool}."
    "|With {tool}, hit {0}.|{1} must be hit with {tool}.",
)
