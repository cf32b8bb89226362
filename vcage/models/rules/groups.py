"""What moves as one when a plan is laid out: an object on the table with all that lies in or on it."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vcage.base.geometry import rotation_2d
from vcage.models.rules.footprints import Footprint
from vcage.plans.check import Capacity
from vcage.plans.relations import plane_gap
from vcage.schema.plan import TABLE, Relation

TOUCH = 1e-6
"""Metres that boxes may share and count as touching."""

MOST_ORDERS = 24
"""Orders of the contents of one container that are tried."""


@dataclass(frozen=True)
class Placement:
    """Where an object goes: world x, y of its centre, and how far it turns from where it stands now (radians)."""

    centre: np.ndarray
    turn: float


@dataclass(frozen=True)
class Member:
    """An object of a group: its box's centre relative to the group's, its half size and turn, and z of its box."""

    item: Footprint
    offset: np.ndarray
    half: np.ndarray
    turn: float

    def boxes(self, centres: np.ndarray) -> np.ndarray:
        """(…, 2, 3) its world box with the group at ``centres`` (…, 2)."""
        boxes = np.empty((2, 3, *centres.shape[:-1]))  # in memory one coordinate after another: what follows is fast
        for axis in (0, 1):
            middle = centres[..., axis] + self.offset[axis]
            boxes[0, axis], boxes[1, axis] = middle - self.half[axis], middle + self.half[axis]
        boxes[0, 2], boxes[1, 2] = self.item.box[:, 2]
        return np.moveaxis(boxes, (0, 1), (-2, -1))


@dataclass(frozen=True)
class Group:
    """An object that stands on the table, first of ``members``, and what it carries."""

    members: tuple[Member, ...]

    @property
    def root(self) -> Footprint:
        return self.members[0].item

    @cached_property
    def reach(self) -> np.ndarray:
        """(2, 2) lower and upper corner of all members, relative to the group's centre."""
        lower = np.min([m.offset - m.half for m in self.members], axis=0)
        upper = np.max([m.offset + m.half for m in self.members], axis=0)
        return np.stack([lower, upper])

    def placements(self, centre: np.ndarray) -> dict[str, Placement]:
        """Placement of each member with the group at ``centre``."""
        return {m.item.record.id: Placement(centre + m.offset, m.turn) for m in self.members}


def placed_boxes(items: Sequence[Footprint], placements: Mapping[str, Placement]) -> dict[str, np.ndarray]:
    """(2, 3) world box of each object at its placement; heights stay as they are."""
    boxes = {}
    for item in items:
        there = placements[item.record.id]
        half = item.half_size(there.turn)
        low, high = item.box[:, 2]
        boxes[item.record.id] = np.array([[*(there.centre - half), low], [*(there.centre + half), high]])
    return boxes


def overlapping_objects(
    items: Sequence[Footprint], placements: Mapping[str, Placement], relations: Sequence[Relation]
) -> list[str]:
    """Objects on the table whose boxes overlap another's in the plane, in the order of ``items``."""
    lying = supports_of(relations, {item.record.id: item for item in items})
    boxes = {name: box[:, :2] for name, box in placed_boxes(items, placements).items() if name not in lying}
    pairs = [pair for pair in itertools.combinations(boxes, 2) if plane_gap(boxes[pair[0]], boxes[pair[1]]) < -TOUCH]
    return [name for name in boxes if any(name in pair for pair in pairs)]


def supports_of(relations: Sequence[Relation], known: Mapping[str, Footprint]) -> dict[str, str]:
    """What each object lies in or on by the plan, without circles: the first that the plan names counts."""
    found: dict[str, str] = {}
    for r in relations:
        if r.relation in ("inside", "on") and r.reference != TABLE and r.subject not in found:
            above, at = [r.subject], r.reference
            while at in found:
                above.append(at)
                at = found[at]
            if r.reference in known and r.subject in known and at not in above:
                found[r.subject] = r.reference
    return found


def group_of(
    root: Footprint,
    turn: float,
    carried: Mapping[str, Sequence[Footprint]],
    rooms: Mapping[str, Capacity],
    relations: Sequence[Relation],
) -> Group:
    """The group of an object that is turned by ``turn``; ``carried`` is what lies directly in or on each."""
    members = [Member(root, np.zeros(2), root.half_size(turn), turn)]
    for member in members:  # grows while it is read: contents of contents
        contents = list(carried.get(member.item.record.id, ()))
        members += _laid_out(member, contents, rooms.get(member.item.record.id), relations)
    return Group(tuple(members))


def _laid_out(
    holder: Member, contents: Sequence[Footprint], room: Capacity | None, relations: Sequence[Relation]
) -> list[Member]:
    """Contents in their container: those that lie in it already stay there, the others are centred in rows."""
    rigid = [c for c in contents if c.record.container == holder.item.record.id]
    fresh = [c for c in contents if c not in rigid]
    found = []
    turned = rotation_2d(holder.turn)
    for item in rigid:
        offset = holder.offset + turned @ (item.centre - holder.item.centre)
        found.append(Member(item, offset, item.half_size(holder.turn), holder.turn))
    if not fresh:
        return found
    heading = holder.item.record.pose.pose().yaw + holder.turn
    middle = holder.offset + (rotation_2d(heading) @ np.array(room.centre) if room else 0)
    orders = itertools.islice(itertools.permutations(fresh), MOST_ORDERS)
    rows = [_rows(order, holder, room, middle) for order in orders]
    return found + max(rows, key=lambda row: _ordered(row, relations))


def _rows(order: Sequence[Footprint], holder: Member, room: Capacity | None, middle: np.ndarray) -> list[Member]:
    """Contents from left to right in rows no wider than the opening, front row first, centred around ``middle``."""
    width = 2 * holder.half[0]
    if room is not None and room.holds is not None:
        width *= room.opening[0] / max(room.size[0], 1e-6)
    rows: list[list[np.ndarray]] = [[]]
    halves = [item.half_size(0.0) for item in order]
    for half in halves:
        if rows[-1] and 2 * sum(h[0] for h in rows[-1]) + 2 * half[0] > width:
            rows.append([])
        rows[-1].append(half)
    depths = [2 * max(h[1] for h in row) for row in rows]
    centres, y = [], -sum(depths) / 2
    for row, depth in zip(rows, depths, strict=True):
        x = -sum(h[0] for h in row)
        for half in row:
            centres.append(middle + [x + half[0], y + depth / 2])
            x += 2 * half[0]
        y += depth
    return [Member(item, c, half, 0.0) for item, c, half in zip(order, centres, halves, strict=True)]


def _ordered(row: Sequence[Member], relations: Sequence[Relation]) -> int:
    """How many relations from left to right, and from front to back, the members keep among themselves."""
    at = {m.item.record.id: m.offset for m in row}
    axes = {"left_of": (0, -1), "right_of": (0, 1), "in_front_of": (1, -1), "behind": (1, 1)}
    kept = 0
    for r in relations:
        if r.relation in axes and r.subject in at and r.reference in at:
            axis, sign = axes[r.relation]
            kept += bool(sign * (at[r.subject] - at[r.reference])[axis] > 0)
    return kept
