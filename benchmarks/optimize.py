"""Noisy layouts made collision-free again: remaining overlap, cost, and the result of plain L-BFGS-B.

Every scene begins as a layout that is known to be good (``benchmarks/_optimize_scenes.py``): real objects, a workspace
of 2:1 filled up to 60 %, contents in containers, and in every third scene a region that an arm reaches. A plan is read
off it, then every target gets normal noise. As the clean layout exists, no scene is truly infeasible.

Objects are described to the optimiser as the pipeline's stage describes them, with the room that moving parts sweep.
The rows come in two settings: ``plain`` asks for a gap of 1 cm and nothing else; ``stage`` asks for the margin of
the stage, and for room for a hand around the objects that a task carries (``hand_room`` is the share of it that was
found). Clean layouts of ``stage`` keep that margin; a workspace too full for it is enlarged (``fill``).
"""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from benchmarks._optimize_checks import PlacedAsset, colliding_boxes, colliding_meshes
from benchmarks._optimize_kinds import Kind, own_kinds
from benchmarks._optimize_rival import finite_differences, parts
from benchmarks._optimize_rows import Outcome, Row, goals
from benchmarks._optimize_scenes import PLAIN, STAGE, CleanScene, Setting, draw_scene
from vcage.base.errors import InfeasibleScene
from vcage.layout.cost import CostWeights
from vcage.layout.optimize import LayoutOptions, LayoutResult, optimize_layout
from vcage.objects.library import Library
from vcage.plans.kept import relations_kept
from vcage.plans.relations import ground_box
from vcage.schema.scene import Table, Workspace
from vcage.stages.optimize import Options

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Cell:
    """Scenes of one kind: each is solved with every noise.

    Args:
        n: objects in all.
        containers: how many of them hold others.
        sigmas: standard deviations of the targets along each axis, metres.
    """

    setting: Setting
    n: int
    containers: int
    sigmas: tuple[float, ...]


GRID = (
    *(Cell(PLAIN, n, c, (0.01, 0.03, 0.06)) for n in (5, 10, 20, 30, 40) for c in (0, 2, 5) if 2 * c <= n),
    *(Cell(STAGE, n, 2, (0.03,)) for n in (5, 10, 20)),
)
RESTARTS = Options().restarts
"""As the stage has it."""
LONGER = 10
"""Times as many restarts for scenes that were declared infeasible."""
RIVAL_OBJECTS = 20
"""Most objects with which the rival tries every scene."""
SEED = 4


def run(quick: bool) -> dict[str, Any]:
    """One row for each setting, noise, number of objects and number of containers; failures go to the log by seed.

    Rates are shares of scenes. ``collision_*``, ``in_bounds``, ``relations_kept`` and the displacements are over
    solved scenes; ``finite_difference_*`` over those the rival tried, ``in_reach`` over those with
    an arm's reach. Times are the process's own, in one thread, without other load on the machine.

    Args:
        quick: 10 scenes of each row instead of 60. The rival, slow on many objects, tries all with up to 20 objects
            and the first 3 (not quick: 8) of each row with more.

    Returns:
        The rows, and under ``goals`` what the plain rows have together.
    """
    scenes, rivals = (10, 3) if quick else (60, 8)
    kinds = own_kinds(Library.load())
    rows: dict[tuple[str, float, int, int], Row] = {}
    clock = _Clock(sum(cell.n for cell in GRID))
    with threadpool_limits(limits=1):
        for cell in GRID:
            for k in range(scenes):
                rival = cell.n <= RIVAL_OBJECTS or k < rivals
                for sigma, outcome in _outcomes(cell, kinds, k, rival):
                    key = (cell.setting.name, sigma, cell.n, cell.containers)
                    rows.setdefault(key, Row(*key)).outcomes.append(outcome)
            clock.done(cell.n, f"{cell.setting.name}: {cell.n} objects, {cell.containers} containers")
    ordered = [rows[key] for key in sorted(rows)]
    return {"rows": [row.record() for row in ordered], "goals": goals([r for r in ordered if r.setting == PLAIN.name])}


def _outcomes(cell: Cell, kinds: Sequence[Kind], k: int, rival: bool) -> Iterator[tuple[float, Outcome]]:
    """(noise, outcome) of the ``k``-th scene of a cell."""
    seed = [SEED, cell.n, cell.containers, k]
    rng = np.random.default_rng(seed)
    clean = draw_scene(kinds, cell.n, cell.containers, k % 3 == 0, rng, cell.setting)
    for sigma in cell.sigmas:
        yield sigma, measure(clean, sigma, [*seed, int(1000 * sigma)], rival)


