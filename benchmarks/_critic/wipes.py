"""Failures of wiping, made from a wiping that succeeded in the simulator."""

from __future__ import annotations

import numpy as np

from benchmarks._critic.played import Played, Shots
from benchmarks._critic.tools import is_used, with_tool
from vcage.base.geometry import Pose
from vcage.tasks.wiping import cells_of, farthest, flat_top, under_pad, wiping_ways

OVER_M = (0.05, 0.1)
"""Range of the height at which a tool is drawn over what it should wipe."""

BESIDE_M = (0.1, 0.25)
"""Range of the distance by which it wipes beside that."""

ON_TOP_SHARE = 0.1
"""Share of a top below which a tool is beside it."""


def wiped_above(played: Played) -> Shots | None:
    """The tool was drawn over it without touching it."""
    if not _wipes(played):
        return None
    up = np.array([0.0, 0.0, played.rng.uniform(*OVER_M)])
    return with_tool(played, lambda pose: Pose(pose.p + up, pose.q), "the tool was held over it")


def wiped_spot(played: Played) -> Shots | None:
    """The tool rested on one spot."""
    if not _wipes(played):
        return None
    first, last = (pose.p for pose in _ends(played.shots, str(played.subtask.tool)))
    spot = first + float(played.rng.uniform()) * (last - first)
    return with_tool(played, lambda pose: Pose(spot, pose.q), "one spot was touched")


def wiped_beside(played: Played) -> Shots | None:
    """The table was wiped beside it."""
    if not _wipes(played):
        return None
    tool, thing = played.now(played.shots.before)[str(played.subtask.tool)], played.subject
    aside, low = np.array([*played.step(BESIDE_M), 0.0]), tool.pose.p[2]
    on_top = [tool.moved(Pose(pose.p + aside, pose.q)) for pose in _ends(played.shots, tool.id)]
    if any(len(under_pad(one, thing)) > ON_TOP_SHARE * len(cells_of(thing)) for one in on_top):
        return None
    return with_tool(played, lambda pose: Pose([*(pose.p + aside)[:2], low], pose.q), "the table was wiped")


def wiped_another(played: Played) -> Shots | None:
    """Another thing was wiped."""
    tool = str(played.subtask.tool)
    others = [o for o in played.now(played.shots.before).values() if o.id not in (tool, played.goal.subject)]
    flat = [o for o in others if o.record.container is None and flat_top(o) is not None]
    if not _wipes(played) or not flat:
        return None
    other = flat[int(played.rng.integers(len(flat)))]
    way = next(wiping_ways(played.now(played.shots.before)[tool], other, above_m=0.0), None)
    if way is None:
        return None
    ends = iter([way[0], way[farthest(way)]])
    return with_tool(played, lambda _: next(ends), f"{other.id} was wiped")


def _wipes(played: Played) -> bool:
    """True for wiping that was done."""
    return played.goal.relation == "wiped" and is_used(played) and played.shots.later is not None


def _ends(shots: Shots, tool: str) -> list[Pose]:
    """Poses of a tool at both moments."""
    return [state.objects[tool] for state in shots.moments]
