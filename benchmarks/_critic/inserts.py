"""Failures of inserting, made from an insertion that succeeded in the simulator."""

from __future__ import annotations

import numpy as np

from benchmarks._critic.played import DROP, Played, Shots
from vcage.base.geometry import Pose
from vcage.tasks.scene_objects import SceneObject

BESIDE_M = (0.12, 0.17)
"""Range of the distance from the middle of the block at which a peg lies beside it."""

PUSHED_M = (0.09, 0.13)
"""Range of the distance by which the block is pushed away with the peg in it."""

DRAWN_OUT_M = (0.035, 0.05)
"""Range of the distance by which the peg is drawn out of the hole, so that half of that or less is filled."""

BEFORE_M = (0.09, 0.11)
"""Range of the distance, along the hole, at which a peg lies on the table before its mouth."""


def lies_beside(played: Played) -> Shots | None:
    """It lies on the table beside the block."""
    if not _is_inserted(played):
        return None
    at = _block(played).pose.p[:2] + played.step(BESIDE_M)
    lies = np.array([*at, played.surface(at, played.subject)])
    return _settled(played, Pose.from_yaw(lies, played.rng.uniform(0, 2 * np.pi)))


def lies_before_the_hole(played: Played) -> Shots | None:
    """It lies on the table before the hole, in line with that seen from above."""
    if not _is_inserted(played):
        return None
    there = played.ends[1]
    out = _outwards(played) * [1.0, 1.0, 0.0]
    at = (there.p + played.rng.uniform(*BEFORE_M) * out / np.linalg.norm(out))[:2]
    lies = np.array([*at, played.surface(at, played.subject)])
    return _settled(played, Pose.from_yaw(lies, there.yaw))


def lies_on_top(played: Played) -> Shots | None:
    """It lies on the block."""
    if not _is_inserted(played):
        return None
    block = _block(played)
    lies = np.array([*block.pose.p[:2], block.around_boxes[1, 2] + DROP / 10])
    return _settled(played, Pose.from_yaw(lies, played.rng.uniform(0, 2 * np.pi)))


def half_in(played: Played) -> Shots | None:
    """It sticks in the mouth of the hole: half of that or less is filled."""
    if not _is_inserted(played):
        return None
    there = played.ends[1]
    return _settled(played, Pose(there.p + played.rng.uniform(*DRAWN_OUT_M) * _outwards(played), there.q))


def block_pushed(played: Played) -> Shots | None:
    """It is in the hole, and the block was pushed away."""
    if not _is_inserted(played):
        return None
    block, way = _block(played), np.append(played.step(PUSHED_M), 0.0)
    moved = {block.id: block.pose, played.goal.subject: played.ends[1]}
    shots = played.instead({name: Pose(pose.p + way, pose.q) for name, pose in moved.items()})
    return None if shots.truth.success else shots


def _is_inserted(played: Played) -> bool:
    """True for an insertion that was done."""
    return played.goal.relation == "inserted_in" and played.shots.truth.success


def _block(played: Played) -> SceneObject:
    return played.now(played.shots.after)[str(played.goal.reference)]


def _outwards(played: Played) -> np.ndarray:
    """(3,) unit vector along the peg, out of the mouth into which it was slid."""
    there = played.ends[1]
    along = there.rotation()[:, 0]
    return along if along @ (there.p - _block(played).pose.p) > 0 else -along


def _settled(played: Played, pose: Pose) -> Shots | None:
    """The thing put somewhere by hand and left to come to rest; None where it is inserted there."""
    shots = played.instead({played.goal.subject: pose})
    return None if shots.truth.success else shots
