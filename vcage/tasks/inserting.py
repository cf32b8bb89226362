"""Things with a shaft: the ways on which one is slid into a hole, and how far it is in that."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from vcage.base.geometry import Pose, frame_from_axes
from vcage.goals.kind import Inserted
from vcage.objects.holes import Hole, Shaft, holes_of, shafts_of
from vcage.schema.asset import ContactPoint
from vcage.tasks.scene_objects import SceneObject


@dataclass(frozen=True)
class InsertingSettings:
    """The way of a shaft into a hole.

    Args:
        room_m: least gap between a shaft in line with a hole and the wall all around: hands bring a shaft into line to
            a millimetre or two, and bevels guide it.
        before_m: distance of the end that goes in from the mouth where the way begins.
        step_m: between two poses of the way.
        shares: of the hole's depth at which the end is let go, in the order to try. Beyond 1 it sticks out of the other
            side; at 1.25 a peg of 14 cm has its middle inside a hole of 6 cm, and lies flat in it.
        hand_m: length of the shaft between the mouth and the contact point that a hand needs: half the width of a
            finger, and a gap.
        seen_shares: of the hole's depth at which pictures are compared with drawings of the end; negative before it.
    """

    room_m: float = 0.002
    before_m: float = 0.03
    step_m: float = 0.02
    shares: tuple[float, ...] = (1.25, 1.15, 1.0, 0.9)
    hand_m: float = 0.016
    seen_shares: tuple[float, ...] = tuple(np.arange(-0.5, 1.41, 0.1).round(1).tolist())


SETTINGS = InsertingSettings()


def suits(shaft: Shaft, hole: Hole) -> bool:
    """True where a shaft goes into a hole with room all around."""
    return hole.passes(shaft, SETTINGS.room_m)


def inserted(thing: SceneObject, place: SceneObject) -> Inserted | None:
    """How the shaft of a thing lies in the hole of a place in which it is deepest; None where one has none."""
    pairs = product(shafts_of(thing.asset), holes_of(place.asset))
    found = (_lies(shaft, thing.pose, hole, place.pose) for shaft, hole in pairs)
    return max(found, key=lambda lies: lies.share, default=None)


def _lies(shaft: Shaft, at: Pose, hole: Hole, there: Pose) -> Inserted:
    start, end = (there * hole.loop.frame).inverse().apply(shaft.ends(at))
    start, end = (start, end) if start[2] <= end[2] else (end, start)
    along = (end - start) / np.linalg.norm(end - start)
    low, high = max(start[2], hole.ends[0]), min(end[2], hole.ends[1])
    if along[2] < 1e-6 or high <= low:
        return Inserted(0.0, float("inf"), float(np.arccos(np.clip(along[2], -1, 1))))
    aside = max(float(np.linalg.norm((start + (z - start[2]) / along[2] * along)[:2])) for z in (low, high))
    share = (high - low) / hole.depth if aside < hole.loop.reaches.max() else 0.0
    return Inserted(float(share), float(aside), float(np.arccos(np.clip(along[2], -1, 1))))


def free_holes(place: SceneObject, others: Iterable[SceneObject]) -> list[Hole]:
    """The holes of a place in which no shaft of some other objects is."""
    inside = [(shaft, o.pose) for o in others if o.id != place.id for shaft in shafts_of(o.asset)]
    return [
        hole
        for hole in holes_of(place.asset)
        if all(_lies(shaft, pose, hole, place.pose).share <= 0 for shaft, pose in inside)
    ]


def inserting_ways(
    thing: SceneObject, place: SceneObject, contact: ContactPoint, others: Sequence[SceneObject]
) -> Iterator[list[Pose]]:
    """Ways of a thing into a free hole: its poses, from before a mouth to where it is let go.

    Args:
        thing: as it lies.
        place: with the holes.
        contact: where the thing is held: what goes in is on the other side of its middle.
        others: all other objects.
    """
    pairs = [pair for pair in product(shafts_of(thing.asset), free_holes(place, others)) if suits(*pair)]
    for share, (shaft, hole) in product(SETTINGS.shares, pairs):
        depth, behind = share * hole.depth, shaft.frame.inverse().apply(contact.position)[2]
        through = all(hole.open) or share <= 1
        for mouth, end in product(hole.mouths(place.pose), (1, -1)):
            if through and end * behind < 0 and depth + SETTINGS.hand_m <= shaft.half - end * behind:
                yield _way(shaft, end, mouth, depth)


def _way(shaft: Shaft, end: int, mouth: Pose, depth: float) -> list[Pose]:
    """Poses of a thing whose shaft slides into a mouth with an end (1: that towards +z) to a depth, metres."""
    count = 1 + int(np.ceil((depth + SETTINGS.before_m) / SETTINGS.step_m))
    return [at_depth(shaft, end, mouth, at) for at in np.linspace(-SETTINGS.before_m, depth, count).tolist()]


def at_depth(shaft: Shaft, end: int, mouth: Pose, depth: float) -> Pose:
    """The pose of a thing whose shaft is in line with a hole, one end (1: that towards +z) as deep in it, metres."""
    inwards, up = mouth.rotation()[:, 2], mouth.rotation()[:, 1]
    middle = mouth.p + (depth - shaft.half) * inwards
    return frame_from_axes(middle, end * inwards, up) * shaft.frame.inverse()


def inserted_poses(thing: SceneObject, place: SceneObject) -> Iterator[tuple[float, Pose]]:
    """Poses of a thing that lies on the bottom of a hole, from before its mouth to deep in it, each with the share of
    the hole's length that it fills there; arguments as of :func:`inserting_ways`."""
    pairs = [pair for pair in product(shafts_of(thing.asset), holes_of(place.asset)) if suits(*pair)]
    for depth, (shaft, hole) in product(SETTINGS.seen_shares, pairs):
        gap = hole.loop.reach(np.array([0.0, -1.0])) + shaft.outline[:, 1].min()
        for mouth, end in product(hole.mouths(place.pose), (1, -1)):
            pose = at_depth(shaft, end, mouth, depth * hole.depth)
            pose = Pose(pose.p - [0.0, 0.0, gap], pose.q)
            low = max(depth - 2 * shaft.half / hole.depth, 0.0)
            yield max(min(depth, 1.0) - low, 0.0), pose
