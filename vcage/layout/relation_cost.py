"""The relations of a plan as a term of the layout's cost, and its analytic gradient.

A relation is a set of inequalities g(u) ≤ 0 on u (2,), the way from the reference's box centre to the subject's:

- left_of, right_of, in_front_of, behind, with the part of u along the word's direction d and the part across:
  the reference's half size − along ≤ 0, and ±cos 60°·across − sin 60°·along ≤ 0, the distances to the cone's sides.
- beside, near: the gap |max(|u| − (sum of half sizes), 0)| − largest gap ≤ 0; and that the boxes do not overlap,
  min(sum of half sizes − |u|) ≤ 0, which is J_coll's unless the frame is turned.
- center: the same with the largest offset in place of the half sizes, and a gap of 0.
- to the table: its box is its middle third; direction words have no cone, and the largest offset is half that box.

They are those of :func:`vcage.plans.relations.holds` and :func:`vcage.plans.relations.holds_on_table`. Each costs
nothing while it holds, its squared violation up to the knee, and grows linearly from there: one that cannot hold pulls
with a bounded force, which a collision outweighs.
``inside`` and ``on`` are no terms: assigning an object to its container keeps them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vcage.plans.relations import (
    BESIDE_GAP,
    CENTRE_MINIMUM,
    CENTRE_SHARE,
    CONE,
    DIRECTIONS,
    NEAR_GAP,
    middle_third,
)
from vcage.schema.plan import Relation, RelationWord

KNEE = 0.005
"""Violation from which a relation's cost grows linearly, metres."""
NEVER_MISSED = -1e3
"""Level of an inequality that is always met, metres: below anything that others are missed by."""
HELD = 1e-9
"""Metres by which an inequality must be met to count: the boxes that are judged are rounded too."""
_GAPS = {"beside": BESIDE_GAP, "near": NEAR_GAP}


@dataclass(frozen=True)
class RelatedBox:
    """A box that relations speak of, carried by a footprint of the problem.

    Args:
        index: of the footprint, or None for what does not move in the problem.
        offset: (2,) from the footprint's centre (from the frame's origin, for None) to the box's, world axes, metres.
        half: (2,) half size of the axis-aligned world box, metres.
        thirds: True for the middle third of the table, to which relations have a meaning of their own.
    """

    index: int | None
    offset: np.ndarray
    half: np.ndarray
    thirds: bool = False

    @classmethod
    def table(cls, workspace: np.ndarray) -> RelatedBox:
        """The table, with ``workspace`` (2, 2) free for objects."""
        lower, upper = middle_third(workspace)
        return cls(None, (lower + upper) / 2, (upper - lower) / 2, thirds=True)


@dataclass(frozen=True)
class RelationTerms:
    """The inequalities of t direction words and w gap words among n footprints, on the flat centres (2n,).

    Args:
        normals: (3t, 2n) and
        levels: (3t,) of the direction words: normals·x + levels ≤ 0.
        ways: (2w, 2n) and
        shifts: (2w,) of the gap words: u = ways·x + shifts, in the world, metres.
        inner: (2w,) offsets along each axis that leave no gap, metres.
        gap: (w,) largest gaps, metres; 0 for ``center``.
        turned: True if boxes that are apart in the problem's frame may overlap in the world.
    """

    normals: np.ndarray
    levels: np.ndarray
    ways: np.ndarray
    shifts: np.ndarray
    inner: np.ndarray
    gap: np.ndarray
    turned: bool = False

    def __len__(self) -> int:
        return len(self.levels) // 3 + len(self.gap)

    def tightened(self, slack: float) -> RelationTerms:
        """The same relations, to be met by ``slack`` metres more than they need."""
        apart = self.gap > 0
        inner = self.inner - np.repeat(np.where(apart, 0.0, slack), 2)
        return replace(self, levels=self.levels + slack, inner=inner, gap=self.gap - np.where(apart, slack, 0.0))

    def cost(self, centres: np.ndarray) -> tuple[float, np.ndarray | None]:
        """Σ of the violations' costs at ``centres`` (n, 2), and its gradient (n, 2), or None where it is zero."""
        flat = centres.ravel()
        value, gradient = 0.0, np.zeros_like(flat)
        if len(self.levels):
            violation = np.maximum(self.normals @ flat + self.levels, 0)
            bent = np.minimum(violation, KNEE)
            value = bent @ (2 * violation - bent)
            gradient = (2 * bent) @ self.normals
        if len(self.gap):
            far, pull = self._too_far(flat)
            close, push = self._too_close(flat) if self.turned else (0.0, 0.0)
            value += far + close
            gradient = gradient + (pull + push).ravel() @ self.ways
        return (float(value), gradient.reshape(-1, 2)) if value else (0.0, None)

    def _too_far(self, flat: np.ndarray) -> tuple[float, np.ndarray]:
        """Cost of gaps that are too wide, and its gradient (w, 2) with u."""
        u = self._ways(flat)
        outside = np.copysign(np.maximum(np.abs(u) - self._offsets, 0), u)
        distance = np.hypot(outside[:, 0], outside[:, 1])
        violation = np.maximum(distance - self.gap, 0)
        bent = np.minimum(violation, KNEE)
        slope = 2 * bent / np.maximum(distance, 1e-12)
        return float(bent @ (2 * violation - bent)), outside * slope[:, None]

    def _too_close(self, flat: np.ndarray) -> tuple[float, np.ndarray]:
        """Cost of overlaps among objects that need a gap, along the way out, and its gradient (w, 2) with u."""
        u = self._ways(flat)
        depth = self._offsets - np.abs(u)
        rows, axis = np.arange(len(u)), depth.argmin(axis=1)
        violation = np.where(self.gap > 0, np.maximum(depth[rows, axis], 0), 0)
        bent = np.minimum(violation, KNEE)
        slopes = np.zeros_like(u)
        slopes[rows, axis] = -np.copysign(2 * bent, u[rows, axis])
        return float(bent @ (2 * violation - bent)), slopes

    def violations(self, centres: np.ndarray) -> np.ndarray:
        """(t + w,) metres by which each relation misses the worst of its inequalities; below zero it holds."""
        flat = centres.ravel()
        towards = (self.normals @ flat + self.levels).reshape(-1, 3).max(axis=1)
        depth = self._offsets - np.abs(self._ways(flat))
        distance = np.hypot(*np.maximum(-depth, 0).T)
        within = np.where(distance > 0, distance - self.gap, -np.inf)
        return np.concatenate([towards, np.maximum(within, np.where(self.gap > 0, depth.min(axis=1), -np.inf))])

    def broken(self, centres: np.ndarray) -> int:
        """Number of relations that do not hold."""
        return int((self.violations(centres) > -HELD).sum())

    def without(self, index: int) -> RelationTerms:
        """All relations but one."""
        t = len(self.levels) // 3
        if index < t:
            rows = slice(3 * index, 3 * index + 3)
            return replace(self, normals=np.delete(self.normals, rows, 0), levels=np.delete(self.levels, rows))
        rows = slice(2 * (index - t), 2 * (index - t) + 2)
        return replace(
            self,
            ways=np.delete(self.ways, rows, 0),
            shifts=np.delete(self.shifts, rows),
            inner=np.delete(self.inner, rows),
            gap=np.delete(self.gap, index - t),
        )

    def _ways(self, flat: np.ndarray) -> np.ndarray:
        """(w, 2) u of the gap words."""
        return (self.ways @ flat + self.shifts).reshape(-1, 2)

    @property
    def _offsets(self) -> np.ndarray:
        return self.inner.reshape(-1, 2)


