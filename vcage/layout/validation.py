"""Validation of items and areas before anything is placed or optimised."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from vcage.base.errors import UnknownName, UsageError
from vcage.layout.items import TableItem
from vcage.objects.openings import Opening


def as_rectangles(rectangles: ArrayLike, what: str) -> np.ndarray:
    """(m, 2, 2) float64 lower and upper corners.

    Raises:
        UsageError: another shape, a number that is not finite, or a lower corner above the upper one; names ``what``.
    """
    try:
        found = np.asarray(rectangles, dtype=np.float64).reshape(-1, 2, 2)
    except (TypeError, ValueError) as error:
        raise UsageError(f"no rectangles (m, 2, 2): {what}", hint="give lower and upper corners") from error
    if not np.all(np.isfinite(found)):
        raise UsageError(f"not finite: {what}", hint="give lower and upper corners in metres")
    if np.any(found[:, 0] > found[:, 1]):
        first = found[np.any(found[:, 0] > found[:, 1], axis=1)][0]
        raise UsageError(f"inverted: {what}, {first.tolist()}", hint="give the lower corner first")
    return found


def as_workspace(workspace: ArrayLike) -> np.ndarray:
    """(2, 2) float64 lower and upper corner of the workspace.

    Raises:
        UsageError: it is no rectangle with an inside.
    """
    found = as_rectangles(workspace, "the workspace")
    if len(found) != 1 or np.any(found[0, 0] >= found[0, 1]):
        raise UsageError(f"the workspace {found.tolist()} has no inside", hint="its upper corner must be the larger")
    return found[0]


def check_margin(margin: float) -> None:
    """Refuse a gap that makes no sense.

    Raises:
        UsageError: it is not a finite number, or negative.
    """
    if not (_finite([margin]) and margin >= 0):
        raise UsageError(f"the margin is {margin}", hint="give the smallest gap in metres, 0 or more")


def check_items(items: Sequence[TableItem]) -> None:
    """Refuse items that make no sense.

    Raises:
        UsageError: no yaw, a number that is not finite, a size that is not positive, no rectangles, an id twice, an
            opening that is not finite or has no inside (a rim may be infinitely high), a container without an opening
            or inside itself.
        UnknownName: a container that is none of the items.
    """
    twice = [name for name, count in Counter(item.id for item in items).items() if count > 1]
    if twice:
        raise UsageError(f"two objects are called {twice[0]!r}", hint="give every object a unique id")
    by_id = {item.id: item for item in items}
    for item in items:
        _check_item(item)
        _check_chain(item, by_id)


def _check_item(item: TableItem) -> None:
    if not (len(item.size) == 3 and _finite(item.size) and min(item.size) > 0):
        raise UsageError(f"{item.id} has the size {item.size}", hint="sizes are positive metres; check its mesh")
    if not len(item.yaws) or not _finite(item.yaws):
        raise UsageError(f"{item.id} has the headings {item.yaws}", hint="give at least one finite yaw")
    if not _finite([*item.target, *item.centre, *(() if item.body is None else np.ravel(item.body))]):
        words = f"{item.id} has no finite target {item.target} or middle {item.centre}"
        raise UsageError(words, hint="make the stages before again")
    if item.allowed is not None:
        as_rectangles(item.allowed, f"where {item.id} may stand")
    if item.opening is not None:
        _check_opening(item.id, item.opening)


def _check_opening(name: str, opening: Opening) -> None:
    sound = _finite([*opening.centre, *opening.size, opening.floor]) and min(opening.size) > 0
    if not sound or math.isnan(opening.rim):
        raise UsageError(f"{name} has the opening {opening}", hint="check the container's mesh")


def _finite(values: Sequence[float]) -> bool:
    try:
        return all(math.isfinite(value) for value in values)
    except TypeError:  # not even a number
        return False


def _check_chain(item: TableItem, by_id: Mapping[str, TableItem]) -> None:
    chain = [item.id]
    while (name := by_id[chain[-1]].inside) is not None:
        if name not in by_id:
            raise UnknownName("container", name, [other.id for other in by_id.values() if other.opening is not None])
        if name in chain:
            circle = f"containers in a circle: {' in '.join([*chain, name])}"
            raise UsageError(circle, hint="a container cannot lie inside itself; fix the plan")
        if by_id[name].opening is None:
            words = f"{chain[-1]} lies in {name}, which has no room for contents"
            raise UsageError(words, hint="give the container an opening")
        chain.append(name)
