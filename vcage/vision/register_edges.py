"""Finds the straight edges of a table that go through a whole picture, and how those of two pictures lie together:
projection profiles of the gradient along each axis.

Objects hide parts of such an edge, but draw none of their own: nothing on a table is as long. A line is looked for in
blocks side by side, each averaged along the edge, so that grain and noise vanish and most blocks must see it.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

BLOCKS = 20
"""Parts of a line."""

CHROMA = 2.0
"""Weight of the colour channels: a table may be as bright as the ground."""

SHARE_EMPTY, SHARE = 0.85, 0.7
"""Share of the blocks that must show a line, in the picture of the empty table and in one with objects."""

FAINTEST = 0.6
"""Grey levels a pixel below which a change is no line."""

APART = 6
"""Pixels between lines."""

WAVY = 3.0
"""Pixels by which half of the blocks may be off the line: image models bend what they draw, but little."""

LINES = 8
"""Lines of a picture that are compared, the strongest."""

LEAST_SPAN = 0.25
"""Share of the picture that lies between the two edges of a table, at least."""

ZOOM = (0.72, 1.3)
"""Scales that editors make by cropping and by drawing more around, and no others."""

RIVAL = 0.3
"""Two lines where one is stronger than this part of the other may be taken for each other."""

GROUND = 12.0
"""By how much the colours (CIELAB) beyond the two edges may differ more than they do in the empty picture: of the
ground on both sides they differed by 7 at most, of ground and a plank by 21 at least."""

LIT = 4
"""Blocks, the brightest, that show the ground: beside a table lies its shadow."""

OTHER = 2.0
"""Times the spread of a table's colours by which the ground's must differ: 2.4 at least, for planks 1.5 at most."""

BEYOND = (4, 12)
"""Pixels from an edge between which the colour beyond it is taken."""


@dataclass(frozen=True)
class Line:
    """An edge through the whole picture: pixels from its first row or column, and grey levels a pixel."""

    at: float
    strength: float


@dataclass(frozen=True)
class Axis:
    """Where a picture's pixels lie in another along one axis: ``scale * pixel + shift``, centres at whole numbers."""

    scale: float = 1.0
    shift: float = 0.0

    def __call__(self, at: float) -> float:
        return self.scale * at + self.shift

    def after(self, first: Axis) -> Axis:
        """This one of what ``first`` gives."""
        return Axis(self.scale * first.scale, self(first.shift))

    def largest_shift(self, length: int) -> float:
        """Pixels by which one of so many is moved, at most."""
        return max(abs(self(at) - at) for at in (0, length - 1))

    @classmethod
    def between(cls, start: tuple[float, float], end: tuple[float, float]) -> Axis:
        """The one that takes pixels ``start[0]`` up to, not including, ``start[1]`` onto those of ``end``."""
        scale = (end[1] - end[0]) / (start[1] - start[0])
        return cls(scale, end[0] - 0.5 + scale * (0.5 - start[0]))


def warp_of(fit: tuple[Axis, Axis]) -> np.ndarray:
    """(2, 3) float64 matrix of what is done along x and along y."""
    x, y = fit
    return np.array([[x.scale, 0.0, x.shift], [0.0, y.scale, y.shift]])


@dataclass(frozen=True)
class Profile:
    """A picture averaged in blocks along one axis.

    Args:
        blocks: (n, BLOCKS, 3) float32 CIELAB, rows for axis 0 and columns for axis 1.
        change: (n, BLOCKS) float32, how much the colour changes from pixel to pixel.
    """

    blocks: np.ndarray
    change: np.ndarray

    @classmethod
    def of(cls, lab: np.ndarray, axis: int) -> Profile:
        """From an (H, W, 3) uint8 CIELAB picture; axis 0 for lines that are level, 1 for upright ones."""
        size = (BLOCKS, lab.shape[0]) if axis == 0 else (lab.shape[1], BLOCKS)
        blocks = cv2.resize(lab, size, interpolation=cv2.INTER_AREA).astype(np.float32)
        blocks = np.ascontiguousarray(blocks if axis == 0 else blocks.transpose(1, 0, 2))
        soft = cv2.GaussianBlur(blocks * np.array([1, CHROMA, CHROMA], np.float32), (1, 5), 0, sigmaY=1.0)
        change = np.zeros(soft.shape[:2], np.float32)
        change[1:-1] = np.linalg.norm(soft[2:] - soft[:-2], axis=2) / 2
        return cls(blocks, change)

    def lines(self, share: float) -> list[Line]:
        """The lines that a share of the blocks shows, strongest first."""
        ridge = np.quantile(cv2.dilate(self.change, np.ones((5, 1))), 1 - share, axis=1).astype(np.float32)
        highest = cv2.dilate(ridge[:, None], np.ones((2 * APART + 1, 1))).ravel()
        least = max(FAINTEST, 3 * float(np.median(ridge)))
        found: list[Line] = []
        for at in np.nonzero((ridge >= highest) & (ridge >= least))[0]:
            line = self.near(float(at))
            if line is not None and all(abs(line.at - other.at) > APART / 2 for other in found):
                found.append(line)
        return sorted(found, key=lambda line: -line.strength)[:LINES]

    def near(self, at: float) -> Line | None:
        """The line within a few pixels, to a part of a pixel; None when the blocks do not agree on one."""
        first = int(np.clip(round(at) - APART, 1, max(1, len(self.change) - 2 * APART - 2)))
        window = self.change[first : first + 2 * APART + 1]
        if len(window) < 2 * APART + 1:
            return None
        peak, columns = window.argmax(axis=0), np.arange(window.shape[1])
        strength = window[peak, columns]
        inner = np.clip(peak, 1, len(window) - 2)
        low, middle, high = (window[inner + k, columns] for k in (-1, 0, 1))
        bend = np.minimum(low + high - 2 * middle, -1e-6)
        where = first + inner + np.clip((low - high) / (2 * bend), -0.5, 0.5)
        strong = strength >= np.quantile(strength, 1 - SHARE)
        centre = float(np.median(where[strong]))
        spread = float(np.median(np.abs(where[strong] - centre)))
        return Line(centre, float(np.median(strength))) if spread <= WAVY / 2 else None

    def ground(self, low: float, high: float) -> np.ndarray | None:
        """(2, 3) colour just beyond two lines, where no shadow lies; None where the picture ends there."""
        found = []
        for start, stop in ((low - BEYOND[1], low - BEYOND[0]), (high + BEYOND[0], high + BEYOND[1])):
            rows = self.blocks[max(0, round(start)) : max(0, round(stop))]
            if not len(rows):
                return None
            colours = np.median(rows, axis=0)
            found.append(colours[np.argsort(colours[:, 0])[-LIT:]].mean(axis=0))
        return np.array(found)

    def between(self, low: float, high: float) -> tuple[np.ndarray, float]:
        """(3,) the colour between two lines, and how far it strays."""
        rows = np.median(self.blocks[round(low) + BEYOND[0] : round(high) - BEYOND[0] + 1], axis=1)
        colour = np.median(rows, axis=0)
        return colour, float(np.quantile(np.linalg.norm(rows - colour, axis=1), 0.75))


