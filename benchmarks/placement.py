"""Placing 4 … 40 objects of the library, beside three other ways to do it on the same scenes.

**Scenes.** For each N in 4, 10, 20, 30, 40 and each of 1,000 seeds: N objects of different kinds and a variant of
each, drawn uniformly from the whole library (:class:`vcage.objects.library.Library`). The workspace is centred at the
origin as the table is, twice as wide as deep, and sized so that the fill ratio (the objects' rectangles, each grown
by the pipeline's margin, over the workspace) is uniform in 0.2 … 0.8; a workspace in which one object alone would
not fit is enlarged until it does. The rectangle and the headings that an object needs come from
:func:`vcage.layout.items.table_item`, for all methods alike. A third of the objects (1 … 6) are contents
and a tenth (1 … 2) receptacles; both must be where an arm of ``dual_panda`` reaches, what is left is context.

**Methods.** The same scenes, bounds, margin and headings for all:

- ``vcage``: :func:`vcage.layout.placement.place.place`, with the reach of the robot as regions; the others have no
  such notion.
- ``random``: RoboTwin's rejection sampling, 100 tries per object; an object that finds no place is left out.
- ``maniskill``: the installed package's ``UniformPlacementSampler``, 100 trials per object; it keeps circles apart
  and leaves an object that finds no place at the origin.
- ``depth_first``: Holodeck's grid, 20 cells along the longer side, and four headings; largest object first, 1,000
  placements tried where the original stops after a time; the fullest partial solution counts.

Where a description leaves room, the rival gets the better choice (``benchmarks/_placement_rivals.py`` says which).

**Measures** of a method at one N; geometry is measured on the convex pieces at the poses, not on the rectangles that
were placed:

- ``solved``: share of scenes with all N objects placed, within the workspace, and no two boxes overlapping.
- ``infeasible``: share of scenes that the method refused with an error; ``missing``: objects that have no place in
  scenes that it did not refuse; ``solved_by_others``: share of scenes that another method solved and this did not.
- ``collision_aabb``, ``collision_mesh``: share of scenes in which two boxes overlap, or two convex pieces penetrate by
  more than 5 mm.
- ``in_bounds``: share of the placed objects whose box is within the workspace.
- ``stable``: share of the placed objects that move less than 10 mm and turn less than 8° in 2 s of physics at 250 Hz,
  let go where they were put; ``drift_mm_mean``, ``drift_mm_p95`` of the same objects.
- ``reachable``: share of the placed contents' contact points at which an arm's inverse kinematics finds a grasp and
  the pose 9 cm before it, and of the placed receptacles' functional points above which a gripper comes straight down.
  These two and the drift are measured at every 4th seed (``physics_seeds`` counts them).
- ``ms_p50``, ``ms_p95``: processor time of the placement alone over all scenes, whether solved or not, in one process
  and one thread: what else the machine does is not counted.
"""

from __future__ import annotations

import logging
import multiprocessing
import os
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from benchmarks._placement_measures import Drift, TrueShapes, drifts, reached_points
from benchmarks._placement_rivals import depth_first, maniskill, random_retries
from benchmarks._placement_scenes import BenchmarkScene, Stock
from vcage.base.errors import InfeasibleScene
from vcage.layout.items import Placement
from vcage.layout.placement.place import place
from vcage.scenes.starting_poses import MARGIN_M

logger = logging.getLogger(__name__)

NUMBERS = (4, 10, 20, 30, 40)
SEEDS, QUICK_SEEDS = 1000, 50
SAMPLED = 4
"""One seed in this number goes through physics and inverse kinematics."""

RIVALS = {"random": random_retries, "maniskill": maniskill, "depth_first": depth_first}
METHODS = ("vcage", *RIVALS)

CHUNK = 5
"""Scenes that a worker measures before it reports."""


@dataclass(frozen=True)
class Answer:
    """A method's answer to a scene: places by id, None when it refused; and its time, milliseconds."""

    placed: dict[str, Placement] | None
    ms: float


@dataclass(frozen=True)
class Measured:
    """One method's answer to one scene, measured.

    Args:
        missing: objects without a place that no error tells of.
        within: how many of the ``placed`` objects are in the workspace.
        points: how many points are reached, and of how many.
    """

    n: int
    seed: int
    method: str
    ms: float
    refused: bool
    placed: int = 0
    missing: int = 0
    within: int = 0
    collision_aabb: bool = False
    collision_mesh: bool = False
    drifts: list[Drift] = field(default_factory=list)
    points: tuple[int, int] = (0, 0)

    @property
    def solved(self) -> bool:
        return self.placed == self.within == self.n and not self.collision_aabb


@dataclass(frozen=True)
class _Task:
    """A scene by its numbers, and the answers to it by method."""

    n: int
    seed: int
    answers: dict[str, Answer]


def run(quick: bool) -> dict[str, Any]:
    """The table; see the module.

    Args:
        quick: 50 seeds.
    """
    seeds = range(QUICK_SEEDS if quick else SEEDS)
    stock = Stock()
    tasks = list(_with_progress(place_all(stock, NUMBERS, seeds), len(NUMBERS) * len(seeds), "placing"))
    measured = [m for group in _measure_all(tasks) for m in group]
    rows = [row(method, n, measured) for n in NUMBERS for method in METHODS]
    return {
        "rows": rows,
        "seeds": len(seeds),
        "physics_seeds": len(seeds[::SAMPLED]),
        "kinds": len(stock.library.names),
    }


