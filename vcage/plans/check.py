"""Whether a layout plan can be true at all: names, circles, supports, centres, and what the sizes allow.

Every complaint is a sentence that a reasoner can act on. Of sizes only what is certain is complained about: they are
compared as if every object could be turned as it likes, contents by the boxes around them that layouts keep apart.
So a plan without complaints may still be hard to lay out.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from vcage.base.graphs import circles, longest_path
from vcage.plans.relations import DIRECTIONS
from vcage.schema.plan import TABLE, LayoutPlan, Relation, RelationWord
from vcage.schema.scene import Scene, Workspace

FILL_LIMIT = 0.9
"""Largest share of an opening's floor that contents may take."""

ROUNDING = 1e-9
"""Metres by which lengths may differ and count as the same."""

MOST_COMPLAINTS = 20
"""A reasoner is told so many at once."""

PlanCheck = Callable[[LayoutPlan], list[str]]
"""What is wrong with a plan, one sentence each; empty when nothing is."""

_AXES: tuple[tuple[str, RelationWord, RelationWord], ...] = (
    ("left of", "left_of", "right_of"),
    ("in front of", "in_front_of", "behind"),
)
"""Words, the relation they stand for, and the one that says the same with subject and reference swapped."""


@dataclass(frozen=True)
class Capacity:
    """What a plan's check and an arrangement need of an object's geometry.

    Args:
        size: (x, y, z) of its bounding box, metres, in its own frame.
        holds: whether things are put ``in`` it or ``on`` it; None where nothing can be.
        opening: (x, y) edge lengths of the rectangle that contents may take, metres; its own when it holds nothing.
        centre: (x, y) of that rectangle in the object frame.
        ceiling: height over the floor that contents may have, metres; None without a roof.
        bare: whether things stand on its top with nothing around them: one that is wider may stick out.
    """

    size: tuple[float, float, float]
    holds: str | None = None
    opening: tuple[float, float] = (0.0, 0.0)
    centre: tuple[float, float] = (0.0, 0.0)
    ceiling: float | None = None
    bare: bool = False


def plan_complaints(plan: LayoutPlan, scene: Scene, rooms: Mapping[str, Capacity] | None = None) -> list[str]:
    """What makes a plan unusable for a scene; empty when it may be possible.

    Args:
        rooms: geometry by object id; without it sizes are not looked at.
    """
    ids = [o.id for o in scene.objects]
    found = [] if plan.text.strip() else ["text: is empty"]
    named = dict.fromkeys(name for r in plan.relations for name in (r.subject, r.reference))
    strangers = [name for name in named if name not in (*ids, TABLE)]
    found += [f"there is no object {name!r}" for name in strangers]
    known = [r for r in plan.relations if r.subject not in strangers and r.reference not in strangers]
    found += contradictions(known, rooms, scene.workspace if rooms else None)
    lies = {(r.subject, r.reference) for r in plan.relations if r.relation in ("inside", "on")}
    found += [
        f"{o.id} lies in or on {o.container} at the start: say that it stays there"
        for o in scene.objects
        if o.container is not None and (o.id, o.container) not in lies
    ]
    placed = {r.subject for r in plan.relations}
    missing = [object_id for object_id in ids if object_id not in placed]
    found += [f"nothing says where {', '.join(missing)} go"] if missing else []
    more = len(found) - MOST_COMPLAINTS
    return [*found[:MOST_COMPLAINTS], f"and {more} more complaints like these"] if more > 0 else found


def contradictions(
    relations: Sequence[Relation], rooms: Mapping[str, Capacity] | None = None, workspace: Workspace | None = None
) -> list[str]:
    """What cannot be true at once in a plan, one sentence each; empty for a plan that may be possible.

    Finds relations to oneself or of the table, circles (a left of b left of c left of a, also through what things lie
    in), objects in or on two things, in something and next to it, two objects in one centre; with ``rooms`` also what
    does not fit into or onto its reference, alone or together; with ``workspace`` rows that are longer than it.
    """
    relations = list(dict.fromkeys((r.subject, r.relation, r.reference) for r in relations))
    relations = [Relation(subject=s, relation=w, reference=o) for s, w, o in relations]
    nonsense = [text for r in relations if (text := _nonsense(r))]
    sound = [r for r in relations if not _nonsense(r)]
    held = [r for r in sound if r.relation in ("inside", "on") and r.reference != TABLE]
    nested = circles([(r.subject, r.reference) for r in held])
    found = nonsense + [_circle("inside or on", names) for names in nested] + _two_supports(sound)
    supports = {} if nested else {r.subject: r.reference for r in reversed(held)}
    found += _beside_own_support(sound, supports) + _shared_centres(sound, supports)
    for words, word, swapped in _AXES:
        edges = _along(sound, word, swapped, supports)
        ring = circles([edge for edge, _ in edges])
        found += [_circle(words, names) for names in ring]
        if rooms and workspace and not ring:
            found += _too_long(words, edges, rooms, workspace)
    return found + (_too_large(held, rooms) if rooms else [])


