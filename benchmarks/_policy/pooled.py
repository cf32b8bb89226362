"""Several trainings of each row, pooled: rows beside their rivals, and the trainings of one row beside each other.

Two networks that are trained alike but for their seed also succeed from different starts. So a difference between rows
counts for little where the trainings of one row differ by as much.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import combinations
from statistics import NormalDist
from typing import Any

from vcage.base.proportions import LEVEL
from vcage.evaluation.comparison import compare, mcnemar_p
from vcage.schema.evaluation import Comparison, Evaluation, success_facts

Trainings = Mapping[tuple[str, int], Evaluation]
"""(Name of the row, seed of the training) → its evaluation."""


def pooled(trainings: Trainings, rivals: Mapping[str, str]) -> dict[str, list[dict[str, Any]]]:
    """Tables of several trainings.

    - ``pooled``: all trainings of a row, and the successes of each in the order of the seeds.
    - ``against_rivals``: a row and its rival, paired by seed and start: ``b`` and ``c`` count the pairs in which only
      the row or only its rival succeeds. ``points`` are those of the row less the rival's, in percent of the pairs,
      ``points_by_seed`` of each pair of trainings.
    - ``between_trainings``: the same of two trainings of one row, paired by start.

    Args:
        trainings: of all rows.
        rivals: row → the row that it is compared with.

    Raises:
        UsageError: two that are compared have other starts.
    """
    rows = {name: sorted(seed for row, seed in trainings if row == name) for name, _ in trainings}
    against = {
        name: [compare(trainings[name, seed], trainings[rivals[name], seed], rivals[name]) for seed in seeds]
        for name, seeds in rows.items()
        if name in rivals and all((rivals[name], seed) in trainings for seed in seeds)
    }
    return {
        "pooled": [_row(name, [trainings[name, seed] for seed in seeds]) for name, seeds in rows.items()],
        "against_rivals": [
            {"trained_on": name, "rival": rivals[name], **_paired(pairs), "points_by_seed": [*map(_points, pairs)]}
            for name, pairs in against.items()
        ],
        "between_trainings": [
            {"trained_on": name, "seed": one, "other_seed": other}
            | _paired([compare(trainings[name, one], trainings[name, other], str(other))])
            for name, seeds in rows.items()
            for one, other in combinations(seeds, 2)
        ],
    }


def _row(name: str, trainings: Sequence[Evaluation]) -> dict[str, Any]:
    successes = [training.successes for training in trainings]
    facts = success_facts(sum(successes), sum(len(training.rollouts) for training in trainings))
    return {"trained_on": name, "trainings": len(trainings), **facts, "n_success_by_seed": successes}


def _paired(pairs: Sequence[Comparison]) -> dict[str, Any]:
    """Figures of all pairs of some comparisons."""
    count, b, c = (sum(getattr(pair, key) for pair in pairs) for key in ("n_episodes", "b", "c"))
    return {
        "n_pairs": count,
        "n_success": sum(pair.n_success for pair in pairs),
        "n_success_other": sum(pair.n_success_other for pair in pairs),
        "b": b,
        "c": c,
        "mcnemar_p": mcnemar_p(b, c),
        "points": round(100 * (b - c) / count, 2),
        "points_ci95": [round(100 * end, 2) for end in difference(b, c, count)],
    }


def _points(pair: Comparison) -> float:
    return round(100 * (pair.b - pair.c) / pair.n_episodes, 2)


def difference(b: int, c: int, count: int) -> tuple[float, float]:
    """The interval at 95 % of the difference (b - c) / count of two paired proportions.

    Source: Agresti, A. and Min, Y. (2005), Simple improved confidence intervals for comparing matched proportions,
    Statistics in Medicine 24: Wald's interval after half a pair is added to each of the four cells.

    Args:
        b, c: pairs in which only the one or only the other succeeds.
        count: all pairs.
    """
    more, less, total = b + 0.5, c + 0.5, count + 2
    middle, z = (more - less) / total, NormalDist().inv_cdf((1 + LEVEL) / 2)
    half = z * math.sqrt(more + less - (more - less) ** 2 / total) / total
    return max(-1.0, middle - half), min(1.0, middle + half)
