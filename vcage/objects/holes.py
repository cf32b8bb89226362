"""Shafts of things and the holes that they go into, measured on convex pieces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Pose, frame_from_axes
from vcage.objects.asset import Asset
from vcage.objects.openings import material_along
from vcage.objects.pegs import Loop, loop_at
from vcage.schema.asset import Face


@dataclass(frozen=True)
class HoleSettings:
    """How a hole is measured.

    Args:
        beside_m: its length is that of the material this far outside its wall: beyond a bevelled mouth.
        widest_m: material farther than this from the middle does not close it.
    """

    beside_m: float = 0.005
    widest_m: float = 0.05


SETTINGS = HoleSettings()


@dataclass(frozen=True)
class Shaft:
    """The straight body of a thing that goes into a hole, in the frame of the thing.

    Args:
        frame: its middle, z along it and y up.
        half: half its length, metres.
        outline: (n, 2) its corners, seen along z, metres.
    """

    frame: Pose
    half: float
    outline: np.ndarray

    def ends(self, pose: Pose) -> np.ndarray:
        """(2, 3) the middles of its ends in the world, with the thing at a pose."""
        return (pose * self.frame).apply([[0.0, 0.0, -self.half], [0.0, 0.0, self.half]])


@dataclass(frozen=True)
class Hole:
    """A straight hole with material all around it, in the frame of its object.

    Args:
        loop: its section in the middle, z along it and y up.
        ends: z of both ends in that frame, metres.
        open: True for each end that is a mouth.
    """

    loop: Loop
    ends: tuple[float, float]
    open: tuple[bool, bool]

    @property
    def depth(self) -> float:
        """Its length, metres."""
        return self.ends[1] - self.ends[0]

    def mouths(self, pose: Pose) -> list[Pose]:
        """Frames of its mouths in the world, z into the hole and y up, with the object at a pose."""
        frame = pose * self.loop.frame
        inwards, up = frame.rotation()[:, 2], frame.rotation()[:, 1]
        signed = zip(self.ends, self.open, (1, -1), strict=True)
        return [frame_from_axes(frame.apply([0.0, 0.0, z]), sign * inwards, up) for z, free, sign in signed if free]

    def passes(self, shaft: Shaft, room_m: float) -> bool:
        """True where each corner of a shaft that is in line with it is that far from the wall, metres."""
        return all(np.linalg.norm(corner) + room_m <= self.loop.reach(corner) for corner in shaft.outline)


def shafts_of(asset: Asset) -> list[Shaft]:
    """The shafts of an object."""
    return [_shaft(asset, face) for face in asset.annotation.faces_of("shaft")]


def _shaft(asset: Asset, face: Face) -> Shaft:
    frame = frame_from_axes(face.position, face.axis, [0.0, 0.0, 1.0])
    corners = frame.inverse().apply(np.concatenate([piece.vertices for piece in asset.pieces]))
    low, high = float(corners[:, 2].min()), float(corners[:, 2].max())
    return Shaft(frame * Pose([0.0, 0.0, (low + high) / 2]), (high - low) / 2, corners[:, :2])


def holes_of(asset: Asset) -> list[Hole]:
    """The holes of an object that its material closes all around."""
    return [hole for face in asset.annotation.faces_of("hole") if (hole := _hole(asset, face)) is not None]


def _hole(asset: Asset, face: Face) -> Hole | None:
    loop = loop_at(asset, face)
    walls = _walls(asset, loop) if loop.reaches.max() <= SETTINGS.widest_m else None
    if walls is None:
        return None
    across = material_along(asset.pieces, loop.frame.p, loop.frame.rotation()[:, 2])
    bottom = max((end for _, end in across if walls[0] < end < 0), default=None)
    top = min((start for start, _ in across if 0 < start < walls[1]), default=None)
    ends = walls[0] if bottom is None else bottom, walls[1] if top is None else top
    return Hole(loop, ends, (bottom is None, top is None))


def _walls(asset: Asset, loop: Loop) -> tuple[float, float] | None:
    """z of the ends of the material around a hole; None where it is open on one side."""
    turns = np.arange(4) * np.pi / 2
    ways = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    beside = [loop.frame.apply([*((loop.reach(way) + SETTINGS.beside_m) * way), 0.0]) for way in ways]
    lines = (material_along(asset.pieces, at, loop.frame.rotation()[:, 2]) for at in beside)
    around = [(start, end) for several in lines for start, end in several if start < 0 < end]
    return (max(start for start, _ in around), min(end for _, end in around)) if len(around) == len(beside) else None