def _nonsense(r: Relation) -> str | None:
    if r.subject == r.reference:
        return f"{r.subject} is {r.relation} itself"
    if r.subject == TABLE:
        return f"the table cannot be {r.relation} {r.reference}"
    if r.reference == TABLE and r.relation not in ("center", "on"):
        return f"{r.subject} is {r.relation} the table: only 'center' and 'on' relate to the table"
    return None


def _circle(words: str, names: Sequence[str]) -> str:
    return f"{f' {words} '.join([*names, names[0]])}: that is a circle"


def _two_supports(relations: Sequence[Relation]) -> list[str]:
    found, support = [], {}
    for r in relations:
        if r.relation in ("inside", "on"):
            other = support.setdefault(r.subject, r.reference)
            if other != r.reference:
                found.append(f"{r.subject} cannot be in or on both {other} and {r.reference}")
    return found


def _above(name: str, supports: Mapping[str, str]) -> list[str]:
    """The object, what it lies in, what that lies in, …"""
    chain = [name]
    while chain[-1] in supports:
        chain.append(supports[chain[-1]])
    return chain


def _beside_own_support(relations: Sequence[Relation], supports: Mapping[str, str]) -> list[str]:
    found = []
    for r in relations:
        if r.relation in DIRECTIONS or r.relation in ("beside", "near"):
            if r.reference in _above(r.subject, supports)[1:]:
                found.append(f"{r.subject} cannot be in or on {r.reference} and {r.relation} it")
            elif r.subject in _above(r.reference, supports)[1:]:
                found.append(f"{r.subject} cannot be {r.relation} {r.reference}, which lies in or on it")
    return found


def _shared_centres(relations: Sequence[Relation], supports: Mapping[str, str]) -> list[str]:
    found, centre = [], {}
    for r in relations:
        if r.relation == "center":
            if r.reference not in (TABLE, *_above(r.subject, supports)):
                found.append(f"{r.subject} cannot be in the center of {r.reference} without lying in or on it")
            other = centre.setdefault(r.reference, r.subject)
            stacked = other in _above(r.subject, supports) or r.subject in _above(other, supports)
            if not stacked:
                found.append(f"{other} and {r.subject} cannot both be in the center of {r.reference}")
    return found


def _along(
    relations: Sequence[Relation], word: RelationWord, swapped: RelationWord, supports: Mapping[str, str]
) -> list[tuple[tuple[str, str], str]]:
    """((before, after), reference) of what stands in order along an axis.

    What lies in different things is ordered as these are: an apple in a bowl is where the bowl is.
    """
    found = []
    for r in relations:
        if r.relation in (word, swapped):
            subject, reference = _siblings(r.subject, r.reference, supports)
            if subject != reference:
                edge = (subject, reference) if r.relation == word else (reference, subject)
                found.append((edge, reference))
    return found


def _siblings(a: str, b: str, supports: Mapping[str, str]) -> tuple[str, str]:
    """What ``a`` and ``b`` lie in, or they, such that both stand on the same thing; equal if one is in the other."""
    up_a, up_b = _above(a, supports)[::-1], _above(b, supports)[::-1]
    if up_a[0] != up_b[0]:
        return up_a[0], up_b[0]
    shared = sum(1 for _ in itertools.takewhile(lambda pair: pair[0] == pair[1], zip(up_a, up_b, strict=False)))
    return (up_a[shared], up_b[shared]) if shared < min(len(up_a), len(up_b)) else (a, a)


