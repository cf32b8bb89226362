"""Geometry of the relation words: when a relation holds between two axis-aligned world boxes.

+x is right and −y is in front, as the robot sees the table. Thresholds are the module's constants.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vcage.schema.plan import TABLE, Relation, RelationWord
from vcage.schema.scene import Table

INSIDE_TOLERANCE = 0.005
"""Metres that the subject may stick out of the box of what it is inside of, in the plane."""
REST_TOLERANCE = 0.01
"""Metres that the subject's bottom may be above the top of what it stands on."""
CONE = np.deg2rad(60)
"""Largest angle between the direction of a word (left: −x) and the line between the centres."""
BESIDE_GAP = 0.10
"""Largest gap in the plane between two boxes that are beside each other, metres."""
NEAR_GAP = 0.20
"""Largest gap in the plane between two boxes that are near each other, metres."""
CENTRE_SHARE = 0.15
"""Largest offset of the centre along each axis, as a share of the reference's size."""
CENTRE_MINIMUM = 0.02
"""Offset that always counts as central, metres."""

DIRECTIONS: dict[RelationWord, tuple[float, float]] = {
    "left_of": (-1.0, 0.0),
    "right_of": (1.0, 0.0),
    "in_front_of": (0.0, -1.0),
    "behind": (0.0, 1.0),
}
"""Unit vector in the plane from the reference towards the subject."""


def table_box(table: Table) -> np.ndarray:
    """(2, 3) the flat box of a table's top, to be the reference ``table``."""
    centre, half = np.array(table.centre), np.array(table.size) / 2
    return np.array([[*(centre - half), table.height], [*(centre + half), table.height]])


def holds(relation: RelationWord, subject: ArrayLike, reference: ArrayLike) -> bool:
    """Whether the relation holds between two world boxes (2, 3).

    - ``inside``: the subject's rectangle lies in the reference's, its bottom between the reference's bottom and top.
    - ``on``: the subject's centre is over the reference, and its bottom not above the reference's top.
    - ``left_of, right_of, in_front_of, behind``: the subject's centre is beyond the reference's edge on that side
      and within 60° of that direction.
    - ``beside``, ``near``: the rectangles do not overlap and the gap between them is at most 0.10 m, 0.20 m.
    - ``center``: the centres differ by at most 15 % of the reference's size along each axis.
    """
    subject, reference = np.asarray(subject, dtype=np.float64), np.asarray(reference, dtype=np.float64)
    if relation == "inside":
        return _is_inside(subject, reference)
    if relation == "on":
        return _is_on(subject, reference)
    if relation in DIRECTIONS:
        return _is_towards(np.array(DIRECTIONS[relation]), subject, reference)
    if relation == "beside":
        return 0 <= plane_gap(subject, reference) <= BESIDE_GAP
    if relation == "near":
        return 0 <= plane_gap(subject, reference) <= NEAR_GAP
    if relation == "center":
        return _is_central(subject, reference)
    raise ValueError(f"not a relation word: {relation!r}")


def plane_gap(a: np.ndarray, b: np.ndarray) -> float:
    """Distance in the plane between two boxes, metres; negative where they overlap (by the smaller penetration)."""
    gaps = np.maximum(a[0, :2] - b[1, :2], b[0, :2] - a[1, :2])
    return float(gaps.max()) if gaps.max() < 0 else float(np.hypot(*np.maximum(gaps, 0)))


def _is_inside(subject: np.ndarray, reference: np.ndarray) -> bool:
    contained = np.all(subject[0, :2] >= reference[0, :2] - INSIDE_TOLERANCE)
    contained &= np.all(subject[1, :2] <= reference[1, :2] + INSIDE_TOLERANCE)
    return bool(contained and reference[0, 2] - INSIDE_TOLERANCE <= subject[0, 2] < reference[1, 2])


def _is_on(subject: np.ndarray, reference: np.ndarray) -> bool:
    centre = subject[:, :2].mean(axis=0)
    over = np.all((reference[0, :2] <= centre) & (centre <= reference[1, :2]))
    return bool(over and reference[0, 2] - REST_TOLERANCE <= subject[0, 2] <= reference[1, 2] + REST_TOLERANCE)


