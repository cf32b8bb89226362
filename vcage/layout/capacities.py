"""Capacities: which objects fit into, beside and behind each other, by sizes and openings.

Complaints are certain: sizes are compared as if every object could be turned at will, contents by the boxes around
them that layouts keep apart. So a plan without complaints may still be hard to lay out.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from vcage.base.graphs import circles, longest_path
from vcage.layout.items import ITEMS, TableItem, table_item
from vcage.layout.placement.free_region import TOLERANCE
from vcage.objects.asset import Asset
from vcage.objects.openings import Opening
from vcage.plans.check import AXES, containments, order_along, sound_relations
from vcage.schema.asset import FunctionalPoint
from vcage.schema.plan import Relation
from vcage.schema.scene import Workspace


def capacity_of(name: str, asset: Asset) -> TableItem:
    """The room that an asset needs, and the widest opening or surface that layouts use of it."""
    point = _used_point(asset)
    if point is None:
        return table_item(name, asset)
    opening = asset.opening(point)
    roof = opening.depth if point.holds == "in" and point.sideways else None
    if point.holds != "in":
        opening = replace(opening, rim=np.inf)
    return replace(table_item(name, asset), opening=opening, ceiling=roof)


def opening_for(asset: Asset, contents: Sequence[Asset] = ()) -> Opening | None:
    """The opening that a layout may use of an asset, in the object's frame; None without one.

    A box standing in it does not touch a sloping wall. Where one of the contents is too large for that, the
    wider opening in which things may lie at an angle: the simulator then decides if they stay.

    Returns:
        Its rim is infinitely high where things stand on it, not in it.
    """
    point = _used_point(asset)
    if point is None:
        return None
    if point.holds != "in":
        return replace(asset.opening(point), rim=np.inf)
    narrow = asset.opening(point, standing=True)
    fits = all(np.all(np.sort(content.footprint) <= np.sort(narrow.size)) for content in contents)
    return narrow if fits else asset.opening(point)


def _used_point(asset: Asset) -> FunctionalPoint | None:
    """The first functional point that is in no moving part: contents of drawers are not laid out."""
    return next((point for point in asset.annotation.functional_points if point.link is None), None)


def size_complaints(
    relations: Sequence[Relation],
    items: Mapping[str, TableItem],
    workspace: Workspace | None = None,
    *,
    overhang: bool = True,
) -> list[str]:
    """Complaints about objects that do not fit into or onto their reference, alone or together, and about rows that are
    longer than the workspace.

    Args:
        relations: of a plan; those of objects outside ``items`` are skipped.
        items: geometry by object id, of :func:`capacity_of`.
        workspace: without it the lengths of rows are not checked.
        overhang: True if an object on a bare top may stick out.
    """
    sound = sound_relations(relations)
    found: list[str] = []
    if workspace is not None:
        for words, word, swapped in AXES:
            edges = order_along(sound, word, swapped)
            if not circles([edge for edge, _ in edges]):
                found += _too_long(words, edges, items, workspace)
    return found + _too_large(containments(sound), items, overhang)


def crowding_complaints(held: Mapping[tuple[str, str | None], Sequence[str]], assets: Mapping[str, Asset]) -> list[str]:
    """Complaints about objects that do not fit into one place together; places with several parts are passed over.

    Args:
        held: object id and part (None for the body) of a place → ids of its simultaneous contents.
        assets: by object id.
    """
    found = []
    for (holder, part), inside in held.items():
        points = [p for p in assets[holder].annotation.functional_points if p.is_of(part)]
        if len(points) != 1:
            continue
        name = holder if part is None else f"{part} of {holder}"
        items = {content: table_item(content, assets[content]) for content in inside}
        room = replace(table_item(name, assets[holder]), opening=assets[holder].opening(points[0]))
        found += _crowded(name, list(dict.fromkeys(inside)), items | {name: room})
    return found


def _too_long(
    words: str, edges: Iterable[tuple[tuple[str, str], str]], items: Mapping[str, TableItem], workspace: Workspace
) -> list[str]:
    """A row needs half the reference's shorter side for each relation, and half of each end."""
    axis = 0 if words == "left of" else 1
    room = workspace.upper[axis] - workspace.lower[axis]
    narrow = {name: float(min(known.body_size[:2])) / 2 for name, known in items.items()}
    lengths: dict[tuple[str, str], float] = {}
    for edge, reference in edges:
        lengths[edge] = max(lengths.get(edge, 0.0), narrow.get(reference, 0.0))
    length, names = longest_path(lengths, narrow)
    if length <= room:
        return []
    row = f" {words} ".join(names)
    return [f"{row}: this row needs at least {length:.2f} m, {room:.2f} m may be covered"]


