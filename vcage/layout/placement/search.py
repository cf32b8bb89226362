"""Finds a place for every item of a plane.

1. *Scattering*: the items, largest first, each at a random heading and at a point drawn uniformly from its exact free
   region. An item without room goes where it displaces least, and the displaced items are scattered again.
2. *Packing*, when that fails: every item at a corner of its free region, at one of its smallest headings; by turns at
   the corner furthest into one corner of the plane, and where most of its border touches something. A leftover item
   is placed earlier in the next pass (Joslin and Clements, "Squeaky wheel optimization", 1999).
3. *Shaking* of the packed items: each is drawn again from the free region around it (Gibbs sampling), so that a
   full plane looks as random as its room allows.

All of it is bounded by counts, never by time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.layout.placement.arrangement import Arrangement, Spot
from vcage.layout.placement.plane import Plane, Stance


@dataclass(frozen=True)
class Thrift:
    """The choice of headings of a scattering.

    Args:
        largest: how many times its smallest rectangle an item may take.
        full: share of the plane that the items' mean rectangles may take for it to be worth trying.
    """

    largest: float
    full: float


THRIFT = (Thrift(np.inf, 0.9), Thrift(1.15, 0.82))
"""Scatterings that are tried: at any heading, then at small ones only. What is fuller is seldom scattered, and packing
it at once is quicker."""


@dataclass(frozen=True)
class SearchSettings:
    """Settings of scattering, packing and shaking.

    Args:
        related_scatterings: at each thrift where items must keep relations: the first may leave the others no room.
        returns_share: times that a scattering goes back, for each item.
        passes: orders that are packed at most; most planes need one, hard cases some dozens.
        sweeps: times that every item of a packed plane is drawn again.
        candidates: random points, for each heading, at which an item without room may push others away.
        size_jitter: relative noise of an item's size in the order of packing.
        blame: growth of a leftover's size; the largest size is 1.
        corners: number of corners furthest into the plane's corner examined for contact.
        tie_weight: of the criterion between corners that are equally good.
    """

    related_scatterings: int = 12
    returns_share: float = 0.5
    passes: int = 80
    sweeps: int = 2
    candidates: int = 24
    size_jitter: float = 0.15
    blame: float = 0.15
    corners: int = 200
    tie_weight: float = 1e-3


SETTINGS = SearchSettings()

_SWEEPS = [(first, np.array([sx, sy])) for first in (0, 1) for sx in (1, -1) for sy in (1, -1)]
"""Directions in which packing fills the plane: the axis that is swept first, and the sign of each axis."""


@dataclass(frozen=True)
class Outcome:
    """The result of a search.

    Args:
        spots: by index of the item; of all items, or of those with room.
        left: indices of the items without a place, largest first.
    """

    spots: dict[int, Spot]
    left: list[int]


def arrange(plane: Plane, rng: np.random.Generator) -> Outcome:
    """A random arrangement of all items, or the fullest that was packed."""
    arrangement = Arrangement(plane)
    for thrift in THRIFT:
        stances = [[s for s in all_ if s.area <= thrift.largest * all_[0].area + 1e-12] for all_ in plane.stances]
        if _mean_needed(plane, stances) <= thrift.full * plane.available:
            tries = 1 if plane.related is None else SETTINGS.related_scatterings
            if any(_scatter(arrangement, stances, rng) for _ in range(tries)):
                return Outcome(arrangement.spots, [])
    outcome = pack_in_corners(plane, SETTINGS.passes, rng)
    if outcome.left:
        return outcome
    arrangement.restore(outcome.spots)
    for _ in range(SETTINGS.sweeps):
        for k in rng.permutation(len(plane.items)):
            _draw(arrangement, int(k), plane.stances[k], rng)
    return Outcome(arrangement.spots, [])


# --- scattering ----------------------------------------------------------------------------------------


def _mean_needed(plane: Plane, stances: Sequence[Sequence[Stance]]) -> float:
    """Area that the items take with margins at their mean heading, m²."""
    total = 0.0
    for choices in stances:
        counts = [len(stance.yaws) for stance in choices]
        areas = [float((2 * stance.half + plane.margin).prod()) for stance in choices]
        total += float(np.average(areas, weights=counts))
    return total


def _scatter(arrangement: Arrangement, stances: Sequence[Sequence[Stance]], rng: np.random.Generator) -> bool:
    plane = arrangement.plane
    arrangement.restore({})
    rank = {k: i for i, k in enumerate(plane.order)}
    pushed = np.ones(len(plane.items))
    queue, returns = list(plane.order), int(SETTINGS.returns_share * len(plane.items))
    while queue:
        k = queue.pop(0)
        if _draw(arrangement, k, stances[k], rng):
            continue
        out = _push_in(arrangement, k, pushed, rng) if returns > 0 else None
        if out is None:
            return False
        returns -= 1
        queue = sorted([*queue, *out], key=rank.__getitem__)
    return True


def _draw(arrangement: Arrangement, k: int, stances: Sequence[Stance], rng: np.random.Generator) -> bool:
    """Place or move item ``k`` to a random heading and point; the first heading of a random order that has room."""
    headings = [(stance, yaw) for stance in stances for yaw in stance.yaws]
    tight: set[int] = set()
    for index in rng.permutation(len(headings)):
        stance, yaw = headings[index]
        if id(stance) in tight:
            continue
        at = arrangement.draw(k, stance, yaw, rng)
        if at is not None:
            arrangement.put(k, Spot(stance, at, yaw))
            return True
        tight.add(id(stance))
    return False


def _push_in(arrangement: Arrangement, k: int, pushed: np.ndarray, rng: np.random.Generator) -> list[int] | None:
    """Place item ``k`` where the least is in its way, and take that away; its indices, or None when it fits nowhere.

    Items pushed away before count for more, so that two items do not push each other for ever.
    """
    plane, best = arrangement.plane, None
    if plane.related is not None and plane.related.binds(plane.items[k].id):
        return None  # an item in its way may be its partner in a relation
    for stance in plane.compact[k]:
        region = plane.alone(stance)
        centres = np.concatenate([region.samples(rng, SETTINGS.candidates), region.corners()])
        hits = arrangement.conflicts(k, stance, centres)  # (c, n)
        costs = hits @ (plane.areas * pushed)
        c = int(np.argmin(costs))
        if best is None or costs[c] < best[0]:
            best = float(costs[c]), Spot(stance, centres[c], float(rng.choice(stance.yaws))), np.flatnonzero(hits[c])
    if best is None:
        return None
    _, spot, out = best
    for j in out:
        arrangement.take(int(j))
    pushed[out] *= 1.5
    arrangement.put(k, spot)
    return out.tolist()


# --- packing -------------------------------------------------------------------------------------------


def pack_in_corners(plane: Plane, passes: int, rng: np.random.Generator) -> Outcome:
    """All items packed, or the pass that left the least area over."""
    arrangement, best = Arrangement(plane), Outcome({}, list(plane.order))
    sizes = _sizes(plane)
    blame = np.zeros(len(plane.items))
    for index in range(passes):
        size = sizes[index % len(sizes)]
        noise = rng.normal(0, SETTINGS.size_jitter if index >= len(sizes) else 0.0, len(size))
        order = np.argsort(-(size * np.exp(noise) + blame), kind="stable")
        left = _pack_once(arrangement, order.tolist(), *_SWEEPS[rng.integers(len(_SWEEPS))], snug=index % 2 == 1)
        if _cost(plane, left) < _cost(plane, best.left):
            best = Outcome(arrangement.spots, [k for k in plane.order if k in left])
        if not left:
            break
        blame[left] += SETTINGS.blame
    return best


def _sizes(plane: Plane) -> list[np.ndarray]:
    """Measures (n,) of how hard items are to place, at most 1: area, longest side, girth."""
    smallest = np.array([stances[0].half for stances in plane.stances]).reshape(-1, 2)
    measures = (plane.areas, smallest.max(axis=1), smallest.sum(axis=1))
    return [measure / measure.max(initial=1e-12) for measure in measures]


def _cost(plane: Plane, left: Sequence[int]) -> tuple[int, float]:
    return len(left), float(plane.areas[list(left)].sum())


def _pack_once(arrangement: Arrangement, order: Sequence[int], first: int, signs: np.ndarray, snug: bool) -> list[int]:
    """Place the items one by one in corners, with most contact if ``snug``; the indices of items without a place."""
    arrangement.restore({})
    left = []
    for k in order:
        best = None
        for stance in arrangement.plane.compact[k]:
            yaw = stance.yaws[0]
            corners = arrangement.related(k, yaw, arrangement.region(k, stance, yaw).corners())
            if not len(corners):
                continue
            far = corners * signs + stance.half
            costs = far[:, first] + SETTINGS.tie_weight * far[:, 1 - first]
            if snug:
                near = np.argsort(costs, kind="stable")[: SETTINGS.corners]
                corners = corners[near]
                costs = SETTINGS.tie_weight * costs[near] - arrangement.touching(stance, corners)
            c = int(np.argmin(costs))
            if best is None or costs[c] < best[0]:
                best = costs[c], Spot(stance, corners[c], yaw)
        if best is None:
            left.append(k)
        else:
            arrangement.put(k, best[1])
    return left
