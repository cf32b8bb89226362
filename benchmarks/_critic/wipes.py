"""Failures of wiping, made from a wiping that succeeded in the simulator."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from benchmarks._critic.played import Played, Shots
from vcage.base.geometry import Pose
from vcage.sim.state import WorldState
from vcage.tasks.wiping import cells_of, farthest, flat_top, under_pad, wiping_ways

OVER_M = (0.05, 0.1)
"""Range of the height at which a tool is drawn over what it should wipe."""

BESIDE_M = (0.1, 0.25)
"""Range of the distance by which it wipes beside that."""

ON_TOP_SHARE = 0.1
"""Share of a top below which a tool is beside it."""

PUSHED_M = (0.05, 0.1)
"""Range of the distance by which what is wiped is pushed away."""


def wiped_above(played: Played) -> Shots | None:
    """The tool was drawn over it without touching it."""
    if not _wipes(played):
        return None
    up = np.array([0.0, 0.0, played.rng.uniform(*OVER_M)])
    return _with_tool(played, lambda pose: Pose(pose.p + up, pose.q), "the tool was held over it")


def wiped_spot(played: Played) -> Shots | None:
    """The tool rested on one spot."""
    if not _wipes(played):
        return None
    first, last = (pose.p for pose in _ends(played.shots, str(played.subtask.tool)))
    spot = first + float(played.rng.uniform()) * (last - first)
    return _with_tool(played, lambda pose: Pose(spot, pose.q), "one spot was touched")


def wiped_beside(played: Played) -> Shots | None:
    """The table was wiped beside it."""
    if not _wipes(played):
        return None
    tool, thing = played.now(played.shots.before)[str(played.subtask.tool)], played.subject
    aside, low = np.array([*played.step(BESIDE_M), 0.0]), tool.pose.p[2]
    on_top = [tool.moved(Pose(pose.p + aside, pose.q)) for pose in _ends(played.shots, tool.id)]
    if any(len(under_pad(one, thing)) > ON_TOP_SHARE * len(cells_of(thing)) for one in on_top):
        return None
    return _with_tool(played, lambda pose: Pose([*(pose.p + aside)[:2], low], pose.q), "the table was wiped")


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
    return _with_tool(played, lambda _: next(ends), f"{other.id} was wiped")


def dropped_wiper(played: Played) -> Shots | None:
    """The tool fell on the way, and stayed there."""
    if not _wipes(played):
        return None
    tool, after = str(played.subtask.tool), played.shots.after
    lay, held = played.shots.before.objects[tool].p, _ends(played.shots, tool)[0].p
    x, y, _ = lay + float(played.rng.uniform(0.2, 0.5)) * (held - lay)
    lies = Pose([x, y, lay[2]], Pose.from_yaw([0, 0, 0], played.rng.uniform(0, 2 * np.pi)).q)
    shots = _with_tool(played, lambda _: lies, "the tool fell down")
    return replace(shots, after=replace(after, objects={**after.objects, tool: lies}))


def pushed_along(played: Played) -> Shots | None:
    """It was pushed away when it was wiped."""
    if not _wipes(played):
        return None
    thing, after = played.goal.subject, played.shots.after
    pose = after.objects[thing]
    away = Pose(pose.p + [*played.step(PUSHED_M), 0.0], pose.q)
    return played.untrue("it was pushed away", after=replace(after, objects={**after.objects, thing: away}))


def _wipes(played: Played) -> bool:
    """True for wiping that was done."""
    return played.goal.relation == "wiped" and None not in (played.shots.moment, played.shots.later)


def _ends(shots: Shots, tool: str) -> list[Pose]:
    """Poses of a tool at both moments."""
    return [state.objects[tool] for state in (shots.moment, shots.later) if state is not None]


def _with_tool(played: Played, moved: Callable[[Pose], Pose], reason: str) -> Shots:
    """The tool elsewhere at both moments, so that nothing was wiped."""
    tool = str(played.subtask.tool)

    def elsewhere(state: WorldState) -> WorldState:
        return replace(state, objects={**state.objects, tool: moved(state.objects[tool])})

    moment, later = played.shots.moment, played.shots.later
    assert moment is not None and later is not None
    return played.untrue(reason, moment=elsewhere(moment), later=elsewhere(later))
