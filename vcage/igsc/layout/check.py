"""The last word on a layout: from the returned positions alone, is everything where it may be and free of the rest?"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from vcage.errors import InfeasibleScene
from vcage.igsc.layout.containers import LayoutItem
from vcage.igsc.layout.groups import Groups
from vcage.igsc.placement.contents import CONTENT_MARGIN, turn

TOLERANCE = 1e-6
"""Metres that a gap or a limit may be missed by: the rounding of poses in the plane."""


def require_exact(
    groups: Groups, positions: Mapping[str, Sequence[float]], workspace: np.ndarray, margin: float
) -> None:
    """Check all pairs, the workspace, and the contents of every container.

    Raises:
        InfeasibleScene: names what touches or sticks out.
    """
    roots = {inner.id: root.id for root in groups.roots for inner, _ in groups.carried(root)}
    names = list(groups.items)
    boxes = np.array([item.rectangle() + positions[item.id][:2] for item in groups.items.values()])
    apart = np.array([[roots[a] != roots[b] for b in names] for a in names])
    _require_free(names, boxes, apart, workspace, margin, "the workspace")
    for container in groups.innermost_first():
        _require_inside(groups, container, positions)


def _require_inside(groups: Groups, container: LayoutItem, positions: Mapping[str, Sequence[float]]) -> None:
    contents = groups.contents(container)
    offsets = [np.subtract(positions[item.id][:2], positions[container.id][:2]) for item in contents]
    extents = np.array([groups.extent(item, container.yaw) for item in contents])
    boxes = extents + (np.array(offsets) @ turn(container.yaw))[:, None]
    bounds = groups.inner_bounds(container, (extents[:, 1] - extents[:, 0]) / 2)
    apart = ~np.eye(len(contents), dtype=bool)
    _require_free([item.id for item in contents], boxes, apart, bounds, CONTENT_MARGIN, container.id)


def _require_free(
    names: Sequence[str], boxes: np.ndarray, apart: np.ndarray, bounds: np.ndarray, margin: float, where: str
) -> None:
    """Boxes (n, 2, 2) in the bounds, and the pairs of ``apart`` (n, n) with the margin between them."""
    out = np.any((boxes[:, 0] < bounds[0] - TOLERANCE) | (boxes[:, 1] > bounds[1] + TOLERANCE), axis=1)
    gaps = np.maximum(boxes[:, None, 0] - boxes[None, :, 1], boxes[None, :, 0] - boxes[:, None, 1]).max(axis=2)
    close = (gaps < margin - TOLERANCE) & apart
    if not (out.any() or close.any()):
        return
    i, j = np.argwhere(close)[0] if close.any() else (int(np.argmax(out)),) * 2
    what = f"{names[i]} and {names[j]} touch" if i != j else f"{names[i]} sticks out of {where}"
    raise InfeasibleScene(
        f"the layout is not exact: {what}",
        hint="try another --seed, or drop an object",
        details={"objects": sorted({names[i], names[j]})},
    )
