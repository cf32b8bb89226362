"""A bidirectional rapidly exploring random tree (RRT-Connect, Kuffner and LaValle, 2000)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

STEP = 0.4
"""Longest edge of a tree, radians (largest joint change)."""

TRIES = 400
"""Samples before giving up."""

SHORTCUTS = 60
"""Random shortcuts that are tried on a path that was found."""


class _Tree:
    def __init__(self, root: np.ndarray):
        self.nodes = [root]
        self.parents = [-1]

    def nearest(self, q: np.ndarray) -> int:
        return int(np.argmin(np.linalg.norm(np.array(self.nodes) - q, axis=1)))

    def add(self, q: np.ndarray, parent: int) -> int:
        self.nodes.append(q)
        self.parents.append(parent)
        return len(self.nodes) - 1

    def path_to(self, index: int) -> list[np.ndarray]:
        """From the root to a node."""
        path = []
        while index >= 0:
            path.append(self.nodes[index])
            index = self.parents[index]
        return path[::-1]


def connect(
    start: np.ndarray,
    goal: np.ndarray,
    free: Callable[[np.ndarray, np.ndarray], bool],
    lower: np.ndarray,
    upper: np.ndarray,
    rng: np.random.Generator,
) -> list[np.ndarray] | None:
    """Corners of a free path from ``start`` to ``goal``, or None after :data:`TRIES` samples.

    Args:
        start, goal: (n,) free joints, rad.
        free: whether the straight segment between two joints is free.
        lower, upper: (n,) joint limits.
        rng: of the samples.
    """
    here, there = _Tree(start), _Tree(goal)
    for attempt in range(TRIES):
        new = _extend(here, rng.uniform(lower, upper), free)
        if new is not None and (met := _reach(there, here.nodes[new], free)) is not None:
            first, second = here.path_to(new), there.path_to(met)[::-1][1:]
            path = first + second
            return _shortened(path if attempt % 2 == 0 else path[::-1], free, rng)
        here, there = there, here
    return None


def _extend(tree: _Tree, q: np.ndarray, free: Callable[[np.ndarray, np.ndarray], bool]) -> int | None:
    """One step of the tree towards ``q``."""
    near = tree.nearest(q)
    gap = q - tree.nodes[near]
    step = tree.nodes[near] + gap * min(1.0, STEP / max(np.abs(gap).max(), 1e-9))
    return tree.add(step, near) if free(tree.nodes[near], step) else None


def _reach(tree: _Tree, q: np.ndarray, free: Callable[[np.ndarray, np.ndarray], bool]) -> int | None:
    """Steps of the tree until it reaches ``q`` or is stopped."""
    while (new := _extend(tree, q, free)) is not None:
        if np.allclose(tree.nodes[new], q):
            return new
    return None


def _shortened(
    path: list[np.ndarray], free: Callable[[np.ndarray, np.ndarray], bool], rng: np.random.Generator
) -> list[np.ndarray]:
    for _ in range(SHORTCUTS):
        if len(path) < 3:
            break
        i, j = sorted(rng.choice(len(path), size=2, replace=False))
        if j - i > 1 and free(path[i], path[j]):
            path = path[: i + 1] + path[j:]
    return path
