"""Where on the table a group of objects may stand: in the workspace, clear of others, and in view."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vcage.models.offline.groups import Group
from vcage.schema.scene import Scene

STEP = 0.01
"""Spacing of the positions that are tried, metres."""

RIM = 0.005
"""How far from the picture's edge everything stays, metres on the table."""


@dataclass(frozen=True)
class Standing:
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


class Grid:
    """The positions that are tried, and what there is to be said of them."""

    def __init__(self, scene: Scene):
        camera = scene.top_camera.camera()
        self._lower, self._upper = np.array(scene.workspace.lower), np.array(scene.workspace.upper)
        self._height = scene.table.height
        self._eye = np.array(camera.pose.p)
        corners = camera.unproject([[0, 0], [camera.width, camera.height]], self._height)[:, :2]
        self._view = np.stack([corners.min(axis=0) + RIM, corners.max(axis=0) - RIM])
        centre, half = np.array(scene.table.centre), np.array(scene.table.size) / 2
        self.table = np.array([[*(centre - half), self._height], [*(centre + half), self._height]])
        """(2, 3) the flat box of the table's top."""

    def centres(self, group: Group) -> np.ndarray:
        """(n, 2) centres with the group in the workspace; the middle of it where the group is larger."""
        lower, upper = self._lower - group.reach[0], self._upper - group.reach[1]
        axes = [
            np.append(np.arange(lo, hi, STEP), hi) if lo <= hi else np.array([(lo + hi) / 2])
            for lo, hi in zip(lower, upper, strict=True)
        ]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)

    def standing(self, group: Group, centre: np.ndarray) -> Standing:
        """The group at one place."""
        boxes = {m.item.record.id: m.boxes(centre) for m in group.members}
        return Standing(group, centre, centre + group.reach, self._shown(group, centre[None])[0], boxes)

    def clearance(self, group: Group, centres: np.ndarray, others: Sequence[Standing]) -> np.ndarray:
        """(n,) gap to the nearest other, metres, along the axis where they are furthest apart; negative in overlap."""
        if not others:
            return np.full(len(centres), np.inf)
        return _apart(centres[:, None] + group.reach, [o.covers for o in others]).min(axis=1)

    def plain(self, group: Group, centres: np.ndarray, others: Sequence[Standing]) -> np.ndarray:
        """(n,) bool: the group is wholly in the picture, neither hidden by others nor hiding them."""
        shown = self._shown(group, centres)
        plain = np.all((shown[:, 0] >= self._view[0]) & (shown[:, 1] <= self._view[1]), axis=1)
        return plain & (_apart(shown, [o.shown for o in others]) >= 0).all(axis=1) if others else plain

    def overlap(self, group: Group, centres: np.ndarray, others: Sequence[Standing]) -> np.ndarray:
        """(n,) sum of the depths by which the group would overlap others, metres."""
        if not others:
            return np.zeros(len(centres))
        return np.maximum(-_apart(centres[:, None] + group.reach, [o.covers for o in others]), 0).sum(axis=1)

    def _shown(self, group: Group, centres: np.ndarray) -> np.ndarray:
        """(n, 2, 2) what the group covers of the table as the camera sees it: tall objects lean outwards."""
        covered = []
        for member in group.members:
            boxes = member.boxes(centres)
            for z in boxes[0, :, 2]:
                scale = (self._eye[2] - self._height) / max(self._eye[2] - z, 1e-6)
                covered.append(self._eye[:2] + (boxes[:, :, :2] - self._eye[:2]) * scale)
        return np.stack([np.min(covered, axis=0)[:, 0], np.max(covered, axis=0)[:, 1]], axis=1)


def _apart(a: np.ndarray, b: Sequence[np.ndarray]) -> np.ndarray:
    """(n, k) gap of rectangles (n, 2, 2) and k (2, 2) along the axis where they are furthest apart."""
    there = np.stack(b)
    across = [np.maximum(a[:, None, 0, i] - there[:, 1, i], there[:, 0, i] - a[:, None, 1, i]) for i in (0, 1)]
    return np.maximum(*across)
