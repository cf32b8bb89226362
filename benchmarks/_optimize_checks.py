"""Whether objects of a layout collide, independent of the optimiser: boxes of the assets' own vertices, and meshes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from vcage.assets.asset import Asset
from vcage.geometry import Pose, boxes_overlap, world_aabb

DEEP = 0.005
"""Meshes that enter each other by no more than this touch, metres (the rule of SceneEval)."""
EXACT = 1e-6
"""Boxes that overlap by no more than this touch, metres: the last bits of a sum."""


@dataclass(frozen=True)
class Standing:
    """An asset at a pose.

    Args:
        asset: what stands there.
        pose: in the world.
        container: id of the object that it lies in or on, None on the table.
    """

    asset: Asset
    pose: Pose
    container: str | None = None

    @cached_property
    def bounds(self) -> np.ndarray:
        """(2, 3) box of the asset's vertices in its own frame, metres; its visual mesh may be wider than its pieces."""
        points = np.concatenate([self.asset.bounds, *(piece.vertices for piece in self.asset.pieces)])
        return np.stack([points.min(axis=0), points.max(axis=0)])

    @cached_property
    def box(self) -> np.ndarray:
        """(2, 3) the paper's box in the world: the corners of the own box turned, and the box around them."""
        return world_aabb(self.bounds, self.pose)

    def box_in(self, frame: Pose) -> np.ndarray:
        """(2, 3) the same box in another frame."""
        return world_aabb(self.bounds, frame.inverse() * self.pose)

    @cached_property
    def pieces(self) -> list[Piece]:
        """The convex pieces in the world."""
        rotation = self.pose.rotation()
        return [
            Piece(
                self.pose.apply(p.vertices),
                p.normals @ rotation.T,
                (p.vertices[e[:, 1]] - p.vertices[e[:, 0]]) @ rotation.T,
            )
            for p in self.asset.pieces
            for e in [p.edges]
        ]


@dataclass(frozen=True)
class Piece:
    """A convex piece in the world.

    Args:
        vertices: (n, 3) metres.
        normals: (m, 3) outward unit normals of its faces.
        edges: (e, 3) directions of its edges; diagonals of flat faces do no harm.
    """

    vertices: np.ndarray
    normals: np.ndarray
    edges: np.ndarray

    @cached_property
    def box(self) -> np.ndarray:
        """(2, 3) world box."""
        return np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)])


def colliding_boxes(standing: Mapping[str, Standing]) -> list[tuple[str, str]]:
    """Pairs of ids whose boxes overlap; what lies in a container may overlap it, and whatever carries that.

    Two things that one container carries are compared in its frame, where its walls are straight.
    """
    return [(a, b) for a, b in combinations(standing, 2) if _boxes_collide(standing, a, b)]


def _boxes_collide(standing: Mapping[str, Standing], a: str, b: str) -> bool:
    if a in _carriers(standing, b) or b in _carriers(standing, a):
        return False
    shared = next((id for id in _carriers(standing, a) if id in _carriers(standing, b)), None)
    frame = standing[shared].pose if shared is not None else Pose()
    return boxes_overlap(standing[a].box_in(frame), standing[b].box_in(frame), -EXACT)


def _carriers(standing: Mapping[str, Standing], of: str) -> list[str]:
    """Its container, the container of that, and so on."""
    found, at = [], standing[of].container
    while at is not None:
        found.append(at)
        at = standing[at].container
    return found


def colliding_meshes(standing: Mapping[str, Standing]) -> list[tuple[str, str]]:
    """Pairs of ids whose convex pieces enter each other by more than :data:`DEEP`, contents and containers too."""
    return [(a, b) for a, b in combinations(standing, 2) if meshes_collide(standing[a], standing[b])]


def meshes_collide(a: Standing, b: Standing) -> bool:
    """Whether some piece of ``a`` enters some piece of ``b`` by more than :data:`DEEP`."""
    if not boxes_overlap(a.box, b.box, -DEEP):
        return False
    return any(boxes_overlap(p.box, q.box, -DEEP) and enters(p, q, DEEP) for p in a.pieces for q in b.pieces)


def enters(a: Piece, b: Piece, depth: float) -> bool:
    """Whether the shortest way that parts two convex pieces is longer than ``depth``, metres.

    Exact: the shortest way is normal to a face of their Minkowski difference, so to a face of one of them or to an
    edge of each. Any of those directions along which they overlap less settles it.
    """
    if _least_overlap(a, b, np.concatenate([a.normals, -b.normals])) <= depth:
        return False
    for edge in np.unique(a.edges.round(12), axis=0):
        across = np.cross(edge, b.edges)
        length = np.linalg.norm(across, axis=1)
        turned = length > 1e-9 * np.linalg.norm(edge)
        directions = across[turned] / length[turned, None]
        if len(directions) and _least_overlap(a, b, np.concatenate([directions, -directions])) <= depth:
            return False
    return True


def _least_overlap(a: Piece, b: Piece, directions: np.ndarray) -> float:
    """How far ``b`` must move, at least, along one of the unit ``directions`` (k, 3) to leave ``a``."""
    return float(((a.vertices @ directions.T).max(axis=0) - (b.vertices @ directions.T).min(axis=0)).min())
