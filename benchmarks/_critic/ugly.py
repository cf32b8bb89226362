"""Successes that are hard to see, made by hand of the simulator."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from benchmarks._critic.played import DROP, Kind, Played, Shots
from vcage.base.geometry import Pose
from vcage.plans.actions import HOLDING
from vcage.schema.plan import TABLE


def near_the_rim(played: Played) -> Shots | None:
    """It lies at the edge of its place, turned as it may."""
    return _within(played, lean=False)


def leaning(played: Played) -> Shots | None:
    """It leans in its place."""
    return _within(played, lean=True)


def _within(played: Played, *, lean: bool) -> Shots | None:
    if played.goal.relation not in HOLDING or played.subtask.receptacle in (None, TABLE):
        return None
    thing, place = played.subject, played.place
    point = place.asset.annotation.functional_point(int(played.subtask.functional_point or 0))
    opening = place.asset.opening(point)
    spare = np.maximum(np.array(opening.size) - np.sort(thing.asset.size[:2])[0], 0) / 2
    x, y = np.array(opening.centre) + spare * played.rng.choice([-1.0, 1.0], 2) * played.rng.uniform(0.5, 1.0, 2)
    at = place.frame(point.id).apply([x, y, opening.floor + (opening.depth / 2 if lean else 0.0) + DROP])
    pose = Pose.from_yaw(at, played.rng.uniform(0, 2 * np.pi))
    return played.instead({thing.id: played.leaning(pose) if lean else pose})


UGLY: Mapping[str, Kind] = {"near the rim": near_the_rim, "leaning": leaning}
"""Successes that are hard to see, by name."""
