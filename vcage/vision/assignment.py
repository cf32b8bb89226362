"""Assignment of objects to candidate poses: one to one, and an object may stay without a place.

The paper pairs greedily, the most similar first. Here all pairs are chosen together so that the sum of their log odds
is largest (linear assignment); an object whose best pair is less likely than not stays unassigned. Where no two objects
compete for a place, both rules give the same pairs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.special import expit


@dataclass(frozen=True)
class AssignmentSettings:
    """Limits of the assignment; odds are logarithms.

    Args:
        same_place_iou: candidates whose masks overlap by more (intersection over union) are at the same place.
        stride_px: overlaps are counted on every n-th pixel along each side.
        equal_odds: poses of an object at one place whose odds differ by less are equally likely.
        twin_odds: an object is drawn twice when another place has such odds, and is at most so much less likely.
        margin_odds: lead over the next best explanation at which a mistake is unlikely.
    """

    same_place_iou: float = 0.3
    stride_px: int = 4
    equal_odds: float = 2.0
    twin_odds: float = 2.5
    margin_odds: float = 3.0


SETTINGS = AssignmentSettings()


@dataclass(frozen=True)
class Chosen:
    """The candidate that was assigned to an object.

    Args:
        index: of the object's candidate.
        odds: log odds of the candidate.
        margin: lead over the next best explanation: the object elsewhere, or an unplaced object here.
        twin: index of a candidate of the same object at another free place that fits nearly as well, or None.
    """

    index: int
    odds: float
    margin: float
    twin: int | None

    @property
    def confidence(self) -> float:
        """Estimated probability that the match is right."""
        return float(expit(self.odds / 2) * (0.5 + 0.5 * np.tanh(max(self.margin, 0.0) / SETTINGS.margin_odds)))


def assign(masks: Sequence[Sequence[np.ndarray]], odds: Sequence[np.ndarray]) -> dict[int, Chosen]:
    """Object index → its candidate; objects without a place are left out.

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
    # Candidates are in the order of their fit: of an object's likely poses at one place the first is taken.
    for j in np.flatnonzero(flat >= table[owners, sites] - SETTINGS.equal_odds)[::-1]:
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
    drawn_twice = other > max(SETTINGS.twin_odds, table[i, site] - SETTINGS.twin_odds)
    twin = int(best[i, int(elsewhere.argmax())]) if drawn_twice else None
    return Chosen(int(best[i, site]), float(table[i, site]), margin, twin)


def _overlaps(masks: Sequence[np.ndarray]) -> np.ndarray:
    """(n, n) intersection over union of all candidates' masks."""
    stride = SETTINGS.stride_px
    flat = np.array([mask[::stride, ::stride].reshape(-1) for mask in masks], np.float32)
    together = flat @ flat.T
    areas = flat.sum(axis=1)
    return together / np.maximum(areas[:, None] + areas[None] - together, 1e-6)


def _sites(overlaps: np.ndarray, odds: np.ndarray) -> np.ndarray:
    """(n,) number of each candidate's place: the likeliest leads a place, and candidates that overlap it follow."""
    sites = np.full(len(odds), -1)
    leaders: list[int] = []
    for j in np.argsort(-odds, kind="stable"):
        overlap = overlaps[j, leaders]
        if len(leaders) and overlap.max() > SETTINGS.same_place_iou:
            sites[j] = np.flatnonzero(overlap == overlap.max())[-1]
        else:
            sites[j] = len(leaders)
            leaders.append(int(j))
    return sites