def _is_towards(direction: np.ndarray, subject: np.ndarray, reference: np.ndarray) -> bool:
    offset = (subject[:, :2] - reference[:, :2]).mean(axis=0)
    half = (reference[1, :2] - reference[0, :2]) / 2
    along = offset @ direction
    return bool(along > np.abs(direction) @ half and along >= np.cos(CONE) * np.hypot(*offset))


def _is_central(subject: np.ndarray, reference: np.ndarray) -> bool:
    offset = np.abs((subject[:, :2] - reference[:, :2]).mean(axis=0))
    return bool(np.all(offset <= np.maximum(CENTRE_MINIMUM, CENTRE_SHARE * (reference[1, :2] - reference[0, :2]))))


@dataclass(frozen=True)
class Kept:
    """How much of a plan a layout keeps: the share in [0, 1], and the relations that do not hold."""

    share: float
    broken: list[Relation]


def relations_kept(relations: Sequence[Relation], aabbs: Mapping[str, ArrayLike], table: Table) -> Kept:
    """Which of a plan's relations hold among the world boxes (2, 3) by object id.

    Raises:
        KeyError: a relation names an object that has no box.
    """
    boxes = {**aabbs, TABLE: table_box(table)}
    broken = [r for r in relations if not holds(r.relation, boxes[r.subject], boxes[r.reference])]
    return Kept(1 - len(broken) / len(relations) if relations else 1.0, broken)


# --- plans that contradict themselves ------------------------------------------------------------------

_CHAINS: tuple[tuple[str, dict[RelationWord, bool]], ...] = (
    ("left of", {"left_of": False, "right_of": True}),
    ("in front of", {"in_front_of": False, "behind": True}),
    ("inside or on", {"inside": False, "on": False}),
)
"""Words whose relations cannot run in a circle; True when subject and reference change places."""


def contradictions(relations: Sequence[Relation]) -> list[str]:
    """What cannot be true at once in a plan, one sentence each; empty for a plan that may be possible.

    Finds circles (a left of b left of a; a in b in a), objects in or on two things, in something and next to it,
    two objects in one centre, and relations to oneself or of the table.
    """
    found = [_nonsense(r) for r in relations]
    for words, swaps in _CHAINS:
        edges = [
            (r.reference, r.subject) if swaps[r.relation] else (r.subject, r.reference)
            for r in relations
            if r.relation in swaps and r.subject != r.reference
        ]
        circle = _circle(edges)
        found.append(f"{f' {words} '.join(circle)}: that is a circle" if circle else None)
    return [text for text in found if text] + _two_supports(relations) + _shared_centres(relations)


def _nonsense(r: Relation) -> str | None:
    if r.subject == r.reference:
        return f"{r.subject} is {r.relation} itself"
    if r.subject == TABLE:
        return f"the table cannot be {r.relation} {r.reference}"
    if r.reference == TABLE and r.relation not in ("center", "on"):
        return f"{r.subject} is {r.relation} the table: only 'center' and 'on' relate to the table"
    return None


def _circle(edges: Sequence[tuple[str, str]]) -> list[str] | None:
    """The nodes of one directed circle, its first node repeated at the end."""
    following: dict[str, list[str]] = {}
    for start, end in edges:
        following.setdefault(start, []).append(end)
    done: set[str] = set()

    def visit(node: str, path: list[str]) -> list[str] | None:
        if node in path:
            return [*path[path.index(node) :], node]
        if node in done:
            return None
        for after in following.get(node, []):
            if circle := visit(after, [*path, node]):
                return circle
        done.add(node)
        return None

    for start in following:
        if circle := visit(start, []):
            return circle
    return None


def _two_supports(relations: Sequence[Relation]) -> list[str]:
    found, support = [], {}
    for r in relations:
        if r.relation in ("inside", "on") and r.reference != TABLE:
            other = support.setdefault(r.subject, r.reference)
            if other != r.reference:
                found.append(f"{r.subject} cannot be in or on both {other} and {r.reference}")
    for r in relations:
        if support.get(r.subject) == r.reference and (r.relation in DIRECTIONS or r.relation in ("beside", "near")):
            found.append(f"{r.subject} cannot be in or on {r.reference} and {r.relation} it")
    return found


def _shared_centres(relations: Sequence[Relation]) -> list[str]:
    found, centre = [], {}
    for r in relations:
        if r.relation == "center":
            other = centre.setdefault(r.reference, r.subject)
            if other != r.subject:
                found.append(f"{other} and {r.subject} cannot both be in the center of {r.reference}")
    return found
