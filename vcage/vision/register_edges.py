"""Registration by the straight edges of a table that cross the whole picture: projection profiles of the gradient
along each axis.

Objects hide parts of such an edge, but have none as long themselves. A line is searched in blocks side by side, each
averaged along the edge, so that grain and noise vanish; most blocks must show it.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np


@dataclass(frozen=True)
class EdgeSettings:
    """Search for table edges.

    Args:
        blocks: parts of a line.
        chroma_weight: of the colour channels; a table may be as bright as the ground.
        share_empty, share: of the blocks that must show a line, in the picture of the empty table and in one with
            objects.
        faintest: change of a line at least, grey levels a pixel.
        apart_px: least distance between lines.
        wavy_px: half of the blocks may be off the line by half of this; image models bend lines a little.
        lines: compared lines of a picture, the strongest.
        least_span_share: share of the picture between the two edges of a table, at least.
        least_zoom, largest_zoom: scales that editors make by cropping and by drawing more around.
        rival_share: a pair of lines rivals the strongest one when it is stronger than this share of it.
        ground_difference: largest increase of the difference between the colours (CIELAB) beyond both edges, against
            the empty picture. Ground on both sides differed by 7 at most, ground and a plank by 21 at least.
        lit_blocks: the brightest blocks show the ground; a shadow lies beside a table.
        contrast: distance of the ground's colour from the table's, in spreads of the table's colours: 2.4 at least,
            between planks 1.5 at most.
        beyond_px: distances from an edge between which the colour beyond it is taken.
    """

    blocks: int = 20
    chroma_weight: float = 2.0
    share_empty: float = 0.85
    share: float = 0.7
    faintest: float = 0.6
    apart_px: int = 6
    wavy_px: float = 3.0
    lines: int = 8
    least_span_share: float = 0.25
    least_zoom: float = 0.72
    largest_zoom: float = 1.3
    rival_share: float = 0.3
    ground_difference: float = 12.0
    lit_blocks: int = 4
    contrast: float = 2.0
    beyond_px: tuple[int, int] = (4, 12)


SETTINGS = EdgeSettings()


@dataclass(frozen=True)
class Line:
    """An edge through the whole picture: its distance from the first row or column, pixels; grey levels a pixel."""

    at: float
    strength: float


@dataclass(frozen=True)
class Axis:
    """Map of a picture's pixels to another's along one axis: ``scale * pixel + shift``, centres at whole numbers."""

    scale: float = 1.0
    shift: float = 0.0

    def __call__(self, at: float) -> float:
        return self.scale * at + self.shift

    def after(self, first: Axis) -> Axis:
        """The composition: ``first``, then this map."""
        return Axis(self.scale * first.scale, self(first.shift))

    def largest_shift(self, length: int) -> float:
        """Largest shift of any of ``length`` pixels."""
        return max(abs(self(at) - at) for at in (0, length - 1))

    @classmethod
    def between(cls, start: tuple[float, float], end: tuple[float, float]) -> Axis:
        """The map of the half-open range of pixels ``start`` onto the range ``end``."""
        scale = (end[1] - end[0]) / (start[1] - start[0])
        return cls(scale, end[0] - 0.5 + scale * (0.5 - start[0]))


def warp_of(fit: tuple[Axis, Axis]) -> np.ndarray:
    """(2, 3) float64 matrix of the maps along x and y."""
    x, y = fit
    return np.array([[x.scale, 0.0, x.shift], [0.0, y.scale, y.shift]])


@dataclass(frozen=True)
class Profile:
    """A picture averaged in blocks along one axis.

    Args:
        blocks: (n, blocks, 3) float32 CIELAB, rows for axis 0 and columns for axis 1.
        change: (n, blocks) float32, change of colour from pixel to pixel.
    """

    blocks: np.ndarray
    change: np.ndarray

    @classmethod
    def of(cls, lab: np.ndarray, axis: int) -> Profile:
        """From an (H, W, 3) uint8 CIELAB picture; axis 0 for horizontal lines, 1 for vertical ones."""
        size = (SETTINGS.blocks, lab.shape[0]) if axis == 0 else (lab.shape[1], SETTINGS.blocks)
        blocks = cv2.resize(lab, size, interpolation=cv2.INTER_AREA).astype(np.float32)
        blocks = np.ascontiguousarray(blocks if axis == 0 else blocks.transpose(1, 0, 2))
        weights = np.array([1, SETTINGS.chroma_weight, SETTINGS.chroma_weight], np.float32)
        soft = cv2.GaussianBlur(blocks * weights, (1, 5), 0, sigmaY=1.0)
        change = np.zeros(soft.shape[:2], np.float32)
        change[1:-1] = np.linalg.norm(soft[2:] - soft[:-2], axis=2) / 2
        return cls(blocks, change)

    def lines(self, share: float) -> list[Line]:
        """The lines that a share of the blocks shows, the strongest first."""
        ridge = np.quantile(cv2.dilate(self.change, np.ones((5, 1))), 1 - share, axis=1).astype(np.float32)
        highest = cv2.dilate(ridge[:, None], np.ones((2 * SETTINGS.apart_px + 1, 1))).ravel()
        least = max(SETTINGS.faintest, 3 * float(np.median(ridge)))
        found: list[Line] = []
        for at in np.nonzero((ridge >= highest) & (ridge >= least))[0]:
            line = self.near(float(at))
            if line is not None and all(abs(line.at - other.at) > SETTINGS.apart_px / 2 for other in found):
                found.append(line)
        return sorted(found, key=lambda line: -line.strength)[: SETTINGS.lines]

    def near(self, at: float) -> Line | None:
        """The line within a few pixels, with subpixel accuracy; None if the blocks do not agree on one."""
        width = 2 * SETTINGS.apart_px + 1
        first = int(np.clip(round(at) - SETTINGS.apart_px, 1, max(1, len(self.change) - width - 1)))
        window = self.change[first : first + width]
        if len(window) < width:
            return None
        peak, columns = window.argmax(axis=0), np.arange(window.shape[1])
        strength = window[peak, columns]
        inner = np.clip(peak, 1, len(window) - 2)
        low, middle, high = (window[inner + k, columns] for k in (-1, 0, 1))
        bend = np.minimum(low + high - 2 * middle, -1e-6)
        where = first + inner + np.clip((low - high) / (2 * bend), -0.5, 0.5)
        strong = strength >= np.quantile(strength, 1 - SETTINGS.share)
        centre = float(np.median(where[strong]))
        spread = float(np.median(np.abs(where[strong] - centre)))
        return Line(centre, float(np.median(strength))) if spread <= SETTINGS.wavy_px / 2 else None

    def ground(self, low: float, high: float) -> np.ndarray | None:
        """(2, 3) colours just beyond two lines, beside the shadow; None if the picture ends there."""
        found = []
        near, far = SETTINGS.beyond_px
        for start, stop in ((low - far, low - near), (high + near, high + far)):
            rows = self.blocks[max(0, round(start)) : max(0, round(stop))]
            if not len(rows):
                return None
            colours = np.median(rows, axis=0)
            found.append(colours[np.argsort(colours[:, 0])[-SETTINGS.lit_blocks :]].mean(axis=0))
        return np.array(found)

    def between(self, low: float, high: float) -> tuple[np.ndarray, float]:
        """(3,) the colour between two lines, and its spread."""
        near = SETTINGS.beyond_px[0]
        rows = np.median(self.blocks[round(low) + near : round(high) - near + 1], axis=1)
        colour = np.median(rows, axis=0)
        return colour, float(np.quantile(np.linalg.norm(rows - colour, axis=1), 0.75))


def table_edges(empty: Profile) -> tuple[Line, Line] | None:
    """The two edges of the table that cross the picture of the empty table; None if it does not show both."""
    lines = empty.lines(SETTINGS.share_empty)
    for a, b in itertools.combinations(lines, 2):
        if abs(a.at - b.at) >= SETTINGS.least_span_share * len(empty.change):
            return (a, b) if a.at < b.at else (b, a)
    return None


@dataclass(frozen=True)
class EdgesAlong:
    """One axis: profiles of the empty table and of a picture, and the table's two edges if both are visible."""

    empty: Profile
    seen: Profile
    edges: tuple[Line, Line] | None

    @classmethod
    def of(cls, background: np.ndarray, whole: np.ndarray, axis: int) -> EdgesAlong:
        """From (H, W, 3) uint8 CIELAB pictures; axis as in :meth:`Profile.of`."""
        empty = Profile.of(background, axis)
        return cls(empty, Profile.of(whole, axis), table_edges(empty))


