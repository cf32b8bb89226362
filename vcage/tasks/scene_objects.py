"""Objects of a scene with their geometry, for the search and the execution."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.spatial import ConvexHull

from vcage.base.geometry import Pose, box_corners, oriented_boxes_overlap, world_aabb
from vcage.objects.asset import Asset
from vcage.objects.painting import with_look
from vcage.schema.asset import CatalogueEntry
from vcage.schema.scene import ObjectRecord
from vcage.sim.joints import joint_index, joint_positions, link_poses

REMEMBERED = 2**10
"""Answers about objects where they stand that are remembered: a search asks again for each place."""


@dataclass(frozen=True)
class SolidBox:
    """A box (2, 3) in its own frame, at a pose in the world."""

    bounds: np.ndarray
    pose: Pose

    @cached_property
    def corners(self) -> np.ndarray:
        """(8, 3) corners in the world."""
        return self.pose.apply(box_corners(self.bounds[0], self.bounds[1]))

    @cached_property
    def top(self) -> float:
        """z of its highest corner, metres."""
        return float(self.corners[:, 2].max())

    @cached_property
    def bottom(self) -> float:
        """z of its lowest corner, metres."""
        return float(self.corners[:, 2].min())

    def overlaps(self, other: SolidBox) -> bool:
        """True if the two overlap; touching is not overlap."""
        return oriented_boxes_overlap(self.bounds, self.pose, other.bounds, other.pose)


class Obstacles:
    """Boxes that are examined together, and often.

    Args:
        boxes: where they are.
    """

    def __init__(self, boxes: Sequence[SolidBox]):
        corners = np.array([box.corners for box in boxes]).reshape(-1, 8, 3)
        self.tops = corners[:, :, 2].max(axis=1)
        """(n,) z of their highest corners, metres."""
        self._corners = corners[:, :, :2].transpose(0, 2, 1)
        self._lower, self._upper = self._corners.min(axis=2), self._corners.max(axis=2)
        self._normals = _normals(np.array([box.pose.rotation() for box in boxes]).reshape(-1, 3, 3))

    def under(self, parts: Sequence[SolidBox]) -> Iterator[tuple[SolidBox, np.ndarray]]:
        """Each of some boxes, and which obstacles (k,) it covers when both are seen from straight above.

        The outline of a box is a polygon with edges along those of the box, so that one of their normals separates two
        outlines if anything does.
        """
        seen = [part.corners[:, :2] for part in parts]
        all_seen = np.concatenate(seen)
        near = np.flatnonzero(
            np.all((self._lower <= all_seen.max(axis=0)) & (all_seen.min(axis=0) <= self._upper), axis=1)
        )
        for part, outline in zip(parts, seen, strict=True):
            mine = np.broadcast_to(_normals(part.pose.rotation()), (len(near), 3, 2))
            normals = np.concatenate([mine, self._normals[near]], axis=1)  # (k, 6, 2)
            here, there = normals @ outline.T, normals @ self._corners[near]  # (k, 6, 8)
            gaps = np.maximum(here.min(axis=2) - there.max(axis=2), there.min(axis=2) - here.max(axis=2))
            yield part, near[~np.any(gaps > 0, axis=1)]


def _normals(rotations: np.ndarray) -> np.ndarray:
    """(…, 3, 2) normals of a box's edges as seen from above, by its rotation (…, 3, 3)."""
    return np.swapaxes(rotations[..., :2, :], -1, -2)[..., ::-1] * [-1.0, 1.0]


def first_met(boxes: Sequence[SolidBox], objects: Sequence[SceneObject]) -> SceneObject | None:
    """The first of ``objects`` that one of the boxes overlaps; touching is not overlap."""
    if not objects:
        return None
    corners = np.concatenate([box.corners for box in boxes])
    extents = np.stack([o.around_boxes for o in objects])  # (n, 2, 3)
    # most are far away, as their extents show quickly
    near = np.all((extents[:, 0] < corners.max(axis=0)) & (corners.min(axis=0) < extents[:, 1]), axis=1)
    for index in np.flatnonzero(near):
        if any(box.overlaps(part) for box in boxes for part in objects[index].boxes):
            return objects[index]
    return None


