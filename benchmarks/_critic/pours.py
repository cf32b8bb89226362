"""Failures of pouring, made from a pouring that succeeded in the simulator."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from benchmarks._critic.played import Played, Shots
from vcage.base.geometry import Pose
from vcage.sim.state import WorldState
from vcage.tasks.pouring import balls_in
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.stowing import heaped_in, open_point

MISSED_M = (0.02, 0.08)
"""Range of the distance from the container at which balls lie beside it."""


def poured_nothing(played: Played) -> Shots | None:
    """All stayed in the vessel."""
    if not _pours(played):
        return None
    return _with_balls(played, _still_in(played, _balls(played)), "nothing was poured")


def poured_half(played: Played) -> Shots | None:
    """Some of the balls stayed in the vessel."""
    some = _some(played)
    return None if not some else _with_balls(played, _still_in(played, some), "not all was poured")


def missed(played: Played) -> Shots | None:
    """All fell on the table beside the container."""
    if not _pours(played):
        return None
    shots = _with_balls(played, _beside(played, _balls(played)), "it was poured beside the container")
    vessel, aside = played.goal.subject, np.array([*played.step((0.15, 0.25)), 0.0])
    assert shots.moment is not None
    held = shots.moment.objects[vessel]
    moment = replace(shots.moment, objects={**shots.moment.objects, vessel: Pose(held.p + aside, held.q)})
    return replace(shots, moment=moment)


def half_beside(played: Played) -> Shots | None:
    """Some of the balls fell on the table beside the container."""
    some = _some(played)
    return None if not some else _with_balls(played, _beside(played, some), "some fell beside the container")


def vessel_dropped(played: Played) -> Shots | None:
    """The vessel fell down when it was empty, and lies on its side."""
    if not _pours(played):
        return None
    vessel, after = played.subject, played.shots.after
    angle = float(played.rng.uniform(0, 2 * np.pi))
    lies = Pose.from_yaw([0, 0, 0], angle) * Pose(q=[np.cos(np.pi / 4), np.sin(np.pi / 4), 0.0, 0.0])
    lying = vessel.moved(lies)
    low = vessel.pose.p + [*played.step((0.0, 0.04)), played.table - lying.lowest - vessel.pose.p[2]]
    poses = {**after.objects, vessel.id: Pose(low, lies.q)}
    return played.untrue("the vessel fell down", after=replace(after, objects=poses))


def poured_elsewhere(played: Played) -> Shots | None:
    """It was poured into another container."""
    if not _pours(played):
        return None
    balls, now = _balls(played), played.now(played.shots.after)
    mine = {played.goal.subject, played.goal.reference}
    others = [o for o in now.values() if o.id not in mine and open_point(o.asset) is not None]
    wide = [o for o in others if min(o.asset.size[:2]) > min(played.subject.asset.size[:2])]
    if not wide:
        return None
    other = wide[int(played.rng.integers(len(wide)))]
    return _with_balls(played, heaped_in(other, balls, played.rng), f"it was poured into {other.id}")


def _pours(played: Played) -> bool:
    """True for a pouring that was done."""
    return played.goal.relation == "poured" and played.shots.moment is not None


def _balls(played: Played) -> list[SceneObject]:
    """The balls that were poured, as they lay before."""
    now = played.now(played.shots.before)
    return balls_in(now[played.goal.subject], [o for o in now.values() if o.id != played.goal.subject])


def _some(played: Played) -> list[SceneObject]:
    """About half of the balls that were poured, of at least two; none of fewer."""
    balls = _balls(played) if _pours(played) else []
    return [balls[int(i)] for i in played.rng.permutation(len(balls))[: (len(balls) + 1) // 2]] if balls[1:] else []


def _still_in(played: Played, balls: Iterable[SceneObject]) -> dict[str, Pose]:
    """Poses of balls that stay in the vessel, by id: as they lay there before."""
    vessel = played.goal.subject
    way = played.shots.after.objects[vessel] * played.shots.before.objects[vessel].inverse()
    return {ball.id: way * ball.pose for ball in balls}


def _beside(played: Played, balls: Iterable[SceneObject]) -> dict[str, Pose]:
    """Poses of balls on the table around the container, by id."""
    target = played.now(played.shots.after)[str(played.goal.reference)]
    middle, reach = target.around_boxes[:, :2].mean(axis=0), np.ptp(target.around_boxes[:, :2], axis=0) / 2
    found: dict[str, Pose] = {}
    turn = played.rng.uniform(0, 2 * np.pi)
    for number, ball in enumerate(balls):
        angle = turn + 0.5 * number
        way = np.array([np.cos(angle), np.sin(angle)])
        away = float(np.linalg.norm(reach)) + float(played.rng.uniform(*MISSED_M))
        found[ball.id] = Pose([*(middle + away * way), played.table], ball.pose.q)
    return found


def _with_balls(played: Played, poses: Mapping[str, Pose], reason: str) -> Shots:
    """Some of the balls elsewhere afterwards; those that stay in the vessel are in it at the moment."""
    vessel, shots = played.goal.subject, played.shots
    moment = shots.moment
    assert moment is not None
    carried = {
        name: moment.objects[vessel] * shots.after.objects[vessel].inverse() * pose
        for name, pose in poses.items()
        if _is_within(played.now(shots.after)[vessel], pose)
    }

    def at(state: WorldState, where: Mapping[str, Pose]) -> WorldState:
        return replace(state, objects={**state.objects, **where})

    return played.untrue(reason, after=at(shots.after, poses), moment=at(moment, {**poses, **carried}))


def _is_within(vessel: SceneObject, pose: Pose) -> bool:
    """True for a pose inside the outline of a vessel, seen from above."""
    lower, upper = vessel.around_boxes[:, :2]
    return bool(np.all((lower <= pose.p[:2]) & (pose.p[:2] <= upper)))
