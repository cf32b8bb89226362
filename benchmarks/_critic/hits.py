"""Failures of a hit, made from a hit that succeeded in the simulator."""

from __future__ import annotations

from benchmarks._critic.played import Played, Shots
from benchmarks._critic.tools import is_used, with_tool
from vcage.base.geometry import Pose
from vcage.tasks.hitting import hits, hitting_poses

BESIDE_M = (0.04, 0.1)
"""Range of the distance by which a head comes down beside what it should hit."""

OVER_M = (0.05, 0.1)
"""Range of the height at which it stops over that."""


def hit_beside(played: Played) -> Shots | None:
    """The head came down beside it."""
    held = _held(played)
    if held is None:
        return None
    beside = Pose(held.p + [*played.step(BESIDE_M), 0.0], held.q)
    shots = with_tool(played, lambda _: beside, "it was hit beside")
    return None if _hits(played, shots) else shots


def not_down(played: Played) -> Shots | None:
    """The head stopped over it."""
    held = _held(played)
    if held is None:
        return None
    up = float(played.rng.uniform(*OVER_M))
    return with_tool(played, lambda _: Pose(held.p + [0.0, 0.0, up], held.q), "the head stopped over it")


def hit_another(played: Played) -> Shots | None:
    """The head came down on another thing."""
    tool, held = str(played.subtask.tool), _held(played)
    others = [o for o in played.loose if o.id not in (tool, played.goal.subject)]
    if held is None or not others:
        return None
    other = others[int(played.rng.integers(len(others)))]
    thing = played.now(played.shots.before)[tool].moved(held)
    there = next(hitting_poses(thing, other, above_m=0.0))
    shots = with_tool(played, lambda _: there, "another thing was hit")
    return None if _hits(played, shots) else shots


def _held(played: Played) -> Pose | None:
    """The pose of the tool at the moment of a hit; None of anything else."""
    if played.goal.relation != "hit" or not is_used(played):
        return None
    return played.shots.moments[0].objects[str(played.subtask.tool)]


def _hits(played: Played, shots: Shots) -> bool:
    """True where the head is over the thing at the moment."""
    assert shots.moment is not None
    now = played.now(shots.moment)
    return hits(now[str(played.subtask.tool)], now[played.goal.subject])