# --- placing: one process, nothing beside it -----------------------------------------------------------


def place_all(stock: Stock, numbers: Sequence[int], seeds: Iterable[int]) -> Iterator[_Task]:
    """Every method's answer to every scene."""
    answer_all(stock.scene(numbers[0], 0), stock, 0)  # imports and caches are not measured
    for seed in seeds:
        for n in numbers:
            yield _Task(n, seed, answer_all(stock.scene(n, seed), stock, seed))


def answer_all(scene: BenchmarkScene, stock: Stock, seed: int) -> dict[str, Answer]:
    """Answers by method."""
    items, plain = scene.items(stock.reach), scene.plain_items()
    ours = _timed(lambda: place(items, scene.workspace, np.random.default_rng(seed), margin=MARGIN_M))
    others = {
        name: _timed(lambda method=method: method(plain, scene.workspace, seed, MARGIN_M))
        for name, method in RIVALS.items()
    }
    return {"vcage": ours, **others}


def _timed(method: Callable[[], dict[str, Placement]]) -> Answer:
    start = time.thread_time()
    try:
        placed = method()
    except InfeasibleScene as error:
        logger.debug("refused: %s", error.message)
        placed = None
    return Answer(placed, 1000 * (time.thread_time() - start))


# --- measuring: a worker for each core -----------------------------------------------------------------

_stock: Stock | None = None


def _measure_all(tasks: Sequence[_Task]) -> Iterator[list[Measured]]:
    # Costs grow with N and seeds cycle through all N, so that chunks of neighbours are alike.
    workers = ProcessPoolExecutor(
        os.cpu_count(), mp_context=multiprocessing.get_context("spawn"), initializer=_start_worker
    )
    with workers:
        yield from _with_progress(workers.map(_measure_in_worker, tasks, chunksize=CHUNK), len(tasks), "measuring")


def _start_worker() -> None:
    global _stock
    _stock = Stock()


def _measure_in_worker(task: _Task) -> list[Measured]:
    assert _stock is not None
    scene = _stock.scene(task.n, task.seed)
    return [measure(scene, _stock, task.seed, method, answer) for method, answer in task.answers.items()]


def measure(scene: BenchmarkScene, stock: Stock, seed: int, method: str, answer: Answer) -> Measured:
    """Everything that is measured of one answer."""
    n, sampled = len(scene.things), seed % SAMPLED == 0
    if answer.placed is None:
        return Measured(n, seed, method, answer.ms, refused=True)
    poses = scene.poses(answer.placed)
    shapes = TrueShapes({thing.id: thing.asset for thing in scene.things}, poses)
    meeting = shapes.meeting()
    return Measured(
        n,
        seed,
        method,
        answer.ms,
        refused=False,
        placed=len(poses),
        missing=n - len(poses),
        within=shapes.within(scene.workspace),
        collision_aabb=bool(meeting),
        collision_mesh=any(shapes.collide(a, b) for a, b in meeting),
        drifts=drifts(scene, poses) if sampled else [],
        points=reached_points(scene, poses, stock.kinematics) if sampled else (0, 0),
    )


# --- the figures ---------------------------------------------------------------------------------------


def row(method: str, n: int, measured: Sequence[Measured]) -> dict[str, Any]:
    """The figures of one method at one N; None where there was nothing to measure."""
    own = [m for m in measured if (m.method, m.n) == (method, n)]
    others = {m.seed for m in measured if m.n == n and m.method != method and m.solved}
    moved = [drift for m in own for drift in m.drifts]
    return {
        "method": method,
        "n": n,
        "solved": _share(m.solved for m in own),
        "collision_aabb": _share(m.collision_aabb for m in own),
        "collision_mesh": _share(m.collision_mesh for m in own),
        "in_bounds": _ratio(sum(m.within for m in own), sum(m.placed for m in own)),
        "stable": _share(drift.stable for drift in moved),
        "drift_mm_mean": _rounded(np.mean, [drift.mm for drift in moved]),
        "drift_mm_p95": _rounded(np.percentile, [drift.mm for drift in moved], 95),
        "reachable": _ratio(sum(m.points[0] for m in own), sum(m.points[1] for m in own)),
        "ms_p50": _rounded(np.percentile, [m.ms for m in own], 50),
        "ms_p95": _rounded(np.percentile, [m.ms for m in own], 95),
        "seeds": len(own),
        "missing": sum(m.missing for m in own),
        "infeasible": _share(m.refused for m in own),
        "solved_by_others": _share(m.seed in others and not m.solved for m in own),
    }


def _share(answers: Iterable[bool]) -> float | None:
    answers = list(answers)
    return _ratio(sum(answers), len(answers))


def _ratio(part: int, whole: int) -> float | None:
    return round(part / whole, 4) if whole else None


def _rounded(statistic: Callable[..., float], values: Sequence[float], *args: float) -> float | None:
    return round(float(statistic(values, *args)), 3) if values else None


def _with_progress(steps: Iterable[Any], total: int, what: str) -> Iterator[Any]:
    """Pass the steps on, and log at every twentieth how many are done and how long the rest will take."""
    start = time.monotonic()
    for done, step in enumerate(steps, start=1):
        yield step
        if done * 20 // total > (done - 1) * 20 // total:
            left = (time.monotonic() - start) / done * (total - done)
            logger.info("%s: %d of %d scenes, %.0f s left", what, done, total, left)
