"""Outcomes of the scenes of the optimisation benchmark, and the figures of a row."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Outcome:
    """Outcome of one scene; from ``boxes`` on all but ``longer_solves`` is None where it was declared infeasible.

    Args:
        fill: share of the workspace that is covered.
        ms: time of the optimisation.
        kept_targets: share of the plan's relations that the noisy targets keep.
        boxes, meshes: pairs of ids that collide.
        in_bounds: True if every box is in the workspace.
        in_reach: True if every bound object on the table is in reach; None when nothing is bound.
        kept: share of the plan's relations that hold in the layout.
        displacements: of every object from its target in the plane, metres.
        restarts: starts of the table's problem.
        hand_room: share of the room for hands that was found.
        longer_solves: whether a search with more restarts solves it; None when it was solved at once.
        rival_ratio: time of the rival over ours; None when it did not try.
        rival_solves: whether the rival's layout has no collision.
    """

    fill: float
    ms: float
    kept_targets: float
    boxes: list[tuple[str, str]] | None = None
    meshes: list[tuple[str, str]] | None = None
    in_bounds: bool | None = None
    in_reach: bool | None = None
    kept: float | None = None
    displacements: list[float] | None = None
    restarts: int | None = None
    hand_room: float | None = None
    longer_solves: bool | None = None
    rival_ratio: float | None = None
    rival_solves: bool | None = None


@dataclass
class Row:
    """The outcomes of one setting, noise, number of objects and number of containers."""

    setting: str
    sigma: float
    n: int
    containers: int
    outcomes: list[Outcome] = field(default_factory=list)

    def record(self) -> dict[str, Any]:
        """The row of the table; None where no scene has the figure."""
        solved = [o for o in self.outcomes if o.longer_solves is None]
        displacements = [1000 * d for o in solved for d in o.displacements or ()]
        rivals = [o for o in solved if o.rival_ratio is not None]
        ms = [o.ms for o in self.outcomes]
        return {
            "setting": self.setting,
            "sigma_cm": round(100 * self.sigma, 1),
            "n": self.n,
            "containers": self.containers,
            "solved": _share(self.outcomes, lambda o: o.longer_solves is None),
            "collision_aabb": _share(solved, lambda o: bool(o.boxes)),
            "collision_mesh": _share(solved, lambda o: bool(o.meshes)),
            "in_bounds": _share(solved, lambda o: o.in_bounds),
            "in_reach": _share([o for o in solved if o.in_reach is not None], lambda o: o.in_reach),
            "relations_kept": _rounded([o.kept for o in solved], np.mean, 4),
            "relations_kept_targets": _rounded([o.kept_targets for o in solved], np.mean, 4),
            "displacement_mm_p50": _rounded(displacements, np.median, 1),
            "displacement_mm_p95": _rounded(displacements, _p95, 1),
            "restarts_p50": _rounded([o.restarts for o in solved], np.median, 1),
            "ms_p50": _rounded(ms, np.median, 2),
            "ms_p95": _rounded(ms, _p95, 2),
            "finite_difference_ratio": _rounded([o.rival_ratio for o in rivals], np.median, 2),
            "finite_difference_solved": _share(rivals, lambda o: o.rival_solves),
            "infeasible": _share(self.outcomes, lambda o: o.longer_solves is not None),
            "false_infeasible": _share(self.outcomes, lambda o: bool(o.longer_solves)),
            "hand_room": _rounded([o.hand_room for o in solved], np.mean, 4),
            "fill": _rounded([o.fill for o in self.outcomes], np.mean, 4),
            "scenes": len(self.outcomes),
        }


def goals(rows: Sequence[Row]) -> dict[str, float | None]:
    """The benchmark's figures, over all rows, or over those of one noise or number of objects."""
    everything = _pooled(rows, lambda row: True)
    return {
        "collision_aabb": everything["collision_aabb"],
        "collision_mesh": everything["collision_mesh"],
        "in_bounds": everything["in_bounds"],
        "relations_kept_at_3_cm": _pooled(rows, lambda row: row.sigma == 0.03)["relations_kept"],
        "finite_difference_ratio_at_20": _pooled(rows, lambda row: row.n == 20)["finite_difference_ratio"],
        "ms_p50_at_10": _pooled(rows, lambda row: row.n == 10)["ms_p50"],
        "false_infeasible": everything["false_infeasible"],
    }


def _pooled(rows: Sequence[Row], chosen: Callable[[Row], bool]) -> dict[str, Any]:
    return Row("", 0.0, 0, 0, [outcome for row in rows if chosen(row) for outcome in row.outcomes]).record()


def _share(outcomes: Sequence[Outcome], meets: Callable[[Outcome], bool | None]) -> float | None:
    return _rounded([float(bool(meets(o))) for o in outcomes], np.mean, 4)


def _rounded(values: Sequence[float | None], reduce: Callable[[Sequence[float]], float], digits: int) -> float | None:
    known = [value for value in values if value is not None]
    return round(float(reduce(known)), digits) if known else None


def _p95(values: Sequence[float]) -> float:
    return float(np.percentile(values, 95))