def table_edges(empty: Profile) -> tuple[Line, Line] | None:
    """The two edges of the table that go through the picture of the empty one; None when it does not show both."""
    lines = empty.lines(SHARE_EMPTY)
    for a, b in itertools.combinations(lines, 2):
        if abs(a.at - b.at) >= LEAST_SPAN * len(empty.change):
            return (a, b) if a.at < b.at else (b, a)
    return None


@dataclass(frozen=True)
class EdgesAlong:
    """One axis: profiles of the empty table and of a picture, and the table's two edges if the former shows both."""

    empty: Profile
    seen: Profile
    edges: tuple[Line, Line] | None

    @classmethod
    def of(cls, background: np.ndarray, whole: np.ndarray, axis: int) -> EdgesAlong:
        """From (H, W, 3) uint8 CIELAB pictures; axis as in :meth:`Profile.of`."""
        empty = Profile.of(background, axis)
        return cls(empty, Profile.of(whole, axis), table_edges(empty))


def confirmed_by(along: Sequence[EdgesAlong], within: float) -> bool:
    """Whether a picture shows what edges the table has where the empty table has them, to so many pixels; False when
    it has none."""
    known = [one for one in along if one.edges is not None]
    return bool(known) and all(agrees(one.edges, one.seen, within) for one in known if one.edges)


def laid(empty: Profile, edges: tuple[Line, Line], seen: Profile) -> list[Axis]:
    """Every way to lay lines of a picture over both edges of the table; more than one when nothing tells them apart.

    A pair of lines is one when what lies beyond both is of one colour, as it is in the empty picture, and of another
    than what lies between: so the ground is told from the planks of a table painted anew.
    """
    near, far = edges
    lines = sorted(seen.lines(SHARE), key=lambda line: line.at)
    found: list[tuple[float, Axis]] = []
    for a, b in itertools.combinations(lines, 2):
        scale = (far.at - near.at) / (b.at - a.at)
        if ZOOM[0] <= scale <= ZOOM[1] and _on_ground(empty, edges, seen, (a.at, b.at)):
            found.append((min(a.strength, b.strength), Axis(scale, near.at - scale * a.at)))
    strongest = max((strength for strength, _ in found), default=0.0)
    return [axis for strength, axis in found if strength >= RIVAL * strongest]


def agrees(edges: tuple[Line, Line], seen: Profile, within: float) -> bool:
    """Whether a picture shows both edges where the empty table has them, to so many pixels."""
    least = max(FAINTEST, 3 * float(np.median(seen.change)))
    found = [seen.near(edge.at) for edge in edges]
    return all(f is not None and f.strength >= least and abs(f.at - e.at) <= within for f, e in zip(found, edges))


def _on_ground(empty: Profile, edges: tuple[Line, Line], seen: Profile, at: tuple[float, float]) -> bool:
    """Whether what lies beyond two lines of a picture is the ground."""
    ours, theirs = empty.ground(edges[0].at, edges[1].at), seen.ground(*at)
    if ours is None or theirs is None:
        return False
    differ = [float(np.linalg.norm(colours[0] - colours[1])) for colours in (ours, theirs)]
    table, spread = seen.between(*at)
    apart = np.linalg.norm(theirs - table, axis=1).min()
    return differ[1] <= differ[0] + GROUND and bool(apart >= OTHER * (spread + 1))
