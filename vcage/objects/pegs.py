"""Pegs of a rack and the loops that hang on them, measured on convex pieces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vcage.base.geometry import Pose, frame_from_axes
from vcage.objects.asset import Asset
from vcage.objects.openings import grasped_width, material_along
from vcage.schema.asset import Face


@dataclass(frozen=True)
class PegSettings:
    """Resolution and limits of the measurements.

    Args:
        step_m: between two sections of a peg.
        thicker: a section this much thicker than that near the tip belongs to what bears the peg.
        longest_m: a peg is measured no farther than this from its tip.
        directions: in which a loop is measured from its middle.
        widest_m: material farther than this from the middle does not close a loop.
    """

    step_m: float = 0.004
    thicker: float = 1.5
    longest_m: float = 0.2
    directions: int = 24
    widest_m: float = 0.08


SETTINGS = PegSettings()


@dataclass(frozen=True)
class Peg:
    """A straight peg, in the frame of its rack.

    Args:
        tip: (3,) middle of its free end, metres.
        axis: (3,) unit vector out of the tip.
        length: from the tip to what bears it, metres.
        radius: half of its thickness near the tip, metres.
    """

    tip: np.ndarray
    axis: np.ndarray
    length: float
    radius: float

    def moved(self, pose: Pose) -> Peg:
        """The same in the world, with the rack at a pose."""
        return Peg(pose.apply(self.tip), pose.rotation() @ self.axis, self.length, self.radius)

    def at(self, depth: float) -> np.ndarray:
        """(3,) middle of the peg this far behind its tip, metres."""
        return self.tip - depth * self.axis


@dataclass(frozen=True)
class Loop:
    """A hole with material all around it, in the frame of its object.

    Args:
        frame: its middle, z through the hole and y up.
        reaches: (n,) distances of the material from the middle, evenly spaced around z from x on, metres.
    """

    frame: Pose
    reaches: np.ndarray

    def reach(self, towards: np.ndarray) -> float:
        """Distance of the material from the middle in a direction (2,) of its plane, the nearest measured, metres."""
        turn = np.arctan2(towards[1], towards[0]) / (2 * np.pi) * len(self.reaches)
        return float(self.reaches[round(float(turn)) % len(self.reaches)])

    @property
    def up(self) -> float:
        """Distance of the material above the middle, metres."""
        return self.reach(np.array([0.0, 1.0]))

    @property
    def narrowest(self) -> float:
        """Distance of the nearest material from the middle, metres."""
        return float(self.reaches.min())


def pegs_of(asset: Asset) -> list[Peg]:
    """The pegs of an object."""
    return [_peg(asset, face) for face in asset.annotation.faces_of("peg")]


def _peg(asset: Asset, face: Face) -> Peg:
    axis, tip = np.asarray(face.axis, dtype=np.float64), np.asarray(face.position, dtype=np.float64)
    across = np.cross(axis, [0.0, 0.0, 1.0])
    across /= np.linalg.norm(across)
    depths = np.arange(SETTINGS.step_m, SETTINGS.longest_m, SETTINGS.step_m)
    widths = np.array([grasped_width(asset.pieces, tip - depth * axis, across) for depth in depths])
    beyond = np.flatnonzero((widths > SETTINGS.thicker * widths[0]) | (widths == 0.0))
    return Peg(tip, axis, float(depths[beyond[0]]) if len(beyond) else SETTINGS.longest_m, float(widths[0]) / 2)


def loops_of(asset: Asset) -> list[Loop]:
    """The holes of an object that its material closes all around."""
    found = [loop_at(asset, face) for face in asset.annotation.faces_of("loop")]
    return [loop for loop in found if loop.reaches.max() <= SETTINGS.widest_m]


def loop_at(asset: Asset, face: Face) -> Loop:
    """The section of a hole at a face in its middle; infinitely wide where nothing closes it."""
    axis = np.asarray(face.axis, dtype=np.float64)
    frame = frame_from_axes(face.position, axis, np.array([0.0, 0.0, 1.0]))
    turns = np.arange(SETTINGS.directions) * 2 * np.pi / SETTINGS.directions
    ways = frame.rotation()[:, :2] @ np.array([np.cos(turns), np.sin(turns)])
    reaches = [
        min((start for start, _ in material_along(asset.pieces, frame.p, way) if start > 0), default=np.inf)
        for way in ways.T
    ]
    return Loop(frame, np.array(reaches))


def depth_through(peg: Peg, loop: Loop, pose: Pose) -> float | None:
    """How far behind its tip a peg passes through a loop, metres; None where it does not.

    Args:
        peg: in the world.
        loop: of an object.
        pose: of that object.
    """
    hole = (pose * loop.frame).inverse()
    tip, along = hole.apply(peg.tip), hole.rotation() @ peg.axis
    if abs(along[2]) < 1e-6:
        return None
    depth = float(tip[2] / along[2])
    crossing = (tip - depth * along)[:2]
    through = 0.0 <= depth <= peg.length and np.linalg.norm(crossing) < loop.reach(crossing)
    return depth if through else None
