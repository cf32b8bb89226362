"""Ways to fail at a shake that are made by hand of the simulator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks._critic.played import Played, Shots
from vcage.base.geometry import Pose
from vcage.sim.state import WorldState

ROUND_SHARE = 0.2
"""An object whose sides differ by less, in shares of the longest, counts as a ball."""


def hung_still(played: Played) -> Shots | None:
    """It was lifted, and the hand that held it stood still."""
    if not _is_shaken(played):
        return None
    there, back = played.shots.moments
    joints = {name: (there.joints[name] + back.joints[name]) / 2 for name in there.joints}
    between = replace(_upright(played, there, (_middle(played, there) + _middle(played, back)) / 2), joints=joints)
    return played.untrue("it was not tilted", moments=[between, between])


def leaned_once(played: Played) -> Shots | None:
    """It was tilted to one side, and stayed so."""
    return played.untrue("it was tilted once", later=played.shots.moment) if _is_shaken(played) else None


def hung_plumb(played: Played) -> Shots | None:
    """The hand swung to and fro, and it hung upright in it all the time; not of a ball, which looks as if it leaned."""
    if not _is_shaken(played) or np.ptp(played.subject.asset.size) < ROUND_SHARE * max(played.subject.asset.size):
        return None
    there, back = (_upright(played, state, _middle(played, state)) for state in played.shots.moments)
    return played.untrue("the hand alone was tilted", moments=[there, back])


def _is_shaken(played: Played) -> bool:
    """True where both leans of a shake are seen."""
    return played.goal.relation == "shaken" and len(played.shots.moments) == 2


def _middle(played: Played, state: WorldState) -> np.ndarray:
    """(3,) middle of the object, in the world."""
    return state.objects[played.goal.subject].apply(played.subject.asset.bounds.mean(axis=0))


def _upright(played: Played, state: WorldState, middle: np.ndarray) -> WorldState:
    """The state with the object as it stood before, about a middle (3,)."""
    thing = played.subject
    offset = Pose(q=thing.pose.q).apply(thing.asset.bounds.mean(axis=0))
    return replace(state, objects={**state.objects, thing.id: Pose(middle - offset, thing.pose.q)})