def _too_large(held: Sequence[Relation], items: Mapping[str, TableItem], overhang: bool) -> list[str]:
    found: list[str] = []
    contents: dict[str, list[str]] = {}
    for r in held:
        item, holder = items.get(r.subject), items.get(r.reference)
        if item is None or holder is None:
            continue
        complaint = _does_not_take(r, item, holder, overhang)
        if complaint:
            found.append(complaint)
        else:
            contents.setdefault(r.reference, []).append(r.subject)
    for name, inside in contents.items():
        found += _crowded(name, list(dict.fromkeys(inside)), items)
    return found


def _does_not_take(r: Relation, item: TableItem, holder: TableItem, overhang: bool) -> str | None:
    opening = holder.opening
    if opening is None or (r.relation == "inside" and holder.holds != "in"):
        return f"{r.subject} cannot be {r.relation} {r.reference}, which has no {_place(r)}"
    size = item.body_size
    if not (overhang and holder.bare) and _narrowest(size[:2], opening.size[1]) > opening.size[0] + TOLERANCE:
        room = _cm(opening.size)
        return f"{r.subject} ({_cm(size[:2])}) is too large for {r.reference}, which has room for {room}"
    if holder.ceiling is not None and size[2] > holder.ceiling:
        return f"{r.subject} is {100 * size[2]:.0f} cm high, {r.reference} takes {100 * holder.ceiling:.0f} cm"
    return None


def _place(r: Relation) -> str:
    return "opening" if r.relation == "inside" else "surface to put things on"


def _crowded(name: str, inside: Sequence[str], items: Mapping[str, TableItem]) -> list[str]:
    """Contents that do not fit together: by area, else the first two that do not fit beside each other."""
    width, depth = items[name].room.size
    area = sum(float(np.prod(items[item].body_size[:2])) for item in inside)
    if len(inside) > 1 and area > ITEMS.fill_share * width * depth:
        return [f"{', '.join(inside)} do not fit into {name} together: they cover {1e4 * area:.0f} cm², "
                f"it has {1e4 * ITEMS.fill_share * width * depth:.0f} cm²"]  # fmt: skip
    for a, b in itertools.combinations(inside, 2):
        if not _side_by_side(items[a].body_size[:2], items[b].body_size[:2], (width, depth)):
            return [f"{a} and {b} do not fit into {name} beside each other, which has room for {_cm((width, depth))}"]
    return []


def _side_by_side(a: np.ndarray, b: np.ndarray, room: tuple[float, float]) -> bool:
    """True if the boxes around two rectangles, each turned at will, fit beside each other into a third."""
    return any(_narrowest(a, depth) + _narrowest(b, depth) <= width + TOLERANCE for width, depth in (room, room[::-1]))


def _narrowest(size: np.ndarray, depth: float) -> float:
    """Least width of a box of at most that depth around a rectangle at any angle; infinite without one.

    Width and depth are concave in the angle, so the least is at a quarter turn, or where the depth is just enough.
    """
    x, y = size
    angles = [0.0, math.pi / 2]
    diagonal = math.hypot(x, y)
    if depth < diagonal:
        steep, own = math.asin(depth / diagonal), math.atan2(y, x)
        angles += [angle for angle in (steep - own, math.pi - steep - own) if 0 < angle < math.pi / 2]
    boxes = [(x * math.cos(t) + y * math.sin(t), x * math.sin(t) + y * math.cos(t)) for t in angles]
    return min((wide for wide, deep in boxes if deep <= depth + TOLERANCE), default=math.inf)


def _cm(size: Iterable[float]) -> str:
    return " x ".join(f"{100 * x:.1f}" for x in size) + " cm"
