"""Things with a closed handle: the ways on which one is slid over a peg, and the test that it hangs there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Pose, frame_from_axes
from vcage.objects.convex import centre_of_mass
from vcage.objects.pegs import Loop, Peg, depth_through, loops_of, pegs_of
from vcage.schema.asset import ContactPoint
from vcage.schema.robot import Gripper
from vcage.tasks.scene_objects import SceneObject


@dataclass(frozen=True)
class HangingSettings:
    """The way of a loop over a peg.

    Args:
        before_m: distance of the loop's middle from the tip, along the peg, where the way begins.
        step_m: between two poses along the peg.
        depths_m: of the loop behind the tip when it is let go, in the order to try: the deepest first, since what
            hangs on a rising peg slides on to the post.
        gap_m: between loop and peg when it is let go.
        from_post_m: distances from the post at which what hangs comes to rest: its body leans on that.
        turns: about the peg that are tried for the one at which its weight is lowest.
        room_m: least gap between a peg in the middle of a loop and that all around.
    """

    before_m: float = 0.03
    step_m: float = 0.02
    depths_m: tuple[float, ...] = (0.06, 0.05, 0.04, 0.03)
    gap_m: float = 0.002
    from_post_m: tuple[float, ...] = (0.012, 0.022, 0.032)
    turns: int = 72
    room_m: float = 0.003


SETTINGS = HangingSettings()


def hangs_on(thing: SceneObject, rack: SceneObject) -> bool:
    """True where a peg of a rack passes through a loop of a thing."""
    pegs = [peg.moved(rack.pose) for peg in pegs_of(rack.asset)]
    return any(depth_through(peg, loop, thing.pose) is not None for peg in pegs for loop in loops_of(thing.asset))


def free_pegs(rack: SceneObject, others: Iterable[SceneObject]) -> list[Peg]:
    """The pegs of a rack, in the world, on which none of some other objects hangs."""
    hanging = [(loop, o.pose) for o in others for loop in loops_of(o.asset)]
    pegs = [peg.moved(rack.pose) for peg in pegs_of(rack.asset)]
    return [peg for peg in pegs if all(depth_through(peg, loop, pose) is None for loop, pose in hanging)]


def suits(loop: Loop, peg: Peg) -> bool:
    """True where a peg passes through a loop with room all around."""
    return loop.narrowest - peg.radius >= SETTINGS.room_m


def leaves_free(contact: ContactPoint, loop: Loop, gripper: Gripper) -> bool:
    """True where a hand that holds a thing at a contact point has no finger in a loop of it, or around that."""
    away = float(np.linalg.norm(np.array(contact.position) - loop.frame.p))
    return away - gripper.finger_width / 2 > float(loop.reaches.max())


def hanging_ways(thing: SceneObject, rack: SceneObject, others: Sequence[SceneObject]) -> Iterator[list[Pose]]:
    """Ways of an upright thing to a peg: its poses from before the tip to where it is let go.

    Args:
        thing: as it stands.
        rack: with the pegs.
        others: what may hang there.
    """
    for depth in SETTINGS.depths_m:
        for peg in free_pegs(rack, others):
            for loop in loops_of(thing.asset):
                if suits(loop, peg) and depth < peg.length:
                    yield from (_way(loop, peg, depth, turned) for turned in (1, -1))


def _way(loop: Loop, peg: Peg, depth: float, turned: int) -> list[Pose]:
    """The poses of a thing whose loop slides over a peg, on one or the other of its sides."""
    through, along = loop.frame.rotation()[:2, 2], turned * peg.axis[:2]
    turn = np.arctan2(along[1], along[0]) - np.arctan2(through[1], through[0])
    upright = Pose.from_yaw([0, 0, 0], float(turn))
    middle = upright.apply(loop.frame.p)
    count = 1 + int(np.ceil((depth + SETTINGS.before_m) / SETTINGS.step_m))
    slid = [Pose(peg.at(at) - middle, upright.q) for at in np.linspace(-SETTINGS.before_m, depth, count)]
    thick = peg.radius / np.hypot(*peg.axis[:2])  # half of a vertical cut through a rising peg
    down = np.array([0.0, 0.0, loop.up - thick - SETTINGS.gap_m])
    return [*slid, Pose(slid[-1].p - down, upright.q)]


def hung_poses(thing: SceneObject, rack: SceneObject, others: Iterable[SceneObject]) -> Iterator[Pose]:
    """Poses of a thing that hangs at rest on a free peg: its loop across the peg, its weight below that.

    Args:
        thing, rack, others: as of :func:`hanging_ways`.
    """
    pegs = free_pegs(rack, others)
    for gap in SETTINGS.from_post_m:
        for peg in (peg for peg in pegs if gap < peg.length):
            for loop in (loop for loop in loops_of(thing.asset) if suits(loop, peg)):
                yield from (_at_rest(thing, loop, peg, peg.length - gap, turned) for turned in (1, -1))


def _at_rest(thing: SceneObject, loop: Loop, peg: Peg, depth: float, turned: int) -> Pose:
    """The pose of a thing whose loop lies across a peg, its weight as low as it goes."""
    weight = centre_of_mass(thing.asset.pieces)
    across = frame_from_axes([0, 0, 0], turned * peg.axis, [0, 0, 1]) * Pose(q=loop.frame.q).inverse()

    def turned_by(angle: float) -> Pose:
        about = Pose(q=[np.cos(angle / 2), *(np.sin(angle / 2) * peg.axis)]) * across
        up = (about.rotation() @ loop.frame.rotation())[2, :2]
        up /= np.linalg.norm(up)
        bearing = loop.frame.apply([*(up * (loop.reach(up) - peg.radius)), 0.0])
        return Pose(peg.at(depth) - about.apply(bearing), about.q)

    poses = map(turned_by, np.linspace(-np.pi, np.pi, SETTINGS.turns, endpoint=False).tolist())
    return min(poses, key=lambda pose: float(pose.apply(weight)[2]))
