"""Failures of hanging, made from a hanging that succeeded in the simulator."""

from __future__ import annotations

import numpy as np

from benchmarks._critic.played import DROP, Played, Shots
from vcage.base.geometry import Pose
from vcage.tasks.scene_objects import SceneObject

BESIDE_M = (0.11, 0.16)
"""Range of the distance from the rack's post at which a thing stands or lies beside the rack."""

AGAINST_M = 0.06
"""Distance from the post at which a thing leans on it or on a peg."""


def stood_beside(played: Played) -> Shots | None:
    """It stands on the table beside the rack."""
    if not _hangs(played):
        return None
    at, heading = _beside(played, played.step(BESIDE_M)), played.rng.uniform(0, 2 * np.pi)
    return _settled(played, Pose.from_yaw(at, heading))


def fell_beside(played: Played) -> Shots | None:
    """It fell off the peg, and lies beside the rack."""
    if not _hangs(played):
        return None
    at = _beside(played, played.step(BESIDE_M)) + [0.0, 0.0, DROP]
    on_its_side = Pose(q=[np.cos(np.pi / 4), np.sin(np.pi / 4), 0.0, 0.0])
    heading = Pose.from_yaw([0, 0, 0], played.rng.uniform(0, 2 * np.pi))
    return _settled(played, Pose(at, (heading * on_its_side).q))


def leans_on_it(played: Played) -> Shots | None:
    """It leans on the post or a peg, which does not pass through its handle."""
    if not _hangs(played):
        return None
    way = played.step((AGAINST_M, AGAINST_M))
    heading = Pose.from_yaw([0, 0, 0], played.rng.uniform(0, 2 * np.pi))
    return _settled(played, played.leaning(Pose(_beside(played, way) + [0.0, 0.0, DROP], heading.q), most=0.5))


def still_in_the_hand(played: Played) -> Shots | None:
    """It was slid over the peg, or into the hole, and the hand did not let it go."""
    shots = played.shots
    slid = played.goal.relation in ("hung_on", "inserted_in")
    if not slid or not shots.truth.success or shots.moment is None:
        return None
    return played.untrue("the hand still holds it", after=shots.moment)


def _hangs(played: Played) -> bool:
    """True for a hanging that was done."""
    return played.goal.relation == "hung_on" and played.shots.truth.success


def _rack(played: Played) -> SceneObject:
    return played.now(played.shots.after)[str(played.goal.reference)]


def _beside(played: Played, way: np.ndarray) -> np.ndarray:
    """(3,) a point over the table, on a way (2,) from the rack's post."""
    at = _rack(played).pose.p[:2] + way
    return np.array([*at, played.surface(at, played.subject)])


def _settled(played: Played, pose: Pose) -> Shots | None:
    """The thing put somewhere by hand and left to come to rest; None where it hangs there."""
    shots = played.instead({played.goal.subject: pose})
    return None if shots.truth.success else shots