def _too_long(
    words: str, edges: Iterable[tuple[tuple[str, str], str]], rooms: Mapping[str, Capacity], workspace: Workspace
) -> list[str]:
    """A row needs half the reference's shorter side for each relation, and half of each end."""
    axis = 0 if words == "left of" else 1
    room = workspace.upper[axis] - workspace.lower[axis]
    narrow = {name: min(known.size[:2]) / 2 for name, known in rooms.items()}
    lengths: dict[tuple[str, str], float] = {}
    for edge, reference in edges:
        lengths[edge] = max(lengths.get(edge, 0.0), narrow.get(reference, 0.0))
    length, names = longest_path(lengths, narrow)
    if length <= room:
        return []
    row = f" {words} ".join(names)
    return [f"{row}: this row needs at least {length:.2f} m, {room:.2f} m may be covered"]


def _too_large(held: Sequence[Relation], rooms: Mapping[str, Capacity]) -> list[str]:
    found: list[str] = []
    contents: dict[str, list[str]] = {}
    for r in held:
        item, holder = rooms.get(r.subject), rooms.get(r.reference)
        if item is None or holder is None:
            continue
        complaint = _does_not_take(r, item, holder)
        if complaint:
            found.append(complaint)
        else:
            contents.setdefault(r.reference, []).append(r.subject)
    for name, inside in contents.items():
        found += _crowded(name, list(dict.fromkeys(inside)), rooms)
    return found


def _does_not_take(r: Relation, item: Capacity, holder: Capacity) -> str | None:
    if holder.holds is None or (r.relation == "inside" and holder.holds != "in"):
        return f"{r.subject} cannot be {r.relation} {r.reference}, which has no {_place(r)}"
    if not holder.bare and _narrowest(item.size[:2], holder.opening[1]) > holder.opening[0] + ROUNDING:
        size, room = _cm(item.size[:2]), _cm(holder.opening)
        return f"{r.subject} ({size}) is too large for {r.reference}, which has room for {room}"
    if holder.ceiling is not None and item.size[2] > holder.ceiling:
        return f"{r.subject} is {100 * item.size[2]:.0f} cm high, {r.reference} takes {100 * holder.ceiling:.0f} cm"
    return None


def _place(r: Relation) -> str:
    return "opening" if r.relation == "inside" else "surface to put things on"


def _crowded(name: str, inside: Sequence[str], rooms: Mapping[str, Capacity]) -> list[str]:
    """Contents that do not fit together: by area, else the first two that do not fit beside each other."""
    width, depth = rooms[name].opening
    area = sum(rooms[item].size[0] * rooms[item].size[1] for item in inside)
    if len(inside) > 1 and area > FILL_LIMIT * width * depth:
        return [f"{', '.join(inside)} do not fit into {name} together: they cover {1e4 * area:.0f} cm², "
                f"it has {1e4 * FILL_LIMIT * width * depth:.0f} cm²"]  # fmt: skip
    for a, b in itertools.combinations(inside, 2):
        if not _side_by_side(rooms[a].size[:2], rooms[b].size[:2], (width, depth)):
            return [f"{a} and {b} do not fit into {name} beside each other, which has room for {_cm((width, depth))}"]
    return []


def _side_by_side(a: Sequence[float], b: Sequence[float], room: tuple[float, float]) -> bool:
    """Whether the boxes around two rectangles, each turned as it likes, fit beside each other into a third."""
    return any(_narrowest(a, depth) + _narrowest(b, depth) <= width + ROUNDING for width, depth in (room, room[::-1]))


def _narrowest(size: Sequence[float], depth: float) -> float:
    """Least width of a box of at most that depth around a rectangle that is turned as it likes; infinite without one.

    Width and depth are concave in the angle, so the least is at a quarter turn, or where the depth is just enough.
    """
    x, y = size
    angles = [0.0, math.pi / 2]
    diagonal = math.hypot(x, y)
    if depth < diagonal:
        steep, own = math.asin(depth / diagonal), math.atan2(y, x)
        angles += [angle for angle in (steep - own, math.pi - steep - own) if 0 < angle < math.pi / 2]
    boxes = [(x * math.cos(t) + y * math.sin(t), x * math.sin(t) + y * math.cos(t)) for t in angles]
    return min((wide for wide, deep in boxes if deep <= depth + ROUNDING), default=math.inf)


def _cm(size: Sequence[float]) -> str:
    return " x ".join(f"{100 * x:.1f}" for x in size) + " cm"
