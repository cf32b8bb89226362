"""Check for collisions of a layout, independent of the optimiser: boxes of the assets' own vertices, and meshes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from benchmarks._shapes import ROUNDING, TOUCHING, box_around, pieces_collide
from vcage.base.geometry import Pose, boxes_overlap, world_aabb
from vcage.objects.asset import Asset


@dataclass(frozen=True)
class PlacedAsset:
    """An asset at a pose.

    Args:
        asset: the asset.
        pose: in the world.
        container: id of the object it lies in or on, None on the table.
        room: (2, 2) lower and upper corner of its room in its own frame, with the sweep of its moving parts, metres;
            None for no more than its own box.
    """

    asset: Asset
    pose: Pose
    container: str | None = None
    room: np.ndarray | None = None

    @cached_property
    def bounds(self) -> np.ndarray:
        """(2, 3) box of the asset's vertices in its own frame, metres; its visual mesh may be wider than its pieces."""
        return box_around(np.concatenate([self.asset.bounds, *(piece.vertices for piece in self.asset.pieces)]))

    @cached_property
    def box(self) -> np.ndarray:
        """(2, 3) the paper's box in the world: the corners of the own box turned, and the box around them."""
        return world_aabb(self.bounds, self.pose)

    def room_in(self, frame: Pose) -> np.ndarray:
        """(2, 3) box in a frame around the own box and the room, metres."""
        needed = self.bounds.copy()
        if self.room is not None:
            needed[0, :2], needed[1, :2] = (
                np.minimum(needed[0, :2], self.room[0]),
                np.maximum(needed[1, :2], self.room[1]),
            )
        return world_aabb(needed, frame.inverse() * self.pose)

    @cached_property
    def pieces(self) -> list[np.ndarray]:
        """(n, 3) vertices of each convex piece in the world, all joints at 0."""
        return [self.pose.apply(piece.vertices) for piece in self.asset.pieces]


def colliding_boxes(placed: Mapping[str, PlacedAsset]) -> list[tuple[str, str]]:
    """Pairs of ids whose rooms overlap; contents may overlap their container and its supports.

    Two things that one container carries are compared in its frame, where its walls are straight.
    """
    return [(a, b) for a, b in combinations(placed, 2) if _boxes_collide(placed, a, b)]


def _boxes_collide(placed: Mapping[str, PlacedAsset], a: str, b: str) -> bool:
    if a in _carriers(placed, b) or b in _carriers(placed, a):
        return False
    shared = next((id for id in _carriers(placed, a) if id in _carriers(placed, b)), None)
    frame = placed[shared].pose if shared is not None else Pose()
    return boxes_overlap(placed[a].room_in(frame), placed[b].room_in(frame), -ROUNDING)


def _carriers(placed: Mapping[str, PlacedAsset], of: str) -> list[str]:
    """Its container, the container of that, and so on."""
    found, at = [], placed[of].container
    while at is not None:
        found.append(at)
        at = placed[at].container
    return found


def colliding_meshes(placed: Mapping[str, PlacedAsset]) -> list[tuple[str, str]]:
    """Pairs of ids whose convex pieces enter each other by more than :data:`~benchmarks._shapes.TOUCHING`, contents
    and containers too."""
    return [(a, b) for a, b in combinations(placed, 2) if meshes_collide(placed[a], placed[b])]


def meshes_collide(a: PlacedAsset, b: PlacedAsset) -> bool:
    """True if some piece of ``a`` enters some piece of ``b`` by more than :data:`~benchmarks._shapes.TOUCHING`."""
    return boxes_overlap(a.box, b.box, -TOUCHING) and pieces_collide(a.pieces, b.pieces)
