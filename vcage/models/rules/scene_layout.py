"""Plans the layout of a scene that has no instruction, so that every sub-task of it can be done.

What things are put into or on stands in the middle, where every arm comes to, with the scanners; what opens there has
nothing before it. What is carried stands around that, like by like.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from vcage.models.rules.layout import as_sentences, fits_behind, relation
from vcage.schema.asset import CatalogueEntry
from vcage.schema.plan import TABLE, LayoutPlan, Relation, RelationWord
from vcage.schema.scene import ObjectRecord, Scene

MAX_ROW = 3
"""Receptacles that stand side by side: more are too wide for the part of the table that two arms share."""

_Spot = tuple[RelationWord, ObjectRecord]
"""On which side of what."""


def plan_scene(scene: Scene, catalogue: Sequence[CatalogueEntry], rng: np.random.Generator) -> LayoutPlan:
    """A plan for all that the scene's objects can be used for; which stands left and which right is a random choice.

    Args:
        scene: its objects stand on the table.
        catalogue: tells which have moving parts, and of what kind they are.
        rng: of all choices.
    """
    kinds = {entry.name: entry for entry in catalogue}
    things = [scene.objects[i] for i in rng.permutation(len(scene.objects))]
    fixed = {o.id for o in things if _is_fixture(kinds[o.asset])}
    places = [o for o in things if o.role == "receptacle"] or things[:1]
    places.sort(key=lambda o: (o.id not in fixed, -_area(o)))
    scanners = [o for o in things if kinds[o.asset].reads_codes and o not in places]
    shared = places[MAX_ROW:] + scanners
    rest = [o for o in things if o not in places and o not in shared]
    rest.sort(key=lambda o: (o.id not in fixed, o.role, kinds[o.asset].words.category))
    sides = _sides(places[:MAX_ROW], rng)
    before = [o for o in (*sides.values(), places[0]) if o.id not in fixed]
    relations = _row(sides, places[0]) + _before_the_row(shared, before or places[:1])
    relations += _by_kind(rest, list(_spots(sides, before[len(shared) :], rest, scene)))
    return LayoutPlan(text=as_sentences(relations, scene), relations=relations)


def _row(sides: Mapping[RelationWord, ObjectRecord], middle: ObjectRecord) -> list[Relation]:
    found = [Relation(subject=middle.id, relation="center", reference=TABLE)]
    return found + [relation(o, word, middle) for word, o in sides.items() if o is not middle]


def _before_the_row(shared: Sequence[ObjectRecord], row: Sequence[ObjectRecord]) -> list[Relation]:
    return [relation(o, "in_front_of", row[number % len(row)]) for number, o in enumerate(shared)]


def _is_fixture(kind: CatalogueEntry) -> bool:
    """Check if a kind has moving parts and cannot be carried."""
    return bool(kind.moving_parts) and not kind.can_be_carried


def _area(o: ObjectRecord) -> float:
    (x0, y0, _), (x1, y1, _) = o.aabb
    return (x1 - x0) * (y1 - y0)


def _sides(row: Sequence[ObjectRecord], rng: np.random.Generator) -> dict[RelationWord, ObjectRecord]:
    """The outermost objects on both sides of a row whose first object stands in the middle."""
    words: list[RelationWord] = ["left_of", "right_of"]
    outer = [*row[1:], row[0], row[0]][:2]
    return {words[i]: o for i, o in zip(rng.permutation(2), outer, strict=True)}


def _spots(
    sides: Mapping[RelationWord, ObjectRecord],
    free: Sequence[ObjectRecord],
    rest: Sequence[ObjectRecord],
    scene: Scene,
) -> Iterator[_Spot]:
    """Places around the row, the best first: at its ends, before what does not open, behind the rest."""
    yield from sides.items()
    yield from (("in_front_of", o) for o in free)
    largest = max(rest, key=_area, default=None)
    for o in dict.fromkeys(o.id for o in sides.values()):
        if largest is not None and fits_behind(largest, scene.object(o), scene):
            yield "behind", scene.object(o)


def _by_kind(things: Sequence[ObjectRecord], spots: Sequence[_Spot]) -> list[Relation]:
    """The things in the order given, shared out over the spots; neighbours stand near each other."""
    relations = []
    for (word, reference), group in zip(spots, np.array_split(range(len(things)), len(spots)), strict=True):
        for place, number in enumerate(group):
            relations.append(relation(things[number], word, reference))
            relations += [relation(things[number], "near", things[number - 1])] if place else []
    return relations
