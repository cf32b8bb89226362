"""Failures of a hit, made from a hit that succeeded in the simulator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benchmarks._critic.played import Played, Shots
from vcage.base.geometry import Pose
from vcage.tasks.hitting import hits, hitting_poses

BESIDE_M = (0.04, 0.1)
"""Range of the distance by which a head comes down beside what it should hit."""

OVER_M = (0.05, 0.1)
"""Range of the height at which it stops over that."""

SWEPT_M = (0.05, 0.1)
"""Range of the distance by which what is hit is swept away."""


def hit_beside(played: Played) -> Shots | None:
    """The head came down beside it."""
    held = _held(played)
    if held is None:
        return None
    shots = _with_tool(played, Pose(held.p + [*played.step(BESIDE_M), 0.0], held.q), "it was hit beside")
    return None if _hits(played, shots) else shots


def not_down(played: Played) -> Shots | None:
    """The head stopped over it."""
    held = _held(played)
    if held is None:
        return None
    up = float(played.rng.uniform(*OVER_M))
    return _with_tool(played, Pose(held.p + [0.0, 0.0, up], held.q), "the head stopped over it")


def hit_another(played: Played) -> Shots | None:
    """The head came down on another thing."""
    tool, held = str(played.subtask.tool), _held(played)
    others = [o for o in played.loose if o.id not in (tool, played.goal.subject)]
    if held is None or not others:
        return None
    other = others[int(played.rng.integers(len(others)))]
    thing = played.now(played.shots.before)[tool].moved(held)
    shots = _with_tool(played, next(hitting_poses(thing, other, above_m=0.0)), "another thing was hit")
    return None if _hits(played, shots) else shots


def dropped_tool(played: Played) -> Shots | None:
    """The tool fell on the way, and stayed there."""
    held = _held(played)
    if held is None:
        return None
    tool, after = str(played.subtask.tool), played.shots.after
    lay = played.shots.before.objects[tool]
    x, y, _ = lay.p + float(played.rng.uniform(0.2, 0.5)) * (held.p - lay.p)
    lies = Pose([x, y, lay.p[2]], Pose.from_yaw([0, 0, 0], played.rng.uniform(0, 2 * np.pi)).q)
    shots = _with_tool(played, lies, "the tool fell down")
    return replace(shots, after=replace(after, objects={**after.objects, tool: lies}))


def swept(played: Played) -> Shots | None:
    """It was swept away when it was hit."""
    if _held(played) is None:
        return None
    thing, after = played.goal.subject, played.shots.after
    pose = after.objects[thing]
    away = Pose(pose.p + [*played.step(SWEPT_M), 0.0], pose.q)
    return played.untrue("it was swept away", after=replace(after, objects={**after.objects, thing: away}))


def _held(played: Played) -> Pose | None:
    """The pose of the tool at the moment of a hit; None of anything else."""
    moment = played.shots.moment
    return None if played.goal.relation != "hit" or moment is None else moment.objects[str(played.subtask.tool)]


def _with_tool(played: Played, pose: Pose, reason: str) -> Shots:
    """The tool elsewhere at the moment, so that it was no hit."""
    moment = played.shots.moment
    assert moment is not None
    return played.untrue(reason, moment=replace(moment, objects={**moment.objects, str(played.subtask.tool): pose}))


def _hits(played: Played, shots: Shots) -> bool:
    """True where the head is over the thing at the moment."""
    assert shots.moment is not None
    now = played.now(shots.moment)
    return hits(now[str(played.subtask.tool)], now[played.goal.subject])
