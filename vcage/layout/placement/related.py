"""Relations that a placement keeps: an object is drawn where they hold between it and the placed objects.

Relations to the table are thirds of it, which limit where an object may be. Relations to another object cut the free
area by a rectangle, beside or around that object's, and :mod:`vcage.plans.relations` judges its points.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from vcage.layout.items import TableItem
from vcage.layout.placement.contents import Carried
from vcage.plans.relations import BESIDE_GAP, DIRECTIONS, NEAR_GAP, hold, third_of
from vcage.schema.plan import TABLE, Relation

_GAPS = {"beside": BESIDE_GAP, "near": NEAR_GAP}


class Placed(Protocol):
    """Place of an item: (2,) centre of its rectangle, metres, and yaw, radians."""

    @property
    def centre(self) -> np.ndarray: ...

    @property
    def yaw(self) -> float: ...


@dataclass(frozen=True)
class _Bond:
    """A relation of an item on the plane, or of its contents, to another item or that one's contents.

    Args:
        relation: between the objects.
        other: id of the other item on the plane.
        sign: 1 where the item has the subject, −1 where it has the reference.
    """

    relation: Relation
    other: str
    sign: int


class Related:
    """The relations between the items of a table, and to the table.

    Args:
        relations: of a plan; those within a rigid group are skipped.
        items: all objects.
        carried: their contents.
        bounds: (2, 2) of the workspace.
    """

    def __init__(self, relations: Sequence[Relation], items: Sequence[TableItem], carried: Carried, bounds: np.ndarray):
        self._items = {item.id: item for item in items}
        self._carried, self._bounds = carried, bounds
        self._on_table: dict[str, list[Relation]] = {}
        self._bonds: dict[str, list[_Bond]] = {}
        self._thirds: dict[tuple[str, int, float, float], np.ndarray] = {}
        for r in (r for r in relations if r.relation not in ("inside", "on")):  # these are the items' own to say
            a = self._root(r.subject)
            if r.reference == TABLE:
                self._on_table.setdefault(a, []).append(r)
            elif (b := self._root(r.reference)) != a:
                self._bonds.setdefault(a, []).append(_Bond(r, b, 1))
                self._bonds.setdefault(b, []).append(_Bond(r, a, -1))

    def _root(self, name: str) -> str:
        inside = self._items[name].inside
        return name if inside is None else self._root(inside)

    def binds(self, name: str) -> bool:
        """Check if an item on the plane must stand somehow to another."""
        return name in self._bonds

    def thirds(self, item: TableItem, yaw: float) -> list[np.ndarray]:
        """(1, 2, 2) each: rectangles, all of which must contain the item's centre at a yaw."""
        found = []
        for number, r in enumerate(self._on_table.get(item.id, ())):
            x, y = self._body(item, yaw, r.subject).mean(axis=0).round(9)
            key = (item.id, number, float(x), float(y))  # one array for all headings at which it is the same
            if key not in self._thirds:
                self._thirds[key] = third_of(r.relation, self._bounds)[None] - np.array([x, y])
            found.append(self._thirds[key])
        return found

    def cuts(self, name: str, yaw: float, placed: Mapping[str, Placed]) -> list[np.ndarray]:
        """(1, 2, 2) each: rectangles outside which the centre of an item breaks a relation to a placed item."""
        found = []
        for own, other, bond in self._boxes(name, yaw, placed):
            word = bond.relation.relation
            if word in DIRECTIONS and bond.sign == 1:
                found.append(_beyond(other, word)[None] - own.mean(axis=0))
            elif word in DIRECTIONS:  # the other's middle must be beyond this one's edge
                at = other.mean(axis=0)
                found.append(_beyond(np.stack([at, at]) - own[::-1], word, against=True)[None])
            elif word in _GAPS:
                found.append(np.stack([other[0] - own[1] - _GAPS[word], other[1] - own[0] + _GAPS[word]])[None])
        return found

    def kept(self, name: str, yaw: float, centres: np.ndarray, placed: Mapping[str, Placed]) -> np.ndarray:
        """(c,) bool: an item at centres (c, 2) keeps all relations to placed items."""
        found = np.ones(len(centres), dtype=bool)
        for own, other, bond in self._boxes(name, yaw, placed):
            boxes = own + centres[:, None]
            a, b = (boxes, other[None]) if bond.sign == 1 else (other[None], boxes)
            found &= hold(bond.relation.relation, a, b)
        return found

    def _boxes(self, name: str, yaw: float, placed: Mapping[str, Placed]) -> list[tuple[np.ndarray, np.ndarray, _Bond]]:
        """The boxes of each relation to a placed item, and the relation.

        The first is the (2, 2) rectangle of the own object around the item's centre at a yaw, the second (2, 2) that of
        the other object in the world.
        """
        found = []
        for bond in self._bonds.get(name, ()):
            at = placed.get(bond.other)
            if at is not None:
                mine, its = bond.relation.subject, bond.relation.reference
                mine, its = (mine, its) if bond.sign == 1 else (its, mine)
                other = self._body(self._items[bond.other], at.yaw, its) + at.centre
                found.append((self._body(self._items[name], yaw, mine), other, bond))
        return found

    def _body(self, item: TableItem, yaw: float, name: str) -> np.ndarray:
        """(2, 2) the rectangle of an object that an item is or carries, around the item's centre at a yaw."""
        if item.id == name:
            return _centred(item, yaw)
        at = next(at for content, at in self._carried.below(item, yaw) if content.id == name)
        return _centred(self._items[name], at.yaw) + at.centre


def _beyond(box: np.ndarray, word: str, against: bool = False) -> np.ndarray:
    """(2, 2) everything beyond a rectangle's edge on the side of a direction word.

    Args:
        box: (2, 2) the rectangle.
        word: which side.
        against: the other side, up to that side's own edge.
    """
    direction = np.array(DIRECTIONS[word])  # pyrefly: ignore
    axis, up = int(np.argmax(np.abs(direction))), (direction.sum() > 0) != against
    found = np.array([[-np.inf, -np.inf], [np.inf, np.inf]])
    found[0 if up else 1, axis] = box[1 if up else 0, axis]
    return found


def _centred(item: TableItem, yaw: float) -> np.ndarray:
    """(2, 2) rectangle of the object itself around the middle of the item's rectangle, at a yaw."""
    turned = replace(item, yaws=(yaw,))
    return turned.body_rectangle() - turned.rectangle().mean(axis=0)
