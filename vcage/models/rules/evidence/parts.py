"""Evidence of a moving part: the likeliest of drawings of it at many positions, seen from above.

Drawings have no shadows, while an open drawer lies in that of its cabinet: a grey drawer in the sun looks like
a grey table in the shade. So pictures and drawings are compared by edges and hues, which shadows hardly change.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import cv2
import numpy as np

from vcage.base.errors import InputFileError
from vcage.base.geometry import Camera, Pose
from vcage.models.rules.critic_view import VIEW, CriticView
from vcage.models.rules.drawings import Draw, brightness, drawn_whole
from vcage.models.rules.evidence.judgement import Judged, decided, refused
from vcage.models.rules.pixels import grown
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal, part_words
from vcage.sim.drawer import Drawing
from vcage.vision.colour import distance, to_lab

POSITIONS = np.linspace(0.0, 1.0, 17)
"""Positions of a joint that are drawn, as shares of its range."""


@dataclass(frozen=True)
class PartSettings:
    """The comparison of a picture with drawings of a part, and limits for a yes.

    Args:
        blur_px: standard deviation of the blur of both: a pose is found to a pixel or two.
        floor: light, of 1 for white, added everywhere, as black has no logarithm.
        edge_cap_per_px: largest counted difference of a pixel's gradients of the logarithm of light.
        hue_weight_per_lab: weight of a difference in hue relative to one of such gradients.
        hue_cap_lab: largest counted difference of a pixel's hues (CIELAB a, b).
        different_lab: least colour distance between drawings at a pixel that distinguishes positions.
        fewest_px: least number of such pixels.
        open_share, closed_share: share of its range at which a part must seem to be: at least, to count as open or
            turned; at most, to count as closed.
        stirred_share: share of its range by which a part must be seen to have moved.
        margin_share: share of the range of costs by which the positions that a goal allows must beat all others.
    """

    blur_px: float = 1.3
    floor: float = 0.004
    edge_cap_per_px: float = 0.3
    hue_weight_per_lab: float = 0.005
    hue_cap_lab: float = 20.0
    different_lab: float = 10.0
    fewest_px: int = 25
    open_share: float = 0.7
    closed_share: float = 0.15
    stirred_share: float = 0.2
    margin_share: float = 0.08


SETTINGS = PartSettings()


@dataclass(frozen=True)
class PartEvidence:
    """Measurements of a moving part, all from pixels.

    Args:
        differing_px: number of pixels in which the drawings differ.
        before, after: share of its range at which the part is likeliest.
        costs: (17,) how unlike the picture afterwards the drawing at each of :data:`POSITIONS` is, in edges and hues.
        rival: by how much less unlike the best of them is than the best drawing in which another part of the object
            moved instead; inf where it has no other.
        covered: (H, W) bool, the area of the object with its part anywhere.
    """

    differing_px: int
    before: float
    after: float
    costs: np.ndarray
    rival: float
    covered: np.ndarray

    @classmethod
    def gather(cls, view: CriticView, goal: Goal) -> PartEvidence | None:
        """Measure the part of a goal's subject; None where the subject is not found before.

        Raises:
            InputFileError: there is no picture of the empty table, or nothing draws the object.
        """
        thing, part = PosedObject.found(view, goal), str(goal.part)
        if thing is None:
            return None
        before, after = view.before["top"], view.after["top"]
        own = thing.drawings(part, POSITIONS)
        gain = brightness(own[-1] if thing.rest[part] else own[0], before.picture)
        rivals = [other for other in view.question.parts.get(goal.subject, ()) if other != part]
        drawn = {part: own} | {rival: thing.drawings(rival, POSITIONS) for rival in rivals}
        within = _around(np.any([one.covered for several in drawn.values() for one in several], axis=0))
        sights = {moving: _Sight(several, gain, thing.background, within) for moving, several in drawn.items()}
        sight = sights[part]
        where = np.any([one.telling for one in sights.values()], axis=0)
        least: dict[str, float] = {}
        for moving, one in sights.items():
            costs = one.costs(after.picture, where)
            # Drawers look so similar that a step between two positions hides which of them moved.
            between = _Sight(thing.drawings(moving, [likeliest(costs)]), gain, thing.background, within)
            least[moving] = float(min(costs.min(), between.costs(after.picture, where).min()))
        first, then = sight.costs(before.picture), sight.costs(after.picture)
        return cls(
            differing_px=int(sight.telling.sum()),
            before=likeliest(first),
            after=likeliest(then),
            costs=then,
            rival=min((least[name] for name in rivals), default=np.inf) - least[part],
            covered=sight.covered,
        )

    def moved(self, goal: Goal, thing: str) -> Verdict:
        """Judge by the position at which the part is likeliest."""
        part = part_words(str(goal.part))
        if self.differing_px < SETTINGS.fewest_px:
            return refused(f"whether the {part} of the {thing} moved cannot be seen from above", 0.5)
        if abs(self.after - self.before) < SETTINGS.stirred_share:
            return refused(f"the {part} of the {thing} stays {100 * self.before:.0f} % of its way from rest", 0.8)
        closes = goal.kind.rests
        seen, limit = self.after, SETTINGS.closed_share if closes else SETTINGS.open_share
        accepted = seen <= limit if closes else seen >= limit
        end = "turned" if goal.kind.acts_on == "turn" else "open"
        looks = f"the {part} of the {thing} looks {100 * seen:.0f} % {end}"
        if accepted and self.rival <= 0:
            return refused(f"it looks as if another part of the {thing} moved, not its {part}", 0.7)
        if accepted and self._margin(closes) < SETTINGS.margin_share:
            return refused(f"{looks}, but nearly as much as if it were not", 0.5)
        return decided(accepted, f"{looks}, {100 * self.before:.0f} % before", 0.5 + min(0.5, abs(seen - limit)))

    def _margin(self, closes: bool) -> float:
        """Lead of the best position that a goal allows over the best other one, as a share of the costs' range."""
        meant = SETTINGS.closed_share >= POSITIONS if closes else SETTINGS.open_share <= POSITIONS
        return float((self.costs[~meant].min() - self.costs[meant].min()) / max(np.ptp(self.costs), 1e-6))


