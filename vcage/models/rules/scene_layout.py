"""Plans the layout of a scene that has no instruction, so that every sub-task of it can be done.

What things are put into or on stands in the middle, where both arms come to; what opens there has nothing before it.
What is carried stands around that, like by like.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from vcage.models.rules.layout import as_sentences, fits_behind, relation
from vcage.schema.asset import CatalogueEntry
from vcage.schema.plan import TABLE, LayoutPlan, Relation, RelationWord
from vcage.schema.scene import ObjectRecord, Scene

_Spot = tuple[RelationWord, ObjectRecord]
"""Beside what, and on which side."""


def plan_scene(scene: Scene, catalogue: Sequence[CatalogueEntry], rng: np.random.Generator) -> LayoutPlan:
    """A plan for all that the scene's objects can be used for; which stands left and which right is a random choice.

    Args:
        scene: its objects stand on the table.
        catalogue: tells which have moving parts, and of what kind they are.
        rng: of all choices.
    """
    kinds = {entry.name: entry for entry in catalogue}
    things = [scene.objects[i] for i in rng.permutation(len(scene.objects))]
    fixtures = [o for o in things if _is_fixture(kinds[o.asset])]
    places = sorted((o for o in things if o.role == "receptacle"), key=lambda o: (o not in fixtures, -_area(o)))
    rest = [o for o in things if o not in places and o not in fixtures]
    rest.sort(key=lambda o: (o.role, kinds[o.asset].words.category))
    row = [*places, *(o for o in fixtures if o not in places)] or rest[:1]
    relations, left, right = _row(row)
    free = list(_spots(row[0], left, right, fixtures, scene))
    relations += _by_kind([o for o in rest if o not in row], free)
    return LayoutPlan(text=as_sentences(relations, scene), relations=relations)


def _is_fixture(kind: CatalogueEntry) -> bool:
    """Whether it has moving parts and is not carried about itself."""
    return bool(kind.moving_parts) and not any(p.link is None and p.use == "grasp" for p in kind.contact_points)


def _area(o: ObjectRecord) -> float:
    (x0, y0, _), (x1, y1, _) = o.aabb
    return (x1 - x0) * (y1 - y0)


def _row(row: Sequence[ObjectRecord]) -> tuple[list[Relation], ObjectRecord, ObjectRecord]:
    """The first in the middle of the table, the others in turn to its left and right; and the outermost ones."""
    left = right = row[0]
    relations = [Relation(subject=row[0].id, relation="center", reference=TABLE)]
    for number, o in enumerate(row[1:]):
        if number % 2 == 0:
            relations.append(relation(o, "left_of", left))
            left = o
        else:
            relations.append(relation(o, "right_of", right))
            right = o
    return relations, left, right


def _spots(
    middle: ObjectRecord, left: ObjectRecord, right: ObjectRecord, fixtures: Sequence[ObjectRecord], scene: Scene
) -> Iterator[_Spot]:
    """Where there is room around the row, the best first: at its ends, before what does not open, behind the rest."""
    yield "left_of", left
    yield "right_of", right
    for o in dict.fromkeys((left, right, middle)):
        if o not in fixtures:
            yield "in_front_of", o
    for o in dict.fromkeys((left, right)):
        if fits_behind(middle, o, scene):
            yield "behind", o


def _by_kind(things: Sequence[ObjectRecord], spots: Sequence[_Spot]) -> list[Relation]:
    """The things in the order given, shared out over the spots; neighbours stand near each other."""
    relations = []
    for (word, reference), group in zip(spots, np.array_split(range(len(things)), len(spots)), strict=True):
        for place, number in enumerate(group):
            relations.append(relation(things[number], word, reference))
            relations += [relation(things[number], "near", things[number - 1])] if place else []
    return relations