def confirmed_by(along: Sequence[EdgesAlong], within: float) -> bool:
    """True if the picture shows the table's edges in their places, to ``within`` pixels; False without edges."""
    known = [one for one in along if one.edges is not None]
    return bool(known) and all(agrees(one.edges, one.seen, within) for one in known if one.edges)


def laid(empty: Profile, edges: tuple[Line, Line], seen: Profile) -> list[Axis]:
    """All maps of two lines of a picture onto both edges of the table; more than one if they are ambiguous.

    A pair of lines counts when the colours beyond both are the same, as in the empty picture, and differ from the
    colour between them. So the ground is distinguished from the planks of a repainted table.
    """
    near, far = edges
    lines = sorted(seen.lines(SETTINGS.share), key=lambda line: line.at)
    found: list[tuple[float, Axis]] = []
    for a, b in itertools.combinations(lines, 2):
        scale = (far.at - near.at) / (b.at - a.at)
        if SETTINGS.least_zoom <= scale <= SETTINGS.largest_zoom and _on_ground(empty, edges, seen, (a.at, b.at)):
            found.append((min(a.strength, b.strength), Axis(scale, near.at - scale * a.at)))
    strongest = max((strength for strength, _ in found), default=0.0)
    return [axis for strength, axis in found if strength >= SETTINGS.rival_share * strongest]


def agrees(edges: tuple[Line, Line], seen: Profile, within: float) -> bool:
    """True if the picture shows both edges in their places, to ``within`` pixels."""
    least = max(SETTINGS.faintest, 3 * float(np.median(seen.change)))
    found = [seen.near(edge.at) for edge in edges]
    return all(f is not None and f.strength >= least and abs(f.at - e.at) <= within for f, e in zip(found, edges))


def _on_ground(empty: Profile, edges: tuple[Line, Line], seen: Profile, at: tuple[float, float]) -> bool:
    """True if the ground lies beyond two lines of a picture."""
    ours, theirs = empty.ground(edges[0].at, edges[1].at), seen.ground(*at)
    if ours is None or theirs is None:
        return False
    differ = [float(np.linalg.norm(colours[0] - colours[1])) for colours in (ours, theirs)]
    table, spread = seen.between(*at)
    apart = np.linalg.norm(theirs - table, axis=1).min()
    same_ground = differ[1] <= differ[0] + SETTINGS.ground_difference
    return same_ground and bool(apart >= SETTINGS.contrast * (spread + 1))