def judge_part(view: CriticView, goal: Goal) -> Judged:
    """Judge whether a part was opened, closed or turned."""
    evidence = PartEvidence.gather(view, goal)
    phrase = view.question.looks[goal.subject].phrase
    if evidence is None:
        return Judged(refused(f"the {phrase} is not found", 0.5), view.nowhere)
    return Judged(evidence.moved(goal, phrase), grown(evidence.covered, VIEW.around_px))


@dataclass(frozen=True)
class PosedObject:
    """An object at the pose where it is seen before, drawn with one of its parts at any position.

    Args:
        draw_at: shares of the ranges of its joints → how it is drawn.
        rest: part → share of its range that it is at before, by the plan; others are closed.
        pose: of the object.
        camera: that sees it.
        background: (H, W, 3) uint8 RGB, the empty table.
    """

    draw_at: Callable[[Mapping[str, float]], Draw]
    rest: Mapping[str, float]
    pose: Pose
    camera: Camera
    background: np.ndarray

    @classmethod
    def found(cls, view: CriticView, goal: Goal) -> PosedObject | None:
        """Find the subject of a goal in the picture before; None where it is not seen.

        Raises:
            InputFileError: there is no picture of the empty table, or nothing draws the object.
        """
        question, name = view.question, goal.subject
        if question.draw is None or question.background is None:
            raise InputFileError(
                f"no picture of the empty table shows whether the {part_words(str(goal.part))} of {name!r} moved",
                hint="give pictures from episodes/critic, as stored by collect",
            )
        rest = {**dict.fromkeys(question.opened.get(name, ()), 1.0), str(goal.part): float(goal.kind.rests)}
        draw_at = partial(view.draw, name)
        sought = replace(view.sought(name), look=question.looks[name], draw=draw_at(rest))
        seen = sought.found({"top": view.before["top"]})
        return None if seen is None else cls(draw_at, rest, seen.pose, view.camera, question.background)

    def drawings(self, moving: str, shares: Iterable[float]) -> list[Drawing]:
        """Draw the object with a part at one share of its range after another."""
        draws = (self.draw_at({**self.rest, moving: float(share)}) for share in shares)
        return [drawn_whole(draw, self.pose, self.camera) for draw in draws]