def measure(clean: CleanScene, sigma: float, seed: Sequence[int], rival: bool) -> Outcome:
    """Optimise one clean scene from targets with noise, and judge what is returned."""
    targets = clean.targets(sigma, np.random.default_rng(seed))
    at_targets = clean.placed({id: (*target, 0.0) for id, target in targets.items()}, {})
    kept_targets = _kept(clean, at_targets)
    started = time.process_time()
    try:
        result = _optimize(clean, targets, [*seed, 1], RESTARTS)
    except InfeasibleScene as error:
        ms = 1000 * (time.process_time() - started)
        longer = _longer_solves(clean, targets, [*seed, 2])
        logger.info("seed %s: infeasible (%s); ten times longer: %s", seed, error.message, longer)
        return Outcome(clean.fill, ms, kept_targets, longer_solves=longer)
    ms = 1000 * (time.process_time() - started)
    placed = clean.placed(result.positions, result.containers)
    outcome = Outcome(
        clean.fill,
        ms,
        kept_targets,
        boxes=colliding_boxes(placed),
        meshes=colliding_meshes(placed),
        in_bounds=all(map(clean.in_bounds, placed.values())),
        in_reach=clean.in_reach(placed) if clean.allowed else None,
        kept=_kept(clean, placed),
        displacements=[float(np.hypot(*(thing.pose.p[:2] - targets[id]))) for id, thing in placed.items()],
        restarts=result.starts,
        hand_room=result.hand_room,
        **(_rival(clean, targets, ms) if rival else {}),
    )
    _log_failure(clean, seed, placed, outcome)
    return outcome


def _optimize(clean: CleanScene, targets: dict[str, np.ndarray], seed: Sequence[int], restarts: int) -> LayoutResult:
    return optimize_layout(
        clean.items(targets),
        clean.workspace,
        Table(height=0.0),
        np.random.default_rng(seed),
        clean.relations,
        LayoutOptions(margin=clean.setting.margin, restarts=restarts),
    )


def _longer_solves(clean: CleanScene, targets: dict[str, np.ndarray], seed: Sequence[int]) -> bool:
    try:
        _optimize(clean, targets, seed, LONGER * RESTARTS)
    except InfeasibleScene:
        return False
    return True


def _kept(clean: CleanScene, placed: dict[str, PlacedAsset]) -> float:
    return relations_kept(clean.relations, {id: thing.box for id, thing in placed.items()}, _ground(clean)).share


def _ground(clean: CleanScene) -> np.ndarray:
    lower, upper = clean.workspace.tolist()
    return ground_box(Workspace(lower=tuple(lower), upper=tuple(upper)), 0.0)


def _rival(clean: CleanScene, targets: dict[str, np.ndarray], ms: float) -> dict[str, Any]:
    """The rival moves the same objects and knows the containers; it is judged by the objects on the table."""
    found = parts(clean, targets)
    started = time.process_time()
    centres = {at: finite_differences(part.problem, CostWeights()) for at, part in found.items()}
    seconds = time.process_time() - started
    roots, origins = found[None].ids, centres[None] - found[None].middles
    moved = {id: (*origin, 0.0) for id, origin in zip(roots, origins, strict=True)}
    placed = clean.placed({**dict.fromkeys(clean.kinds, (0.0, 0.0, 0.0)), **moved}, {})
    solved = not colliding_boxes({id: placed[id] for id in roots})
    return {"rival_ratio": 1000 * seconds / ms, "rival_solves": solved}


def _log_failure(clean: CleanScene, seed: Sequence[int], placed: dict[str, PlacedAsset], outcome: Outcome) -> None:
    for what, pairs in (("boxes", outcome.boxes), ("meshes", outcome.meshes)):
        for a, b in pairs or ():
            logger.info("seed %s: %s of %s and %s collide", seed, what, a, b)
    if not outcome.in_bounds:
        logger.info("seed %s: out of bounds", seed)
    if outcome.in_reach is False:
        logger.info("seed %s: out of reach", seed)
    broken = relations_kept(clean.relations, {id: thing.box for id, thing in placed.items()}, _ground(clean)).broken
    if broken:
        words = ", ".join(f"{r.subject} {r.relation} {r.reference}" for r in broken)
        logger.info("seed %s: %d of %d relations broken: %s", seed, len(broken), len(clean.relations), words)


class _Clock:
    """Tells after each part of the work how much time the rest will take; parts are weighted by what they cost."""

    def __init__(self, total: float):
        self._total, self._spent, self._started = total, 0.0, time.perf_counter()

    def done(self, weight: float, what: str) -> None:
        self._spent += weight
        seconds = time.perf_counter() - self._started
        left = seconds * (self._total / self._spent - 1)
        logger.info("%s: %.0f s so far, about %.0f s left", what, seconds, left)
