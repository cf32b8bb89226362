"""Geometry of the relation words: when a relation holds between axis-aligned world boxes.

+x is right and −y is in front, as the robot sees the table. Limits are those of :mod:`vcage.goals.thresholds`. The
table is no box like others: its usable part (the workspace) has a left, right, front, back and
middle third.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from vcage.base.errors import UnknownName
from vcage.goals.thresholds import THRESHOLDS
from vcage.schema.plan import TABLE, RelationWord
from vcage.schema.scene import Workspace

CONE, BESIDE_GAP, NEAR_GAP = THRESHOLDS.cone_rad, THRESHOLDS.beside_m, THRESHOLDS.near_m
CENTRE_SHARE, CENTRE_MINIMUM = THRESHOLDS.centre_share, THRESHOLDS.centre_least_m

DIRECTIONS: dict[RelationWord, tuple[float, float]] = {
    "left_of": (-1.0, 0.0),
    "right_of": (1.0, 0.0),
    "in_front_of": (0.0, -1.0),
    "behind": (0.0, 1.0),
}
"""Unit vector in the plane from the reference towards the subject."""


def holds(relation: RelationWord, subject: ArrayLike, reference: ArrayLike) -> bool:
    """True where the relation holds between two world boxes (2, 3); a box with a NaN stands in no relation.

    - ``inside``: the subject's rectangle lies in the reference's, its bottom between the reference's bottom and top.
    - ``on``: the subject's centre is over the reference, and its bottom not above the reference's top.
    - ``left_of, right_of, in_front_of, behind``: the subject's centre is beyond the reference's edge on that side
      and within 60° of that direction.
    - ``beside``, ``near``: the rectangles do not overlap and the gap between them is at most 0.10 m, 0.20 m.
    - ``center``: the centres differ by at most 15 % of the reference's size along each axis.

    Raises:
        ValueError: it is not a relation word.
    """
    return bool(hold(relation, subject, reference))


def holds_between(relation: RelationWord, subject: str, reference: str, boxes: Mapping[str, ArrayLike]) -> bool:
    """Check if a relation holds between two world boxes by id, of which the reference may be the table's ground.

    Raises:
        UnknownName: one of them has no box.
    """
    for name in (subject, reference):
        if name not in boxes:
            raise UnknownName("object", name, list(boxes))
    judge = holds_on_table if reference == TABLE else holds
    return judge(relation, boxes[subject], boxes[reference])


def hold(relation: RelationWord, subjects: ArrayLike, references: ArrayLike) -> np.ndarray:
    """:func:`holds` for many boxes (…, 2, 3) at once: (…) bool, subjects and references broadcast."""
    a, b = np.asarray(subjects, dtype=np.float64), np.asarray(references, dtype=np.float64)
    if relation == "inside":
        return _inside(a, b)
    if relation == "on":
        return _on(a, b)
    if relation in DIRECTIONS:
        return _towards(np.array(DIRECTIONS[relation]), a, b)
    if relation in ("beside", "near"):
        gap = plane_gaps(a, b)
        return (gap >= 0) & (gap <= (BESIDE_GAP if relation == "beside" else NEAR_GAP))
    if relation == "center":
        return _central(a, b)
    raise ValueError(f"not a relation word: {relation!r}")


def holds_on_table(relation: RelationWord, subject: ArrayLike, ground: ArrayLike) -> bool:
    """Check if a relation to the table holds of a world box (2, 3); of a box with a NaN none does.

    - ``left_of, right_of, in_front_of, behind``: its centre is in the outer third of the ground on that side.
    - ``center``: its centre is in the middle third of the ground along both axes.
    - ``on``: as :func:`holds`, with the ground as the reference.

    Args:
        relation: the word.
        subject: world box of the object.
        ground: (2, 3) the flat box of the table top's usable part (:func:`ground_box`).

    Raises:
        ValueError: nothing stands so to the table.
    """
    return bool(hold_on_table(relation, subject, ground))


def hold_on_table(relation: RelationWord, subjects: ArrayLike, ground: ArrayLike) -> np.ndarray:
    """:func:`holds_on_table` of many boxes (…, 2, 3) at once: (…) bool."""
    boxes, area = np.asarray(subjects, dtype=np.float64), np.asarray(ground, dtype=np.float64)
    if relation == "on":
        return _on(boxes, area)
    centre, middle = middles(boxes), middle_third(area)
    if relation == "center":
        return np.all((middle[0] <= centre) & (centre <= middle[1]), axis=-1)
    if relation in DIRECTIONS:
        direction = np.array(DIRECTIONS[relation])
        edge = np.where(direction < 0, middle[0], middle[1]) @ np.abs(direction)
        return centre @ direction > edge * direction.sum()
    raise ValueError(f"nothing stands {relation!r} to the table")


def ground_box(workspace: Workspace, height: float) -> np.ndarray:
    """(2, 3) the flat box that the reference ``table`` means: the workspace at the height of the table's top."""
    return np.array([[*workspace.lower, height], [*workspace.upper, height]])


