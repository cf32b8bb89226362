"""Contradictions in a layout plan: names, circles, supports, centres.

Every complaint is a sentence that a reasoner can act on. Limits by the sizes of objects are the matter of
:mod:`vcage.layout.capacities`.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Collection, Mapping, Sequence

from vcage.base.graphs import circles
from vcage.plans.descriptions import unsaid
from vcage.plans.plain_words import in_words
from vcage.plans.relations import DIRECTIONS
from vcage.schema.goals import part_words
from vcage.schema.plan import TABLE, LayoutPlan, Relation, RelationWord
from vcage.schema.scene import Scene

MOST_COMPLAINTS = 20
"""Largest number of complaints to a reasoner at a time."""

PlanCheck = Callable[[LayoutPlan], list[str]]
"""Complaints about a plan, one sentence each; empty when nothing is wrong."""

SizeCheck = Callable[[Sequence[Relation]], list[str]]
"""Relations that sizes rule out, one sentence each (:func:`vcage.layout.capacities.size_complaints`)."""

AXES: tuple[tuple[str, RelationWord, RelationWord], ...] = (
    ("left of", "left_of", "right_of"),
    ("in front of", "in_front_of", "behind"),
)
"""Words, the relation they stand for, and the one that says the same with subject and reference swapped."""


def plan_complaints(plan: LayoutPlan, scene: Scene, sizes: SizeCheck | None = None) -> list[str]:
    """Complaints that make a plan unusable for a scene; empty when it may be possible.

    Args:
        plan: text and relations.
        scene: with the objects.
        sizes: without it sizes are not looked at.
    """
    names = {TABLE, *(o.id for o in scene.objects)}
    known = [r for r in plan.relations if r.subject in names and r.reference in names]
    found = [] if plan.text.strip() else ["text: is empty"]
    found += _strangers(plan.relations, names) + contradictions(known) + (sizes(known) if sizes else [])
    found += _taken_out(plan.relations, scene) + _unplanned(plan.relations, scene)
    found += _undescribed(plan.relations, scene) + _stowed(plan.relations, scene)
    more = len(found) - MOST_COMPLAINTS
    return [*found[:MOST_COMPLAINTS], f"and {more} more complaints like these"] if more > 0 else found


def _strangers(relations: Sequence[Relation], names: Collection[str]) -> list[str]:
    named = dict.fromkeys(name for r in relations for name in (r.subject, r.reference))
    return [f"there is no object {name!r}" for name in named if name not in names]


def _taken_out(relations: Sequence[Relation], scene: Scene) -> list[str]:
    lies = {(r.subject, r.reference) for r in relations if r.relation in ("inside", "on")}
    return [
        f"{o.id} lies in or on {o.container} at the start: say that it stays there"
        for o in scene.objects
        if o.container is not None and not o.rides and (o.id, o.container) not in lies
    ]


def _unplanned(relations: Sequence[Relation], scene: Scene) -> list[str]:
    placed = {r.subject for r in relations}
    missing = [o.id for o in scene.objects if o.id not in placed and not o.rides]
    return [f"nothing says where {', '.join(missing)} go"] if missing else []


def _undescribed(relations: Sequence[Relation], scene: Scene) -> list[str]:
    phrases = {o.id: o.phrase for o in scene.objects}
    return [
        f"must be true and is not said: {d.subject} {d.relation} {d.reference}, as {in_words(d, phrases)} ({d.words!r})"
        for d in unsaid(relations, scene.laid_out)
    ]


def _stowed(relations: Sequence[Relation], scene: Scene) -> list[str]:
    named = {name for r in relations for name in (r.subject, r.reference)}
    return [
        f"{o.id} lies in {_of_part(o.container_part)}{o.container} and goes where that goes: leave it out"
        for o in scene.objects
        if o.rides and o.id in named
    ]


def _of_part(part: str | None) -> str:
    return "" if part is None else f"the {part_words(part)} of "


def contradictions(relations: Sequence[Relation]) -> list[str]:
    """Contradictions in a plan, one sentence each; empty for a plan that may be possible.

    Finds relations to oneself or of the table, circles (a left of b left of c left of a, also through what things lie
    in), objects in or on two things, in something and next to it, two objects in one centre, one object in two thirds
    of the table, and objects in thirds of it against their order.
    """
    relations = _distinct(relations)
    sound = sound_relations(relations)
    found = [text for r in relations if (text := _nonsense(r))]
    found += [
        _circle("inside or on", names) for names in circles([(r.subject, r.reference) for r in containments(sound)])
    ]
    supports = supports_in(sound)
    found += _two_supports(sound) + _beside_own_support(sound, supports) + _shared_centres(sound, supports)
    for words, word, swapped in AXES:
        edges = [edge for edge, _ in order_along(sound, word, swapped)]
        found += [_circle(words, names) for names in circles(edges)]
        found += _torn(sound, word, swapped, edges)
    return list(dict.fromkeys(found))


def sound_relations(relations: Sequence[Relation]) -> list[Relation]:
    """Relations that are sound one by one, without repetitions."""
    return [r for r in _distinct(relations) if not _nonsense(r)]


def containments(relations: Sequence[Relation]) -> list[Relation]:
    """Relations of one object in or on another."""
    return [r for r in relations if r.relation in ("inside", "on") and r.reference != TABLE]


def supports_in(relations: Sequence[Relation]) -> dict[str, str]:
    """The support of each object, the first that is named; empty for a plan with a circle."""
    pairs = [(r.subject, r.reference) for r in containments(relations)]
    return {} if circles(pairs) else dict(reversed(pairs))


def _distinct(relations: Sequence[Relation]) -> list[Relation]:
    return list({(r.subject, r.relation, r.reference): r for r in relations}.values())


def _nonsense(r: Relation) -> str | None:
    if r.subject == r.reference:
        return f"{r.subject} is {r.relation} itself"
    if r.subject == TABLE:
        return f"the table cannot be {r.relation} {r.reference}"
    if r.reference == TABLE and r.relation not in ("center", "on", *DIRECTIONS):
        known = ", ".join(["center", "on", *DIRECTIONS])
        return f"{r.subject} is {r.relation} the table: only {known} relate to the table"
    return None


def _circle(words: str, names: Sequence[str]) -> str:
    return f"{f' {words} '.join([*names, names[0]])}: that is a circle"


def _torn(
    relations: Sequence[Relation], word: RelationWord, swapped: RelationWord, edges: Sequence[tuple[str, str]]
) -> list[str]:
    """Objects in two thirds of the table along an axis, and pairs in thirds that are in the other order.

    Args:
        relations: of the plan.
        word, swapped: as :func:`order_along` takes them.
        edges: (before, after) that it finds.
    """
    number = {word: 0, "center": 1, swapped: 2}
    thirds = [(r.subject, r.relation) for r in relations if r.reference == TABLE and r.relation in number]
    found = [
        f"{name} cannot be both {a} and {b} the table"
        for (name, a), (other, b) in itertools.combinations(thirds, 2)
        if name == other and a != b
    ]
    after: dict[str, list[str]] = {}
    for before, behind in edges:
        after.setdefault(before, []).append(behind)
    for name, third in thirds:
        beyond = _beyond(name, after)
        found += [
            f"{name} is {third} the table, so it cannot be {word} what leads to {other}, which is {its} the table"
            for other, its in thirds
            if other in beyond and other != name and number[its] < number[third]
        ]
    return found


def _beyond(name: str, after: Mapping[str, Sequence[str]]) -> set[str]:
    """All that comes after a name, directly or by others."""
    found, waiting = set[str](), [name]
    while waiting:
        new = [other for other in after.get(waiting.pop(), ()) if other not in found]
        found.update(new)
        waiting += new
    return found


def _two_supports(relations: Sequence[Relation]) -> list[str]:
    found, support = [], {}
    for r in relations:
        if r.relation in ("inside", "on"):
            other = support.setdefault(r.subject, r.reference)
            if other != r.reference:
                found.append(f"{r.subject} cannot be in or on both {other} and {r.reference}")
    return found


def _above(name: str, supports: Mapping[str, str]) -> list[str]:
    """The object, its container, the container of that, …"""
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


def order_along(
    relations: Sequence[Relation], word: RelationWord, swapped: RelationWord
) -> list[tuple[tuple[str, str], str]]:
    """((before, after), reference) of an order along an axis.

    Contents of different containers are ordered as these are: an apple in a bowl is where the bowl is.

    Args:
        relations: of the plan.
        word, swapped: the relation of before to after, and that of after to before (:data:`AXES`).
    """
    found, supports = [], supports_in(relations)
    for r in relations:
        if r.relation in (word, swapped) and r.reference != TABLE:
            subject, reference = _siblings(r.subject, r.reference, supports)
            if subject != reference:
                edge = (subject, reference) if r.relation == word else (reference, subject)
                found.append((edge, reference))
    return found


def _siblings(a: str, b: str, supports: Mapping[str, str]) -> tuple[str, str]:
    """The supports of ``a`` and ``b``, or they, that stand on the same thing; equal if one is in the other."""
    up_a, up_b = _above(a, supports)[::-1], _above(b, supports)[::-1]
    if up_a[0] != up_b[0]:
        return up_a[0], up_b[0]
    shared = sum(1 for _ in itertools.takewhile(lambda pair: pair[0] == pair[1], zip(up_a, up_b, strict=False)))
    return (up_a[shared], up_b[shared]) if shared < min(len(up_a), len(up_b)) else (a, a)
