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


Free = Callable[[np.ndarray, np.ndarray], bool]
"""Whether the straight segment between two joints (n,) is free."""


class _Tree:
    def __init__(self, root: np.ndarray, free: Free):
        self.nodes = [root]
        self._parents = [-1]
        self._free = free

    def extend(self, q: np.ndarray) -> int | None:
        """One step towards ``q``: the new node, or None where something is in the way."""
        near = int(np.argmin(np.linalg.norm(np.array(self.nodes) - q, axis=1)))
        gap = q - self.nodes[near]
        step = self.nodes[near] + gap * min(1.0, STEP / max(np.abs(gap).max(), 1e-9))
        if not self._free(self.nodes[near], step):
            return None
        self.nodes.append(step)
        self._parents.append(near)
        return len(self.nodes) - 1

    def reach(self, q: np.ndarray) -> int | None:
        """Steps until it reaches ``q`` or is stopped: the node there, or None."""
        while (new := self.extend(q)) is not None:
            if np.allclose(self.nodes[new], q):
                return new
        return None

    def path_to(self, index: int) -> list[np.ndarray]:
        """From the root to a node."""
        path = []
        while index >= 0:
            path.append(self.nodes[index])
            index = self._parents[index]
        return path[::-1]


def connect(
    start: np.ndarray,
    goal: np.ndarray,
    free: Free,
    lower: np.ndarray,
    upper: np.ndarray,
    rng: np.random.Generator,
) -> list[np.ndarray] | None:
    """Corners of a free path from ``start`` to ``goal``, or None after :data:`TRIES` samples.

    Args:
        start, goal: (n,) free joints, rad.
        free: tests a configuration.
        lower, upper: (n,) joint limits.
        rng: of the samples.
    """
    here, there = _Tree(start, free), _Tree(goal, free)
    for attempt in range(TRIES):
        new = here.extend(rng.uniform(lower, upper))
        if new is not None and (met := there.reach(here.nodes[new])) is not None:
            first, second = here.path_to(new), there.path_to(met)[::-1][1:]
            path = first + second
            return _shortened(path if attempt % 2 == 0 else path[::-1], free, rng)
        here, there = there, here
    return None


def _shortened(path: list[np.ndarray], free: Free, rng: np.random.Generator) -> list[np.ndarray]:
    """The path with random shortcuts."""
    for _ in range(SHORTCUTS):
        if len(path) < 3:
            break
        i, j = sorted(rng.choice(len(path), size=2, replace=False))
        if j - i > 1 and free(path[i], path[j]):
            path = path[: i + 1] + path[j:]
    return path