class _Sight:
    """Drawings of an object at one pose with a part at one position after another.

    Args:
        drawings: in their order.
        gain: (3,) factor that makes them as bright as the pictures.
        background: the empty table.
        within: the rows and columns to compare; most of a picture is table.

    Attributes:
        covered: (H, W) bool, where the object is in any of them.
        telling: (H, W) bool, where they differ.
    """

    def __init__(
        self, drawings: Sequence[Drawing], gain: np.ndarray, background: np.ndarray, within: tuple[slice, slice]
    ):
        pictures = [_composed(drawing, background, gain, within) for drawing in drawings]
        self._within = within
        self._drawn = [edges_and_hues(picture) for picture in pictures]
        self.covered = np.any([drawing.covered for drawing in drawings], axis=0)
        first, *rest = [to_lab(picture) for picture in pictures]
        differ = [distance(lab, first) > SETTINGS.different_lab for lab in rest]
        self.telling = np.zeros_like(self.covered)
        if differ:
            self.telling[within] = self.covered[within] & np.any(differ, axis=0)

    def costs(self, picture: np.ndarray, where: np.ndarray | None = None) -> np.ndarray:
        """(n,) mean unlikeness of a picture (H, W, 3) uint8 RGB to each drawing.

        Args:
            picture: to compare.
            where: (H, W) bool, the pixels within the compared area that count; those where drawings differ by default.
        """
        where = self.telling if where is None else where
        if not where.any():
            return np.zeros(len(self._drawn))
        there = where[self._within]
        seen = edges_and_hues(picture[self._within])[there]
        return np.array([unlike(seen, drawn[there]) for drawn in self._drawn])


def edges_and_hues(picture: np.ndarray) -> np.ndarray:
    """(H, W, 4) float32: the gradient of the logarithm of light, per pixel, and CIELAB a and b, of an RGB picture."""
    smooth = cv2.GaussianBlur(picture, (0, 0), SETTINGS.blur_px)
    grey = cv2.cvtColor(smooth, cv2.COLOR_RGB2GRAY).astype(np.float32) / 255
    light = np.log(grey**2.2 + SETTINGS.floor)
    along_x, along_y = (cv2.Sobel(light, cv2.CV_32F, *axis, ksize=3, scale=1 / 8) for axis in ((1, 0), (0, 1)))
    return cv2.merge([along_x, along_y, *cv2.split(to_lab(smooth))[1:]])


def unlike(seen: np.ndarray, drawn: np.ndarray) -> float:
    """Mean difference of edges and hues of pixels, (n, 4) each."""
    apart = seen - drawn
    edge, hue = np.linalg.norm(apart[:, :2], axis=1), np.linalg.norm(apart[:, 2:], axis=1)
    edge, hue = np.minimum(edge, SETTINGS.edge_cap_per_px), np.minimum(hue, SETTINGS.hue_cap_lab)
    return float((edge + SETTINGS.hue_weight_per_lab * hue).mean())


def likeliest(costs: np.ndarray) -> float:
    """The position of least cost, refined between its neighbours."""
    k = int(np.argmin(costs))
    if k in (0, len(costs) - 1):
        return float(POSITIONS[k])
    left, middle, right = costs[k - 1 : k + 2]
    bend = left - 2 * middle + right
    offset = 0.5 * (left - right) / bend if bend > 1e-6 else 0.0
    return float(POSITIONS[k] + offset * (POSITIONS[1] - POSITIONS[0]))


def _around(covered: np.ndarray, margin_px: int = 10) -> tuple[slice, slice]:
    """The rows and columns of a mask and a margin for the blur; all of them if it is empty."""
    if not covered.any():
        return slice(None), slice(None)
    rows, columns = (np.flatnonzero(covered.any(axis=axis)) for axis in (1, 0))
    first, second = (slice(max(0, int(n[0]) - margin_px), int(n[-1]) + margin_px + 1) for n in (rows, columns))
    return first, second


def _composed(drawing: Drawing, background: np.ndarray, gain: np.ndarray, within: tuple[slice, slice]) -> np.ndarray:
    """The part of a drawing, brighter by a factor (3,), on the empty table."""
    composed, covered = background[within].copy(), drawing.covered[within]
    composed[covered] = np.clip(drawing.picture[within][covered].astype(np.float32) * gain, 0, 255)
    return composed
