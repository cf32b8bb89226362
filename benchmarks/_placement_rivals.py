"""Three other ways to place objects, written or called as their descriptions say, for comparison in the same run.

Each takes items (without reach: they know none), a workspace (2, 2), a seed and the margin, and returns the places
that it found. None of them tells which object it could not place.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vcage.base.geometry import footprint_half_size
from vcage.layout.items import Placement, TableItem

TRIES = 100
"""Random points per object; as RoboTwin's clutter and ManiSkill's scenes take."""

GRID = 20
"""Cells of the grid along the longer side, as Holodeck takes for a room."""

QUARTERS = (0.0, np.pi / 2, np.pi, -np.pi / 2)
"""Headings of Holodeck's candidates."""

NODES = 1000
"""Placements that the depth-first search tries, where Holodeck stops after a time, so that a seed gives one result."""


def random_retries(items: Sequence[TableItem], workspace: np.ndarray, seed: int, margin: float) -> dict[str, Placement]:
    """RoboTwin's way: every object in turn at random points until one is free; after :data:`TRIES` it is left out.

    More favourable than the original, which keeps circles apart: here boxes are, and a point is drawn from where the
    box is within the workspace.
    """
    rng = np.random.default_rng(seed)
    placed: dict[str, Placement] = {}
    taken = np.empty((0, 2, 2))
    for item in items:
        yaws = rng.choice(item.yaws, TRIES)
        half = footprint_half_size(item.size[:2], yaws)
        lower, upper = workspace[0] + half, workspace[1] - half
        points = lower + rng.random((TRIES, 2)) * np.maximum(upper - lower, 0.0)
        boxes = np.stack([points - half, points + half], axis=1)
        free = np.flatnonzero(np.all(lower <= upper, axis=1) & ~_taken(boxes, taken, margin))
        if len(free):
            placed[item.id] = Placement(float(points[free[0], 0]), float(points[free[0], 1]), float(yaws[free[0]]))
            taken = np.concatenate([taken, boxes[free[:1]]])
    return placed


def maniskill(items: Sequence[TableItem], workspace: np.ndarray, seed: int, margin: float) -> dict[str, Placement]:
    """ManiSkill's ``UniformPlacementSampler`` as its scenes call it: one circle around each object, 100 trials.

    An object that finds no place is left at the origin, here the workspace's centre. More favourable than its scenes:
    a sampler's bounds hold for centres, so each object gets a sampler whose bounds keep its own box within the
    workspace, with the circles of the ones before.
    """
    import torch
    from mani_skill.envs.utils.randomization import UniformPlacementSampler

    torch.manual_seed(seed)
    rng = np.random.default_rng(seed)
    centre = workspace.mean(axis=0)
    placed: dict[str, Placement] = {}
    before = None
    for item in items:
        yaw = float(rng.choice(item.yaws))
        half = np.minimum(footprint_half_size(item.size[:2], yaw), (workspace[1] - workspace[0]) / 2)
        bounds = np.stack([workspace[0] + half, workspace[1] - half]) - centre
        sampler = UniformPlacementSampler(bounds=bounds.tolist(), batch_size=1)
        if before is not None:
            sampler.fixture_positions, sampler.fixtures_radii = before.fixture_positions, before.fixtures_radii
        radius = float(np.linalg.norm(item.size[:2])) / 2 + margin / 2
        x, y = (sampler.sample(radius, TRIES)[0].numpy() + centre).tolist()
        placed[item.id] = Placement(x, y, yaw)
        before = sampler
    return placed


def depth_first(items: Sequence[TableItem], workspace: np.ndarray, seed: int, margin: float) -> dict[str, Placement]:
    """Holodeck's way: candidates on a grid in four headings, depth first, largest object first, back when none is
    free; the fullest partial solution when the budget is over.

    It has no constraints between objects, so the order of the candidates is random. An object that may not
    stand in all four headings has the allowed ones.
    """
    order = sorted(items, key=lambda item: (-item.size[0] * item.size[1], item.id))
    return _DepthFirst(order, workspace, np.random.default_rng(seed), margin).run()


class _DepthFirst:
    def __init__(self, order: list[TableItem], workspace: np.ndarray, rng: np.random.Generator, margin: float):
        self._order, self._rng, self._margin = order, rng, margin
        step = (workspace[1] - workspace[0]).max() / GRID
        axes = [np.linspace(a, b, max(1, round((b - a) / step)) + 1) for a, b in workspace.T]
        self._points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
        self._candidates = [self._candidates_of(item, workspace) for item in order]
        self._nodes = NODES
        self._best: list[int] = []

    def run(self) -> dict[str, Placement]:
        self._extend([], np.empty((0, 2, 2)))
        chosen = zip(self._order, self._candidates, self._best, strict=False)
        return {item.id: Placement(*map(float, states[index])) for item, (states, _), index in chosen}

    def _candidates_of(self, item: TableItem, workspace: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(c, 3) places x, y, yaw within the workspace, and their boxes (c, 2, 2)."""
        yaws = [yaw for yaw in QUARTERS if np.isclose(np.cos(yaw - np.asarray(item.yaws)), 1.0).any()]
        points = np.tile(self._points, (len(yaws), 1))
        states = np.column_stack([points, np.repeat(yaws, len(self._points))])
        half = footprint_half_size(item.size[:2], states[:, 2])
        boxes = np.stack([states[:, :2] - half, states[:, :2] + half], axis=1)
        within = np.all((boxes[:, 0] >= workspace[0]) & (boxes[:, 1] <= workspace[1]), axis=1)
        return states[within], boxes[within]

    def _extend(self, chosen: list[int], taken: np.ndarray) -> bool:
        """Place the remaining objects after ``chosen``; True if all objects have a place."""
        if len(chosen) > len(self._best):
            self._best = chosen
        if len(chosen) == len(self._order):
            return True
        _, boxes = self._candidates[len(chosen)]
        for index in self._rng.permutation(np.flatnonzero(~_taken(boxes, taken, self._margin))):
            if self._nodes == 0:
                return False
            self._nodes -= 1
            if self._extend([*chosen, int(index)], np.concatenate([taken, boxes[index][None]])):
                return True
        return False


def _taken(boxes: np.ndarray, taken: np.ndarray, margin: float) -> np.ndarray:
    """(c,) True where boxes (c, 2, 2) come closer than the margin to an occupied one (k, 2, 2)."""
    near = (boxes[:, None, 0] < taken[None, :, 1] + margin) & (taken[None, :, 0] < boxes[:, None, 1] + margin)
    return np.all(near, axis=2).any(axis=1)
