"""Collision-free placement (paper, section III-A1): every object gets a place, or the answer says why not.

Objects are placed largest first, each drawn uniformly from its exact free region. When an object has none left
the search goes back and moves the ones before it; when random places do not lead to an end, objects are packed
into corners of the free region instead. Both searches are systematic and bounded.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from vcage.errors import InfeasibleScene, UsageError
from vcage.geometry import footprint_half_size
from vcage.igsc.free_region import FreeRegion, free_region

RANDOM_NODES = 300
"""Placements tried from random points before packing begins; grows with the number of objects."""
PACKED_NODES = 300
"""Placements tried by packing, for each of the eight sweep directions."""
SAMPLES = 2
"""Random points tried for each yaw of an object before going back."""


@dataclass(frozen=True)
class PlaceItem:
    """An object to be placed.

    Args:
        id: its name in the result and in errors.
        size: (x, y) size of its footprint at yaw 0, metres.
        yaws: headings that are allowed, radians.
        clearance: free space around it, when more than the margin of all (room for gripper fingers), metres.
        allowed: (m, 2, 2) rectangles that its centre must lie in one of (where an arm reaches it), None for anywhere.
    """

    id: str
    size: tuple[float, float]
    yaws: tuple[float, ...] = (0.0,)
    clearance: float = 0.0
    allowed: ArrayLike | None = None


@dataclass(frozen=True)
class Placement:
    """Where an object stands: its centre in the plane, metres, and its heading, radians."""

    x: float
    y: float
    yaw: float


def place(
    items: Sequence[PlaceItem],
    workspace: ArrayLike,
    rng: np.random.Generator,
    margin: float = 0.01,
    obstacles: ArrayLike = (),
) -> dict[str, Placement]:
    """Place every item so that no two axis-aligned boxes come closer than ``margin``.

    Args:
        items: what to place.
        workspace: (2, 2) lower and upper corner; every box stays within.
        rng: the only source of randomness.
        margin: smallest gap between two boxes, metres.
        obstacles: (n, 2, 2) rectangles that are taken already.

    Returns:
        Placement by id, in the order of ``items``.

    Raises:
        InfeasibleScene: names the objects without a place and the area that is missing.
        UsageError: an item is not a sensible one (no yaw, a size that is not positive, an id twice).
    """
    task = _Task(items, workspace, margin, obstacles)
    require_possible(items, workspace, margin, obstacles)
    search = _Search(task, lambda item, regions: _random_points(item, regions, rng), RANDOM_NODES + 10 * len(items))
    found, best = search.run(), search.best
    sweeps = rng.permutation(len(_SWEEPS))
    for sweep in sweeps:
        if found is not None:
            break
        search = _Search(task, lambda _item, regions, way=_SWEEPS[sweep]: _corner_points(regions, way), PACKED_NODES)
        found = search.run()
        best = max(best, search.best, key=len)
    if found is None:
        raise _no_place([item for item in task.order if item.id not in best], task)
    return {item.id: found[item.id] for item in items}


def require_possible(
    items: Sequence[PlaceItem], workspace: ArrayLike, margin: float = 0.01, obstacles: ArrayLike = ()
) -> None:
    """Refuse at once what cannot work: an object that fits nowhere even alone, or more area than there is.

    Raises:
        InfeasibleScene, UsageError: as :func:`place`.
    """
    task = _Task(items, workspace, margin, obstacles)
    for item in task.order:
        if all(region.is_empty for _, region in task.regions(item, {})):
            raise _fits_nowhere(item, task)
    missing = task.needed - task.available
    if missing > 1e-6:
        raise _infeasible(
            f"{len(items)} objects with margins need {task.needed:.3f} m², the workspace has {task.available:.3f} m²",
            [item.id for item in task.order],
            missing,
            task,
        )


# --- the problem ---------------------------------------------------------------------------------------


@dataclass
class _Task:
    """The items largest first, and what is already taken."""

    items: Sequence[PlaceItem]
    workspace: ArrayLike
    margin: float
    obstacles: ArrayLike
    order: list[PlaceItem] = field(init=False)

    def __post_init__(self) -> None:
        self.workspace = np.asarray(self.workspace, dtype=np.float64).reshape(2, 2)
        self.obstacles = np.asarray(self.obstacles, dtype=np.float64).reshape(-1, 2, 2)
        ids = [item.id for item in self.items]
        for item in self.items:
            _check_item(item, ids)
        self.order = sorted(self.items, key=lambda item: (-item.size[0] * item.size[1], item.id))

    def regions(self, item: PlaceItem, placed: dict[str, Placement]) -> list[tuple[float, FreeRegion]]:
        """(yaw, free region) of an item among the placed ones, for each of its yaws."""
        others = [other for other in self.order if other.id in placed]
        boxes = [footprint(other, placed[other.id]) for other in others]
        taken = np.concatenate([self.obstacles, np.reshape(boxes, (-1, 2, 2))])
        gaps = [max(self.margin, item.clearance)] * len(self.obstacles)
        gaps += [max(self.margin, item.clearance, other.clearance) for other in others]
        return [
            (yaw, free_region(self.workspace, footprint_half_size(item.size, yaw), taken, gaps, item.allowed))
            for yaw in item.yaws
        ]

    @property
    def needed(self) -> float:
        """Area that the items take at their smallest, each grown by half a margin on all sides, m²."""
        sizes = [2 * footprint_half_size(item.size, np.array(item.yaws)[:, None]).reshape(-1, 2) for item in self.items]
        return float(sum((size + self.margin).prod(axis=1).min() for size in sizes))

    @property
    def available(self) -> float:
        """Area of the workspace, grown by half a margin like the items, without the obstacles, m²."""
        half = self.margin / 2
        grown = self.workspace + np.array([[-half], [half]])
        return free_region(grown, np.zeros(2), self.obstacles, half).area


def _check_item(item: PlaceItem, ids: list[str]) -> None:
    if ids.count(item.id) > 1:
        raise UsageError(f"two objects are called {item.id!r}", hint="give every object an id of its own")
    if not (np.all(np.isfinite(item.size)) and min(item.size) > 0):
        raise UsageError(f"{item.id} has the footprint {item.size}", hint="sizes are positive metres; check its mesh")
    if not item.yaws or not np.all(np.isfinite(item.yaws)):
        raise UsageError(f"{item.id} has the headings {item.yaws}", hint="give at least one finite yaw")


def footprint(item: PlaceItem, at: Placement) -> np.ndarray:
    """(2, 2) the axis-aligned rectangle that a placed item covers."""
    half = footprint_half_size(item.size, at.yaw)
    centre = np.array([at.x, at.y])
    return np.stack([centre - half, centre + half])


# --- the search ----------------------------------------------------------------------------------------

_Regions = list[tuple[float, FreeRegion]]
_SWEEPS = [(first, sx, sy) for first in (0, 1) for sx in (1, -1) for sy in (1, -1)]
"""Directions in which packing fills the workspace: the axis that is swept first, and the sign of each axis."""


def _random_points(item: PlaceItem, regions: _Regions, rng: np.random.Generator) -> Iterable[Placement]:
    for _ in range(SAMPLES):
        for index in rng.permutation(len(item.yaws)):
            yaw, region = regions[index]
            if not region.is_empty:
                yield Placement(*map(float, region.sample(rng)), yaw)


def _corner_points(regions: _Regions, sweep: tuple[int, int, int]) -> Iterable[Placement]:
    first, sx, sy = sweep
    corners = [(sx * x, sy * y, yaw) for yaw, region in regions for x, y in region.corners()]
    for x, y, yaw in sorted(corners, key=lambda corner: (corner[first], corner[1 - first], corner[2])):
        yield Placement(float(sx * x), float(sy * y), yaw)


class _Search:
    """Depth-first search over placements in the task's order, at most ``nodes`` of them."""

    def __init__(self, task: _Task, points: Callable[[PlaceItem, _Regions], Iterable[Placement]], nodes: int):
        self._task, self._points, self._nodes = task, points, nodes
        self.best: dict[str, Placement] = {}

    def run(self, placed: dict[str, Placement] | None = None) -> dict[str, Placement] | None:
        """Placements of all items, or None when none was found; ``best`` keeps the fullest attempt."""
        placed = placed or {}
        if len(placed) > len(self.best):
            self.best = placed
        if len(placed) == len(self._task.order):
            return placed
        item = self._task.order[len(placed)]
        for placement in self._points(item, self._task.regions(item, placed)):
            if self._nodes <= 0:
                return None
            self._nodes -= 1
            found = self.run({**placed, item.id: placement})
            if found is not None:
                return found
        return None


