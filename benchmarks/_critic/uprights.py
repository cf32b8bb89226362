"""Ways to fail to stand something up, made by hand of the simulator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks._critic.played import DROP, Played, Shots
from vcage.base.geometry import Pose

TURNED_OVER = [0.0, 1.0, 0.0, 0.0]
"""Half a turn about the x axis, as a quaternion (w, x, y, z)."""

TILT_RAD = np.radians(60.0)
"""Lean of a thing that falls over."""


def still_lying(played: Played) -> Shots | None:
    """It was carried there and put down on its side, as it lay."""
    if not _stands_up(played):
        return None
    where, heading = _middle(played), float(played.rng.uniform(0, 2 * np.pi))
    lying = Pose.from_yaw([*where[:2], played.surface(where, played.subject) + DROP], heading)
    return played.instead({played.goal.subject: lying})


def on_its_head(played: Played) -> Shots | None:
    """It stands there on its head."""
    if not _stands_up(played):
        return None
    thing, after = played.subject, played.ends[1]
    assert thing.asset.standing is not None
    over = Pose([0.0, 0.0, thing.asset.standing.size[2]], TURNED_OVER)
    lying = thing.asset.stands.inverse()
    headed = after * lying.inverse() * over * lying
    shots = played.shots
    poses = {**shots.after.objects, thing.id: headed}
    return played.untrue("it stands on its head", after=replace(shots.after, objects=poses))


def fell_over(played: Played) -> Shots | None:
    """It fell over when it was let go."""
    if not _stands_up(played):
        return None
    after, turn = played.ends[1], float(played.rng.uniform(0, 2 * np.pi))
    axis = np.sin(TILT_RAD / 2) * np.array([np.cos(turn), np.sin(turn), 0.0])
    tipped = Pose(q=[np.cos(TILT_RAD / 2), *axis]) * Pose(q=after.q)
    return played.instead({played.goal.subject: Pose(after.p + [0.0, 0.0, DROP], tipped.q)})


def still_held(played: Played) -> Shots | None:
    """It stands there, and the hand has not let it go."""
    moment = played.shots.moment
    if not _stands_up(played) or moment is None:
        return None
    return played.untrue("it was not let go", after=moment)


def _stands_up(played: Played) -> bool:
    """True for something that was stood up."""
    return played.subject.asset.standing is not None and played.shots.truth.success


def _middle(played: Played) -> np.ndarray:
    """(3,) middle of where it stands afterwards."""
    return played.now(played.shots.after)[played.goal.subject].aabb.mean(axis=0)