def relation_terms(
    relations: Sequence[Relation], spots: Mapping[str, RelatedBox], count: int, turn: np.ndarray | None = None
) -> RelationTerms | None:
    """The terms of the relations decided by the places of ``count`` footprints; None when there is none.

    Args:
        relations: of the plan; those of boxes outside ``spots`` or within one rigid group are left out.
        spots: where the boxes are, by object id (and ``table``).
        count: n of the problem.
        turn: (2, 2) from the problem's frame to the world; the identity when left out.
    """
    turn = np.eye(2) if turn is None else turn
    towards, within = [], []
    for word, subject, reference in _moving_apart(relations, spots):
        way, shift = _way(subject, reference, count, turn), subject.offset - reference.offset
        if word in DIRECTIONS:
            towards.append(_towards(np.array(DIRECTIONS[word]), way, shift, reference))
        elif word in _GAPS or word == "center":
            within.append((way, shift, *_within(word, subject, reference)))
    if not (towards or within):
        return None
    ways, shifts, inner, gap = zip(*within, strict=True) if within else ([], [], [], [])
    normals, levels = zip(*towards, strict=True) if towards else ([], [])
    return RelationTerms(
        normals=np.reshape(normals, (-1, 2 * count)),
        levels=np.reshape(levels, -1),
        ways=np.reshape(ways, (-1, 2 * count)),
        shifts=np.reshape(shifts, -1),
        inner=np.reshape(inner, -1),
        gap=np.reshape(gap, -1),
        turned=not np.allclose(np.abs(turn).max(axis=0), 1),
    )


def _moving_apart(
    relations: Sequence[Relation], spots: Mapping[str, RelatedBox]
) -> Iterator[tuple[RelationWord, RelatedBox, RelatedBox]]:
    """Word, subject and reference of the relations between boxes that do not move as one."""
    for r in relations:
        subject, reference = spots.get(r.subject), spots.get(r.reference)
        if subject is not None and reference is not None and subject.index != reference.index:
            yield r.relation, subject, reference


def _within(word: RelationWord, subject: RelatedBox, reference: RelatedBox) -> tuple[np.ndarray, float]:
    """(2,) offsets along each axis that leave no gap, and the largest gap, of a gap word or ``center``."""
    if word == "center" and reference.thirds:
        return reference.half, 0.0
    if word == "center":
        return np.maximum(CENTRE_MINIMUM, CENTRE_SHARE * 2 * reference.half), 0.0
    return subject.half + reference.half, _GAPS[word]


def _way(subject: RelatedBox, reference: RelatedBox, count: int, turn: np.ndarray) -> np.ndarray:
    """(2, 2n) the part of u that depends on the flat centres."""
    way = np.zeros((2, count, 2))
    if subject.index is not None:
        way[:, subject.index] += turn
    if reference.index is not None:
        way[:, reference.index] -= turn
    return way.reshape(2, -1)


def _towards(
    direction: np.ndarray, way: np.ndarray, shift: np.ndarray, reference: RelatedBox
) -> tuple[np.ndarray, np.ndarray]:
    """(3, 2n) normals and (3,) levels of a direction word: beyond the edge, and both sides of the cone.

    For a third of the table the edge alone counts, and the inequalities of the cone are always met.
    """
    if reference.thirds:
        normals, levels = np.zeros((3, way.shape[1])), np.full(3, NEVER_MISSED)
        normals[0], levels[0] = -direction @ way, -direction @ shift + np.abs(direction) @ reference.half
        return normals, levels
    across = np.array([-direction[1], direction[0]])
    sides = [np.cos(CONE) * sign * across - np.sin(CONE) * direction for sign in (1, -1)]
    normals = np.array([-direction, *sides])
    return normals @ way, normals @ shift + np.array([np.abs(direction) @ reference.half, 0.0, 0.0])