# --- failures ------------------------------------------------------------------------------------------


def _infeasible(message: str, names: list[str], missing: float, task: _Task, hint: str = "") -> InfeasibleScene:
    smallest = min(task.items, key=lambda item: item.size[0] * item.size[1]).id
    return InfeasibleScene(
        f"{message}: {missing:.4f} m² are missing",
        hint=hint or f"drop some objects ({smallest} is the smallest), take smaller ones, or enlarge the workspace",
        details={
            "objects": names,
            "missing_area_m2": round(missing, 6),
            "needed_area_m2": round(task.needed, 6),
            "available_area_m2": round(task.available, 6),
        },
    )


def _fits_nowhere(item: PlaceItem, task: _Task) -> InfeasibleScene:
    size = 2 * footprint_half_size(item.size, item.yaws[0])
    room = task.workspace[1] - task.workspace[0]
    outside = float(size.prod() - np.minimum(size, room).prod())
    where = "where an arm reaches it" if item.allowed is not None and outside <= 0 else "even alone"
    return _infeasible(
        f"{item.id} ({size[0]:.3f} x {size[1]:.3f} m) fits nowhere in the workspace "
        f"({room[0]:.3f} x {room[1]:.3f} m), {where}",
        [item.id],
        outside if outside > 0 else float(size.prod()),
        task,
        hint=f"drop {item.id}, take a smaller variant, or enlarge the workspace",
    )


def _no_place(left: list[PlaceItem], task: _Task) -> InfeasibleScene:
    names = [item.id for item in left]
    missing = float(sum((np.array(item.size) + task.margin).prod() for item in left))
    return _infeasible(
        f"no collision-free place for {', '.join(names)} ({len(left)} of {len(task.items)} objects)",
        names,
        missing,
        task,
        hint=f"drop {names[-1]}, allow more headings, or enlarge the workspace",
    )