@dataclass(frozen=True)
class SceneObject:
    """An object where it is now.

    Args:
        record: of the scene.
        asset: its geometry and points.
        pose: object frame in the world; differs from the record's while an episode runs.
        joints: (n,) positions of its moving parts; all closed when empty.
    """

    record: ObjectRecord
    asset: Asset
    pose: Pose
    joints: tuple[float, ...] = ()

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash((self.id, self.pose, self.joints))

    @property
    def id(self) -> str:
        """Its name in the scene."""
        return self.record.id

    @cached_property
    def box(self) -> SolidBox:
        """The bounding box at the object's pose."""
        return SolidBox(self.asset.bounds, self.pose)

    @property
    def aabb(self) -> np.ndarray:
        """(2, 3) axis-aligned box in the world."""
        return world_aabb(self.asset.bounds, self.pose)

    def kind(self) -> CatalogueEntry:
        """The catalogue's entry of it, with no other look than its own."""
        return with_look(self.asset.entry(), self.asset.variant)

    def moved(self, pose: Pose, joints: tuple[float, ...] | None = None) -> SceneObject:
        """The same object at another pose, and at other joint positions if they are given."""
        return replace(self, pose=pose, joints=self.joints if joints is None else joints)

    @cached_property
    def as_standing(self) -> SceneObject:
        """The same object at the same place, in the frame in which it stands; differs for one that starts lying."""
        if self.asset.standing is None:
            return self
        return replace(self, asset=self.asset.standing, pose=self.pose * self.asset.stands)

    def with_part(self, part: str, position: float | None = None) -> SceneObject:
        """The same object with the joint of a moving part elsewhere.

        Args:
            part: its name.
            position: of the joint; as far out as it goes when left out.
        """
        model = self.asset.model
        joints = joint_positions(model, self.joints)
        joints[joint_index(model, part)] = model.link(part).joint.far_end if position is None else position
        return self.moved(self.pose, tuple(joints.tolist()))

    @cached_property
    def boxes(self) -> list[SolidBox]:
        """The bounding box of each part where it is now."""
        return [self.part_box(link) for link in self._frames]

    @cached_property
    def around_boxes(self) -> np.ndarray:
        """(2, 3) axis-aligned box in the world around all of :attr:`boxes`."""
        corners = np.concatenate([box.corners for box in self.boxes])
        return np.stack([corners.min(axis=0), corners.max(axis=0)])

    @cached_property
    def outline(self) -> np.ndarray:
        """(n, 2) corners of its convex outline seen from above, where it is now."""
        parts = [self._frames[link].apply(p.vertices) for link in self._frames for p in self.asset.pieces_of(link)]
        points = np.concatenate(parts)[:, :2]
        return points[ConvexHull(points).vertices]

    @cached_property
    def lowest(self) -> float:
        """z of its lowest point where it is now, metres: higher than that of a box around it, where it leans."""
        return min(
            self._frames[link].apply(p.vertices)[:, 2].min()
            for link in self._frames
            for p in self.asset.pieces_of(link)
        )

    def part_box(self, link: str | None) -> SolidBox:
        """The bounding box of a part, or of the body (None), where it is now."""
        return SolidBox(self.asset.bounds_of(link), self._frames[link])

    def part_pose(self, link: str | None) -> Pose:
        """The frame of a part, or of the body (None), in the world."""
        return self._frames[link]

    @cached_property
    def _frames(self) -> dict[str | None, Pose]:
        """The frame of each part in the world: with all joints at 0 that of the object."""
        if not self.asset.articulated:
            return {None: self.pose}
        return {link: self.pose * local for link, local in link_poses(self.asset.model, self.joints).items()}

    def frame(self, functional_point: int) -> Pose:
        """The frame of the part that a functional point belongs to, in the world: a drawer's moves with the drawer."""
        return self._frames[self.asset.annotation.functional_point(functional_point).link]

    def around(self, functional_point: int) -> list[SolidBox]:
        """Boxes around a functional point: the rim of its opening, and the object's other parts."""
        own = self.asset.annotation.functional_point(functional_point).link
        return [*self.walls(functional_point), *(self.part_box(link) for link in self._frames if link != own)]

    def rim(self, functional_point: int) -> float:
        """z of the rim around a functional point, or of the flat top that it lies on, metres."""
        opening = self.asset.opening(self.asset.annotation.functional_point(functional_point))
        return float(self.frame(functional_point).apply([*opening.centre, opening.rim])[2])

    def walls(self, functional_point: int) -> list[SolidBox]:
        """The rim around an opening as up to four boxes from the part's bottom to the rim; none for a flat top."""
        point = self.asset.annotation.functional_point(functional_point)
        opening = self.asset.opening(point)
        lower, upper = self.asset.bounds_of(point.link)
        centre, half = np.array(opening.centre), np.array(opening.size) / 2
        (x0, y0), (x1, y1) = centre - half, centre + half
        if opening.depth < 1e-3:
            return []
        rectangles = (
            (lower[0], lower[1], x0, upper[1]),
            (x1, lower[1], upper[0], upper[1]),
            (lower[0], lower[1], upper[0], y0),
            (lower[0], y1, upper[0], upper[1]),
        )
        return [
            SolidBox(np.array([[a, b, lower[2]], [c, d, opening.rim]]), self._frames[point.link])
            for a, b, c, d in rectangles
            if c - a > 1e-4 and d - b > 1e-4
        ]
