"""Where on the table a group of objects may stand: in the workspace, clear of others, and in view.

The centres that are tried make a grid, and rectangles are compared along one axis after the other: what holds for a
column holds for all its cells.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.models.rules.groups import Group
from vcage.schema.scene import Scene

STEP = 0.01
"""Spacing of the positions that are tried, metres."""

RIM = 0.005
"""How far from the picture's edge everything stays, metres on the table."""


@dataclass(frozen=True)
class PlacedGroup:
    """A group that has its place.

    Args:
        covers: (2, 2) rectangle on the table.
        shown: (2, 2) what it covers of the table as the camera sees it.
        boxes: (2, 3) world boxes of its members.
    """

    group: Group
    centre: np.ndarray
    covers: np.ndarray
    shown: np.ndarray
    boxes: dict[str, np.ndarray]


@dataclass(frozen=True)
class Centres:
    """Positions that are tried for a group: all of x (nx,) with all of y (ny,), x first, metres."""

    x: np.ndarray
    y: np.ndarray

    def points(self) -> np.ndarray:
        """(nx * ny, 2) the centres."""
        return np.stack([np.repeat(self.x, len(self.y)), np.tile(self.y, len(self.x))], axis=-1)


class Grid:
    """The positions that are tried, and what there is to be said of them."""

    def __init__(self, scene: Scene):
        camera = scene.top_camera.camera()
        self._lower, self._upper = np.array(scene.workspace.lower), np.array(scene.workspace.upper)
        self._height = scene.table.height
        self._eye = np.array(camera.pose.p)
        corners = camera.unproject([[0, 0], [camera.width, camera.height]], self._height)[:, :2]
        self._view = np.stack([corners.min(axis=0) + RIM, corners.max(axis=0) - RIM])
        self.table = np.column_stack([scene.table.rectangle, [self._height, self._height]])
        """(2, 3) the flat box of the table's top."""

    def centres(self, group: Group) -> Centres:
        """Centres with the group in the workspace; the middle of it where the group is larger."""
        lower, upper = self._lower - group.reach[0], self._upper - group.reach[1]
        axes = [
            np.append(np.arange(lo, hi, STEP), hi) if lo <= hi else np.array([(lo + hi) / 2])
            for lo, hi in zip(lower, upper, strict=True)
        ]
        return Centres(*axes)

    def place(self, group: Group, centre: np.ndarray) -> PlacedGroup:
        """The group at one place."""
        boxes = {m.item.record.id: m.boxes(centre) for m in group.members}
        shown = np.stack([self._shown(group, centre[i : i + 1], i)[:, 0] for i in (0, 1)], axis=-1)
        return PlacedGroup(group, centre, centre + group.reach, shown, boxes)

    def clearance(self, group: Group, centres: Centres, others: Sequence[PlacedGroup]) -> np.ndarray:
        """(n,) gap to the nearest other, metres, along the axis where they are furthest apart; negative in overlap."""
        if not others:
            return np.full(len(centres.x) * len(centres.y), np.inf)
        return _apart(*self._covered(group, centres), [o.covers for o in others]).min(axis=0)

    def plain(self, group: Group, centres: Centres, others: Sequence[PlacedGroup]) -> np.ndarray:
        """(n,) bool: the group is wholly in the picture, neither hidden by others nor hiding them."""
        shown = [self._shown(group, axis, i) for i, axis in enumerate((centres.x, centres.y))]
        in_view = [(low >= self._view[0, i]) & (high <= self._view[1, i]) for i, (low, high) in enumerate(shown)]
        plain = (in_view[0][:, None] & in_view[1]).ravel()
        return plain & (_apart(*shown, [o.shown for o in others]) >= 0).all(axis=0) if others else plain

    def overlap(self, group: Group, centres: Centres, others: Sequence[PlacedGroup]) -> np.ndarray:
        """(n,) sum of the depths by which the group would overlap others, metres."""
        if not others:
            return np.zeros(len(centres.x) * len(centres.y))
        apart = _apart(*self._covered(group, centres), [o.covers for o in others])
        return np.maximum(-apart, 0).sum(axis=0)

    def _covered(self, group: Group, centres: Centres) -> list[np.ndarray]:
        """Along x (2, nx) and y (2, ny): lower and upper edge of what the group covers."""
        return [axis + group.reach[:, i, None] for i, axis in enumerate((centres.x, centres.y))]

    def _shown(self, group: Group, centres: np.ndarray, axis: int) -> np.ndarray:
        """(2, n) lower and upper edge along an axis of what the camera sees the group cover: tall ones lean outwards.

        Args:
            centres: (n,) along that axis, metres.
        """
        eye = self._eye[axis]
        edges = []
        for member in group.members:
            sides = centres + member.offset[axis] + np.array([[-1.0], [1.0]]) * member.half[axis]
            for z in member.item.box[:, 2]:
                edges.append(eye + (sides - eye) * (self._eye[2] - self._height) / max(self._eye[2] - z, 1e-6))
        return np.stack([np.min(edges, axis=0)[0], np.max(edges, axis=0)[1]])


def _apart(x: np.ndarray, y: np.ndarray, others: Sequence[np.ndarray]) -> np.ndarray:
    """(k, nx * ny) gaps of rectangles and k others (2, 2), along the axis where they are furthest apart.

    Args:
        x, y: (2, nx) and (2, ny) lower and upper edges.
    """
    there = np.stack(others)
    gaps = [np.maximum(side[0] - there[:, 1, i, None], there[:, 0, i, None] - side[1]) for i, side in enumerate((x, y))]
    return np.maximum(gaps[0][:, :, None], gaps[1][:, None, :]).reshape(len(there), -1)


def overlapping(groups: Sequence[PlacedGroup]) -> list[PlacedGroup]:
    """Those that overlap another one."""
    if not groups:
        return []
    covers = np.stack([g.covers for g in groups])
    gaps = np.maximum(covers[:, None, 0] - covers[:, 1], covers[:, 0] - covers[:, None, 1]).max(axis=-1)
    np.fill_diagonal(gaps, np.inf)
    return [g for g, gap in zip(groups, gaps.min(axis=1), strict=True) if gap < -1e-9]
