"""Layouts with noise made collision-free again: what is left, what it costs, and what plain L-BFGS-B makes of them.

Every scene begins as a layout that is known to be good (``benchmarks/_optimize_scenes.py``): real objects, a workspace
of 2:1 filled up to 60 %, contents in containers, and in every third scene a region that an arm reaches. A plan is read
off it, then every target gets normal noise. As the clean layout exists, no scene is truly infeasible.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from benchmarks._optimize_checks import EXACT, Standing, colliding_boxes, colliding_meshes
from benchmarks._optimize_kinds import own_kinds
from benchmarks._optimize_rival import finite_differences
from benchmarks._optimize_scenes import MARGIN, CleanScene, draw_scene, is_within
from vcage.assets.library import Library
from vcage.errors import InfeasibleScene
from vcage.igsc.layout.cost import Weights
from vcage.igsc.layout.optimize import LayoutResult, optimize_layout
from vcage.igsc.relations import relations_kept
from vcage.schema.scene import Table

logger = logging.getLogger(__name__)

SIGMAS = (0.01, 0.03, 0.06)
"""Standard deviation of the targets along each axis, metres."""
GRID = tuple((n, c) for n in (5, 10, 20, 30, 40) for c in (0, 2, 5) if 2 * c <= n)
"""Objects in all, and how many of them hold others."""
RESTARTS = 6
"""As the stage has it."""
LONGER = 10
"""Times as many restarts for scenes that were declared infeasible."""
RIVAL_OBJECTS = 20
"""Most objects with which the rival tries every scene."""
SEED = 4


def run(quick: bool) -> dict[str, Any]:
    """One row for each noise, number of objects and number of containers; failures go to the log with their seeds.

    Rates are shares of scenes. ``collision_*``, ``in_bounds``, ``relations_kept`` and the displacements are of the
    scenes that were solved; ``finite_difference_*`` of those of them that the rival tried, ``in_reach`` of those that
    an arm's reach binds. Times are the process's own, in one thread: what else the machine does is not in them.

    Args:
        quick: 10 scenes of each row instead of 60. The rival, slow on many objects, tries all with up to 20 objects
            and the first 3 (not quick: 8) of each row with more.

    Returns:
        The rows, and under ``goals`` what the scenes of several rows have together.
    """
    scenes, rivals = (10, 3) if quick else (60, 8)
    kinds = own_kinds(Library.load())
    rows: dict[tuple[float, int, int], Row] = {}
    clock = _Clock(sum(n for n, _ in GRID))
    with threadpool_limits(limits=1):
        for n, containers in GRID:
            for k in range(scenes):
                seed, rival = [SEED, n, containers, k], n <= RIVAL_OBJECTS or k < rivals
                clean = draw_scene(kinds, n, containers, k % 3 == 0, np.random.default_rng(seed))
                for sigma in SIGMAS:
                    row = rows.setdefault((sigma, n, containers), Row(sigma, n, containers))
                    row.add(measure(clean, sigma, [*seed, int(1000 * sigma)], rival))
            clock.done(n, f"{n} objects, {containers} containers")
    ordered = [rows[key] for key in sorted(rows)]
    for row in ordered:
        logger.info("%s", row.sentence())
    goals = _goals(ordered)
    logger.info("%s", "  ".join(f"{key} {value}" for key, value in goals.items()))
    return {"rows": [row.record() for row in ordered], "goals": goals}


@dataclass(frozen=True)
class Outcome:
    """What came of one scene; all but the times and ``kept_targets`` is None where it was declared infeasible.

    Args:
        ms: time of the optimisation.
        kept_targets: share of the plan's relations that the noisy targets keep.
        boxes, meshes: pairs of ids that collide.
        in_bounds: whether every box is in the workspace.
        in_reach: whether what is bound and on the table is where it may be; None when nothing is bound.
        kept: share of the plan's relations that the layout keeps.
        displacements: of every object from its target in the plane, metres.
        restarts: starts of the table's problem.
        longer_solves: whether a search with more restarts solves it; None when it was solved at once.
        rival_ratio: time of the rival over ours; None when it did not try.
        rival_solves: whether the rival's layout has no collision.
    """

    ms: float
    kept_targets: float
    boxes: list[tuple[str, str]] | None = None
    meshes: list[tuple[str, str]] | None = None
    in_bounds: bool | None = None
    in_reach: bool | None = None
    kept: float | None = None
    displacements: list[float] | None = None
    restarts: int | None = None
    longer_solves: bool | None = None
    rival_ratio: float | None = None
    rival_solves: bool | None = None


def measure(clean: CleanScene, sigma: float, seed: Sequence[int], rival: bool) -> Outcome:
    """Optimise one clean scene from targets with noise, and judge what is returned."""
    targets = clean.targets(sigma, np.random.default_rng(seed))
    at_targets = clean.standing({id: (*target, 0.0) for id, target in targets.items()}, {})
    kept_targets = _kept(clean, at_targets)
    started = time.process_time()
    try:
        result = _optimize(clean, targets, [*seed, 1], RESTARTS)
    except InfeasibleScene as error:
        ms = 1000 * (time.process_time() - started)
        longer = _longer_solves(clean, targets, [*seed, 2])
        logger.info("seed %s: infeasible (%s); ten times longer: %s", seed, error.message, longer)
        return Outcome(ms, kept_targets, longer_solves=longer)
    ms = 1000 * (time.process_time() - started)
    standing = clean.standing(result.positions, result.containers)
    outcome = Outcome(
        ms,
        kept_targets,
        boxes=colliding_boxes(standing),
        meshes=colliding_meshes(standing),
        in_bounds=all(_in_bounds(clean, thing) for thing in standing.values()),
        in_reach=_in_reach(clean, standing) if clean.allowed else None,
        kept=_kept(clean, standing),
        displacements=[float(np.hypot(*(thing.pose.p[:2] - targets[id]))) for id, thing in standing.items()],
        restarts=result.starts,
        **(_rival(clean, targets, ms) if rival else {}),
    )
    _log_failure(clean, seed, standing, outcome)
    return outcome


def _optimize(clean: CleanScene, targets: dict[str, np.ndarray], seed: Sequence[int], restarts: int) -> LayoutResult:
    return optimize_layout(
        clean.items(targets),
        clean.workspace,
        np.random.default_rng(seed),
        table_height=0.0,
        margin=MARGIN,
        restarts=restarts,
        relations=clean.relations,
    )


def _longer_solves(clean: CleanScene, targets: dict[str, np.ndarray], seed: Sequence[int]) -> bool:
    try:
        _optimize(clean, targets, seed, LONGER * RESTARTS)
    except InfeasibleScene:
        return False
    return True


def _kept(clean: CleanScene, standing: dict[str, Standing]) -> float:
    return relations_kept(clean.relations, {id: thing.box for id, thing in standing.items()}, Table()).share


def _in_bounds(clean: CleanScene, thing: Standing) -> bool:
    lower, upper = clean.workspace
    return bool(np.all(thing.box[0, :2] >= lower - EXACT) and np.all(thing.box[1, :2] <= upper + EXACT))


def _in_reach(clean: CleanScene, standing: dict[str, Standing]) -> bool:
    bound = [(thing.pose.p[:2], clean.allowed.get(id)) for id, thing in standing.items() if thing.container is None]
    return all(is_within(at, rectangles, EXACT) for at, rectangles in bound if rectangles is not None)


def _rival(clean: CleanScene, targets: dict[str, np.ndarray], ms: float) -> dict[str, Any]:
    """The rival moves the same objects, told what lies in what; it is judged by what stands on the table."""
    problems = clean.problems(targets)
    started = time.process_time()
    centres = {at: finite_differences(problem, Weights()) for at, (_, problem) in problems.items()}
    seconds = time.process_time() - started
    roots = problems[None][0]
    moved = {id: (*centre, 0.0) for id, centre in zip(roots, centres[None], strict=True)}
    standing = clean.standing({**dict.fromkeys(clean.kinds, (0.0, 0.0, 0.0)), **moved}, {})
    solved = not colliding_boxes({id: standing[id] for id in roots})
    return {"rival_ratio": 1000 * seconds / ms, "rival_solves": solved}


def _log_failure(clean: CleanScene, seed: Sequence[int], standing: dict[str, Standing], outcome: Outcome) -> None:
    for what, pairs in (("boxes", outcome.boxes), ("meshes", outcome.meshes)):
        for a, b in pairs:
            logger.info("seed %s: %s of %s and %s collide", seed, what, a, b)
    if not outcome.in_bounds:
        logger.info("seed %s: out of bounds", seed)
    if outcome.in_reach is False:
        logger.info("seed %s: out of reach", seed)
    broken = relations_kept(clean.relations, {id: thing.box for id, thing in standing.items()}, Table()).broken
    if broken:
        words = ", ".join(f"{r.subject} {r.relation} {r.reference}" for r in broken)
        logger.info("seed %s: %d of %d relations broken: %s", seed, len(broken), len(clean.relations), words)


@dataclass
class Row:
    """The outcomes of one noise, number of objects and number of containers."""

    sigma: float
    n: int
    containers: int
    outcomes: list[Outcome] = field(default_factory=list)

    def add(self, outcome: Outcome) -> None:
        self.outcomes.append(outcome)

    def record(self) -> dict[str, Any]:
        """The row of the table; None where no scene has the figure."""
        solved = [o for o in self.outcomes if o.longer_solves is None]
        displacements = [1000 * d for o in solved for d in o.displacements]
        rivals = [o for o in solved if o.rival_ratio is not None]
        ms = [o.ms for o in self.outcomes]
        return {
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
            "scenes": len(self.outcomes),
        }

    def sentence(self) -> str:
        """The row in one line of the log."""
        return "  ".join(f"{key} {value}" for key, value in self.record().items())


def _goals(rows: Sequence[Row]) -> dict[str, float | None]:
    """The figures that the benchmark is about, over all rows, or those of one noise or number of objects."""
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
    return Row(0.0, 0, 0, [outcome for row in rows if chosen(row) for outcome in row.outcomes]).record()


def _share(outcomes: Sequence[Outcome], meets: Callable[[Outcome], bool]) -> float | None:
    return _rounded([float(meets(o)) for o in outcomes], np.mean, 4)


def _rounded(values: Sequence[float], reduce: Callable[[Sequence[float]], float], digits: int) -> float | None:
    return round(float(reduce(values)), digits) if values else None


def _p95(values: Sequence[float]) -> float:
    return float(np.percentile(values, 95))


class _Clock:
    """Tells after each part of the work how much time the rest will take; parts are weighted by what they cost."""

    def __init__(self, total: float):
        self._total, self._spent, self._started = total, 0.0, time.perf_counter()

    def done(self, weight: float, what: str) -> None:
        self._spent += weight
        seconds = time.perf_counter() - self._started
        left = seconds * (self._total / self._spent - 1)
        logger.info("%s: %.0f s so far, about %.0f s left", what, seconds, left)
