"""Failures of a tool in a hand, made from a hit or a wiping that succeeded in the simulator."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from benchmarks._critic.played import Played, Shots
from vcage.base.geometry import Pose

WITH_TOOL = ("hit", "wiped")
"""Goals for which a tool is used."""

SWEPT_M = (0.05, 0.1)
"""Range of the distance by which a tool sweeps away what it is used on."""


def dropped_tool(played: Played) -> Shots | None:
    """The tool fell on the way, and stayed there."""
    if not is_used(played):
        return None
    tool, after = str(played.subtask.tool), played.shots.after
    lay, held = played.shots.before.objects[tool].p, played.shots.moments[0].objects[tool].p
    x, y, _ = lay + float(played.rng.uniform(0.2, 0.5)) * (held - lay)
    lies = Pose([x, y, lay[2]], Pose.from_yaw([0, 0, 0], played.rng.uniform(0, 2 * np.pi)).q)
    shots = with_tool(played, lambda _: lies, "the tool fell down")
    return replace(shots, after=replace(after, objects={**after.objects, tool: lies}))


def swept(played: Played) -> Shots | None:
    """The tool swept away what it was used on."""
    if not is_used(played):
        return None
    thing, after = played.goal.subject, played.shots.after
    pose = after.objects[thing]
    away = Pose(pose.p + [*played.step(SWEPT_M), 0.0], pose.q)
    return played.untrue("it was swept away", after=replace(after, objects={**after.objects, thing: away}))


def is_used(played: Played) -> bool:
    """True for a hit or a wiping that was done."""
    return played.goal.relation in WITH_TOOL and played.shots.moment is not None


def with_tool(played: Played, moved: Callable[[Pose], Pose], reason: str) -> Shots:
    """The tool elsewhere at each moment, so that nothing was hit or wiped."""
    tool = str(played.subtask.tool)
    now = [replace(one, objects={**one.objects, tool: moved(one.objects[tool])}) for one in played.shots.moments]
    return played.untrue(reason, moments=now)
