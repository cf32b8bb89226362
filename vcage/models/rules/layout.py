"""Plans an arrangement from which the task can start: contents around their receptacle, the rest out of the way."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np

from vcage.plans.check import contradictions
from vcage.plans.descriptions import HOLDING, described_relations
from vcage.plans.plain_words import relation_in_words
from vcage.plans.relations import holds
from vcage.schema.asset import CatalogueEntry
from vcage.schema.plan import TABLE, LayoutPlan, Relation, RelationWord
from vcage.schema.scene import ObjectRecord, Scene

_PLACES: tuple[RelationWord, ...] = ("left_of", "right_of", "in_front_of")
"""Places of contents around a receptacle, in turn, so that both arms have something to do."""

_START_FOR_GOAL: Mapping[str | None, RelationWord] = {
    "left_of": "in_front_of",
    "right_of": "in_front_of",
    "in_front_of": "left_of",
}
"""Goal at a side → where the object starts: an arm does not always reach from one side to the other."""

_SIDES: tuple[RelationWord, ...] = ("left_of", "right_of")
"""Places out of the way if there is no room behind anything."""

CLEARANCE_BEHIND_M = 0.06
"""Free space that an object behind another needs, metres."""


def plan_layout(scene: Scene, catalogue: Sequence[CatalogueEntry], rng: np.random.Generator) -> LayoutPlan:
    """Receptacles in the middle, contents left, right and in front of them, everything else behind those.

    Contents are not put inside: moving them there is the task. Contents of another object at the start stay
    there, and their container stands in reach of a hand. The relations form a tree that starts at the table, so
    they cannot contradict each other. Which object goes to which side is a random choice. Descriptions of the
    instruction come before all that.
    """
    carried = [(o, scene.object(o.container)) for o in scene.objects if o.container is not None]
    anchors, contents, context = _groups(scene, {holder.id for _, holder in carried}, rng)
    carried = [(o, holder) for o, holder in carried if not o.rides]
    relations = _anchor_relations(anchors)
    relations += _around(contents, anchors, scene)
    relations += _out_of_the_way(context, anchors, relations, scene)
    relations += [relation(o, _containment_word(o, holder, catalogue), holder) for o, holder in carried]
    relations = _as_described(relations, scene)
    return LayoutPlan(text=as_sentences(relations, scene), relations=relations)


def _as_described(relations: Sequence[Relation], scene: Scene) -> list[Relation]:
    """Descriptions, and the relations that leave them room: of objects described by each other only one is
    planned, the others follow from the descriptions."""
    described = described_relations(scene.laid_out)
    if not described:
        return list(relations)
    found, planned = described, set[str]()
    group = _groups_of(described)
    for r in relations:
        if r in found or group.get(r.subject) in planned or contradictions([*found, r]):
            continue
        found = [*found, r]
        planned |= {group[r.subject]} if r.subject in group else set()
    lost = {r.subject for r in relations} - {r.subject for r in found}
    return [*found, *(Relation(subject=name, relation="on", reference=TABLE) for name in sorted(lost))]


def _groups_of(described: Sequence[Relation]) -> dict[str, str]:
    """One of each group of objects linked by descriptions."""
    found: dict[str, str] = {}
    for r in described:
        if r.reference != TABLE and r.relation not in HOLDING:
            a, b = (found.setdefault(name, name) for name in (r.subject, r.reference))
            found = {name: a if root == b else root for name, root in found.items()}
    return found


def _groups(scene: Scene, holders: Collection[str], rng: np.random.Generator) -> tuple[list[ObjectRecord], ...]:
    """Objects on the table: in the middle, around it, and out of the way."""
    standing = [o for o in scene.objects if o.container is None]
    contents = _shuffled([o for o in standing if o.role in ("content", "tool")], rng)
    context = _shuffled([o for o in standing if o.role == "context"], rng)
    contents += [o for o in context if o.id in holders]
    context = [o for o in context if o.id not in holders]
    receptacles = [o for o in standing if o.role == "receptacle"]
    if receptacles:
        return receptacles, contents, context
    return (contents[:1], contents[1:], context) if contents else (context[:1], [], context[1:])


def _shuffled(items: Sequence[ObjectRecord], rng: np.random.Generator) -> list[ObjectRecord]:
    return [items[i] for i in rng.permutation(len(items))]


def relation(subject: ObjectRecord, word: RelationWord, reference: ObjectRecord) -> Relation:
    """Make a relation between two objects."""
    return Relation(subject=subject.id, relation=word, reference=reference.id)


def _containment_word(item: ObjectRecord, holder: ObjectRecord, catalogue: Sequence[CatalogueEntry]) -> RelationWord:
    """Tell ``inside`` from ``on`` its container: a plate has a rim, but things lie on it."""
    points = next((e.functional_points for e in catalogue if e.name == holder.asset), [])
    fixed = [point.holds for point in points if point.link is None]
    inside = fixed[0] == "in" if fixed else holds("inside", item.aabb, holder.aabb)
    return "inside" if inside else "on"


def _anchor_relations(anchors: Sequence[ObjectRecord]) -> list[Relation]:
    """The first in the middle of the table, the others to its right, one after another."""
    first = [Relation(subject=anchors[0].id, relation="center", reference=TABLE)]
    return first + [relation(b, "right_of", a) for a, b in itertools.pairwise(anchors)]


def _around(contents: Sequence[ObjectRecord], anchors: Sequence[ObjectRecord], scene: Scene) -> list[Relation]:
    """Contents around the receptacle that they go to; in turn to the left, to the right and in front.

    Contents that go to none are dealt out to all. Later ones stand next to the one before them there. An object
    whose goal is the left or the right starts in front, and one whose goal is in front starts on the left.
    """
    asked = {(a.goal.subject, a.goal.reference): a.goal.relation for a in scene.goals}
    relations = []
    last: dict[tuple[str, str], ObjectRecord] = {}
    around = {a.id: 0 for a in anchors}
    for item in contents:
        least = min(anchors, key=lambda a: around[a.id])
        anchor = next((a for a in anchors if (item.id, a.id) in asked), least)
        place = _PLACES[around[anchor.id] % len(_PLACES)]
        around[anchor.id] += 1
        if len(anchors) > 1:
            place = "left_of" if anchor is anchors[0] else "right_of" if anchor is anchors[-1] else "in_front_of"
        place = _START_FOR_GOAL.get(asked.get((item.id, anchor.id)), place)
        before = last.get((anchor.id, place))
        relations.append(relation(item, place, anchor))
        if before is not None:
            relations.append(relation(item, "near", before))
        last[anchor.id, place] = item
    return relations


def _out_of_the_way(
    context: Sequence[ObjectRecord], anchors: Sequence[ObjectRecord], planned: Sequence[Relation], scene: Scene
) -> list[Relation]:
    """Behind a receptacle or behind its neighbour, as a hand that reaches for that comes from the front; never
    at the target of another object."""
    wanted = {(a.goal.reference, a.goal.relation) for a in scene.goals}
    sides = [side for side in _SIDES if (anchors[0].id, side) not in wanted] or ["in_front_of"]
    beside = [scene.object(r.subject) for r in planned if r.relation in ("left_of", "right_of")]
    free = [*anchors, *(o for o in beside if o not in anchors)]
    relations = []
    for index, item in enumerate(context):
        may_be = (o for o in free if (o.id, "behind") not in wanted and fits_behind(item, o, scene))
        reference = next(may_be, None)
        if reference is None:
            relations.append(relation(item, sides[index % len(sides)], anchors[0]))
        else:
            free.remove(reference)
            relations.append(relation(item, "behind", reference))
    return relations


def fits_behind(item: ObjectRecord, anchor: ObjectRecord, scene: Scene) -> bool:
    """Check if the workspace has room for ``item`` behind ``anchor`` in its middle."""
    depth = sum(o.aabb[1][1] - o.aabb[0][1] for o in (item, anchor)) - (anchor.aabb[1][1] - anchor.aabb[0][1]) / 2
    middle = (scene.workspace.lower[1] + scene.workspace.upper[1]) / 2
    return middle + depth + CLEARANCE_BEHIND_M < scene.workspace.upper[1]


def as_sentences(relations: Sequence[Relation], scene: Scene) -> str:
    """The relations as sentences."""
    phrases = {o.id: o.phrase for o in scene.objects}
    sentences: dict[str, list[str]] = {}
    for r in relations:
        sentences.setdefault(r.subject, []).append(relation_in_words(r.relation, r.reference, phrases))
    return " ".join(f"Set the {phrases[subject]} {' and '.join(places)}." for subject, places in sentences.items())


MAX_ROW = 3
"""Receptacles that stand side by side: more are too wide for the part of the table that two arms share."""

_Spot = tuple[RelationWord, ObjectRecord]
"""On which side of what."""


def plan_scene(scene: Scene, catalogue: Sequence[CatalogueEntry], rng: np.random.Generator) -> LayoutPlan:
    """A plan for all uses of the scene's objects; left and right are a random choice.

    Args:
        scene: with its objects on the table.
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
