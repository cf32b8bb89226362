"""The last word on a layout: from the returned positions alone, is everything where it may be and free of the rest?

Of the groups only membership and the items out of reach are used, never positions.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import rotation_2d
from vcage.layout.groups import Groups
from vcage.layout.items import TableItem
from vcage.layout.placement.contents import CONTENT_MARGIN_M
from vcage.layout.validation import as_rectangles

TOLERANCE = 1e-6
"""Metres that a gap or a limit may be missed by: the rounding of poses in the plane."""


def require_exact(
    groups: Groups,
    positions: Mapping[str, Sequence[float]],
    workspace: np.ndarray,
    margin: float,
    out_of_reach: Collection[str],
) -> None:
    """Check all pairs, the workspace, the contents of every container, and where objects are allowed.

    Args:
        groups: of containers and contents.
        positions: (x, y, z) of every object, by id.
        workspace: (2, 2) bounds of every box, metres.
        margin: between boxes, metres.
        out_of_reach: ids of items that need not be where they are allowed.

    Raises:
        InfeasibleScene: names items that touch, stick out, are not where they are allowed, or have no finite position.
    """
    for name in groups.items:
        if not np.all(np.isfinite(positions[name])):
            raise _not_exact(f"{name} has no finite position", name)
    names = list(groups.items)
    roots = {name: groups.root(item).id for name, item in groups.items.items()}
    boxes = np.array([item.rectangle() + positions[item.id][:2] for item in groups.items.values()])
    apart = np.array([[roots[a] != roots[b] for b in names] for a in names])
    fixed = np.array([groups.items[roots[name]].fixed for name in names])
    limits = np.where(fixed[:, None, None], [[-np.inf], [np.inf]], workspace)
    _require_free(names, boxes, apart & ~np.outer(fixed, fixed), limits, margin, "the workspace")
    for container in groups.innermost_first():
        _require_inside(groups, container, positions)
    for item in groups.items.values():
        if item.allowed is not None and item.id not in out_of_reach:
            allowed = as_rectangles(item.allowed, f"where {item.id} may stand")
            _require_allowed(item, allowed, positions[item.id])


def _require_allowed(item: TableItem, rectangles: np.ndarray, position: Sequence[float]) -> None:
    middle = item.rectangle().mean(axis=0) + position[:2]
    within = (middle >= rectangles[:, 0] - TOLERANCE) & (middle <= rectangles[:, 1] + TOLERANCE)
    if not within.all(axis=1).any():
        raise _not_exact(f"{item.id} is not where it is allowed", item.id)


def _require_inside(groups: Groups, container: TableItem, positions: Mapping[str, Sequence[float]]) -> None:
    contents = groups.contents(container)
    boxes = np.array([_box_in(container, groups, item, positions) for item in contents])
    bounds = groups.inner_bounds(container, (boxes[:, 1] - boxes[:, 0]) / 2)
    apart = ~np.eye(len(contents), dtype=bool)
    _require_free([item.id for item in contents], boxes, apart, bounds, CONTENT_MARGIN_M, container.id)


def _box_in(
    container: TableItem, groups: Groups, item: TableItem, positions: Mapping[str, Sequence[float]]
) -> np.ndarray:
    """(2, 2) rectangle of a content and all that lies in it, in the frame of its container."""
    offset = np.subtract(positions[item.id][:2], positions[container.id][:2]) @ rotation_2d(container.yaw)
    boxes = [item.rectangle(container.yaw) + offset]
    boxes += [_box_in(container, groups, inner, positions) for inner in groups.contents(item)]
    return np.stack([np.min(boxes, axis=(0, 1)), np.max(boxes, axis=(0, 1))])


def _require_free(
    names: Sequence[str], boxes: np.ndarray, apart: np.ndarray, bounds: np.ndarray, margin: float, where: str
) -> None:
    """Boxes (n, 2, 2) in the bounds, (2, 2) or one each, and the pairs of ``apart`` (n, n) with the margin between."""
    lower, upper = bounds[..., 0, :], bounds[..., 1, :]
    out = ~np.all((boxes[:, 0] >= lower - TOLERANCE) & (boxes[:, 1] <= upper + TOLERANCE), axis=1)
    gaps = np.maximum(boxes[:, None, 0] - boxes[None, :, 1], boxes[None, :, 0] - boxes[:, None, 1]).max(axis=2)
    close = ~(gaps >= margin - TOLERANCE) & apart
    if not (out.any() or close.any()):
        return
    i, j = np.argwhere(close)[0] if close.any() else (int(np.argmax(out)),) * 2
    what = f"{names[i]} and {names[j]} touch" if i != j else f"{names[i]} sticks out of {where}"
    raise _not_exact(what, names[i], names[j])


def _not_exact(what: str, *objects: str) -> InfeasibleScene:
    return InfeasibleScene(
        f"the layout is not exact: {what}",
        hint="try another --seed, or drop an object",
        details={"objects": sorted(set(objects))},
    )
