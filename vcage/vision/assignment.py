"""Which object is where: one-to-one, with the right to be nowhere.

The paper pairs greedily, the most similar first. Here all pairs are chosen together so that the sum of their log odds
is largest (linear assignment); an object whose best pair is less likely than not stays unassigned. Where no two objects
want the same place, both rules give the same pairs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.special import expit

SAME_PLACE = 0.3
"""Overlap (intersection over union) of two candidates that are at the same place."""

SHRINK = 4
"""Overlaps are counted in a picture so many times smaller."""

EQUALLY_LIKELY = 2.0
"""Difference of the log odds of two poses of an object at one place that says nothing."""

TWIN = 2.5
"""Log odds of another place, and how little they may be below the chosen one's, for an object that is drawn twice."""

MARGIN_SCALE = 3.0
"""Difference of log odds to the next best explanation that makes it unlikely."""


@dataclass(frozen=True)
class Chosen:
    """The candidate that an object was given.

    Args:
        index: of the object's candidate.
        odds: log odds of the candidate.
        margin: how much better it is than the next best explanation: the object elsewhere, or another object that has
            no place at this one.
        twin: index of a candidate of the same object that fits nearly as well and that no object took, or None.
    """

    index: int
    odds: float
    margin: float
    twin: int | None

    @property
    def confidence(self) -> float:
        """Estimated probability that the match is right."""
        return float(expit(self.odds / 2) * (0.5 + 0.5 * np.tanh(max(self.margin, 0.0) / MARGIN_SCALE)))


def assign(masks: Sequence[Sequence[np.ndarray]], odds: Sequence[np.ndarray]) -> dict[int, Chosen]:
    """Object index → the candidate it was given; objects that are nowhere are left out.

    Args:
        masks: per object the (H, W) masks of its candidates.
        odds: per object (k,) their log odds.
    """
    owners = np.array([i for i, of_one in enumerate(odds) for _ in of_one], dtype=int)
    inner = np.array([k for of_one in odds for k in range(len(of_one))], dtype=int)
    if not len(owners):
        return {}
    flat = np.concatenate(odds)
    sites = _sites(_overlaps([mask for of_one in masks for mask in of_one]), flat)
    table = np.full((len(odds), sites.max() + 1), -np.inf)
    best = np.full(table.shape, -1)
    np.maximum.at(table, (owners, sites), flat)
    # Candidates are in the order of their fit: of an object's likely poses at one place the first has its heading.
    for j in np.flatnonzero(flat >= table[owners, sites] - EQUALLY_LIKELY)[::-1]:
        best[owners[j], sites[j]] = inner[j]
    cost = np.concatenate([np.where(np.isfinite(table), -table, 1e6), np.zeros((len(odds), len(odds)))], axis=1)
    rows, columns = linear_sum_assignment(cost)
    taken = {int(r): int(c) for r, c in zip(rows, columns, strict=True) if c < table.shape[1] and table[r, c] > 0}
    return {i: _chosen(i, site, table, best, taken) for i, site in taken.items()}


def _chosen(i: int, site: int, table: np.ndarray, best: np.ndarray, taken: dict[int, int]) -> Chosen:
    free = np.ones(table.shape[1], bool)
    free[list(taken.values())] = False
    elsewhere = np.where(free, table[i], -np.inf)
    homeless = [k for k in range(len(table)) if k not in taken]
    rival = max((float(table[k, site]) for k in homeless), default=-np.inf)
    other = float(elsewhere.max(initial=-np.inf))
    margin = float(table[i, site] - max(rival, other, 0.0))
    twin = int(best[i, int(elsewhere.argmax())]) if other > max(TWIN, table[i, site] - TWIN) else None
    return Chosen(int(best[i, site]), float(table[i, site]), margin, twin)


def _overlaps(masks: Sequence[np.ndarray]) -> np.ndarray:
    """(n, n) intersection over union of all candidates' masks."""
    flat = np.array([mask[::SHRINK, ::SHRINK].reshape(-1) for mask in masks], np.float32)
    together = flat @ flat.T
    areas = flat.sum(axis=1)
    return together / np.maximum(areas[:, None] + areas[None] - together, 1e-6)


def _sites(overlaps: np.ndarray, odds: np.ndarray) -> np.ndarray:
    """(n,) number of the place of each candidate: the best one leads, those that overlap it follow."""
    sites = np.full(len(odds), -1)
    leaders: list[int] = []
    for j in np.argsort(-odds, kind="stable"):
        near = [(overlaps[j, leader], site) for site, leader in enumerate(leaders) if overlaps[j, leader] > SAME_PLACE]
        if near:
            sites[j] = max(near)[1]
        else:
            sites[j] = len(leaders)
            leaders.append(int(j))
    return sites