def middle_third(ground: ArrayLike) -> np.ndarray:
    """(2, 2) the middle third, along both axes, of a ground (2, 2 or 3)."""
    lower, upper = np.asarray(ground, dtype=np.float64)[:, :2]
    return np.stack([(2 * lower + upper) / 3, (lower + 2 * upper) / 3])


def third_of(relation: RelationWord, ground: ArrayLike) -> np.ndarray:
    """(2, 2) the part of a ground (2, 2 or 3) for the centre of a box with that relation to the table.

    Raises:
        ValueError: no third has that name.
    """
    lower, upper = np.asarray(ground, dtype=np.float64)[:, :2]
    middle = middle_third(ground)
    if relation == "center":
        return middle
    if relation not in DIRECTIONS:
        raise ValueError(f"no third of the table is {relation!r}")
    found, direction = np.stack([lower, upper]), np.array(DIRECTIONS[relation])
    axis = int(np.argmax(np.abs(direction)))
    found[1 if direction[axis] < 0 else 0, axis] = middle[0 if direction[axis] < 0 else 1, axis]
    return found


def middles(boxes: np.ndarray) -> np.ndarray:
    """(…, 2) centres in the plane of boxes (…, 2, 2 or 3)."""
    return (boxes[..., 0, :2] + boxes[..., 1, :2]) / 2


def plane_gap(a: np.ndarray, b: np.ndarray) -> float:
    """Distance in the plane between two boxes, metres; negative where they overlap (by the smaller penetration)."""
    return float(plane_gaps(np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)))


def plane_gaps(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(…) :func:`plane_gap` of boxes (…, 2, 2 or 3)."""
    gaps = np.maximum(a[..., 0, :2] - b[..., 1, :2], b[..., 0, :2] - a[..., 1, :2])
    x, y = gaps[..., 0], gaps[..., 1]
    largest = np.maximum(x, y)
    return np.where(largest < 0, largest, np.hypot(np.maximum(x, 0), np.maximum(y, 0)))


def _inside(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    contained = np.all(a[..., 0, :2] >= b[..., 0, :2] - THRESHOLDS.inside_m, axis=-1)
    contained &= np.all(a[..., 1, :2] <= b[..., 1, :2] + THRESHOLDS.inside_m, axis=-1)
    return contained & (b[..., 0, 2] - THRESHOLDS.inside_m <= a[..., 0, 2]) & (a[..., 0, 2] < b[..., 1, 2])


def _on(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    centre = middles(a)
    over = np.all((b[..., 0, :2] <= centre) & (centre <= b[..., 1, :2]), axis=-1)
    return (
        over & (b[..., 0, 2] - THRESHOLDS.rest_m <= a[..., 0, 2]) & (a[..., 0, 2] <= b[..., 1, 2] + THRESHOLDS.rest_m)
    )


def _towards(direction: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    offset = middles(a) - middles(b)
    half = (b[..., 1, :2] - b[..., 0, :2]) / 2
    along = offset @ direction
    return (along > half @ np.abs(direction)) & (along >= np.cos(CONE) * np.hypot(offset[..., 0], offset[..., 1]))


def _central(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    offset = np.abs(middles(a) - middles(b))
    allowed = np.maximum(CENTRE_MINIMUM, CENTRE_SHARE * (b[..., 1, :2] - b[..., 0, :2]))
    return np.all(offset <= allowed, axis=-1)
