"""From a reasoner's selection to named objects: its faults, the names, and the starting places."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from vcage.layout.capacities import size_complaints
from vcage.layout.items import TableItem
from vcage.layout.placement.contents import CONTENT_MARGIN_M
from vcage.models.checked_reading import Instructed
from vcage.objects.painting import look, looks_of, with_look
from vcage.plans.check import contradictions
from vcage.plans.descriptions import HOLDING
from vcage.schema.asset import CatalogueEntry, Variant
from vcage.schema.goals import Description
from vcage.schema.plan import TABLE, Relation, SelectedAsset, Selection
from vcage.schema.scene import Role


@dataclass(frozen=True)
class NamedObject:
    """One object of a scene before it has a place.

    Args:
        id: unique in the scene: ``marker_black``, ``marker_black_2``.
        asset, variant: names in the catalogue.
        phrase: its name in words: "black marker pen" where the asset comes in several colours, else "stapler".
        role: its use in the instruction.
        starts_in: id of its container or support at the start, None on the table.
        starts_in_part: moving part of that object, such as a drawer.
        heaped: True where it lies loose there: a ball among others.
    """

    id: str
    asset: str
    variant: str
    phrase: str
    role: Role
    starts_in: str | None = None
    starts_in_part: str | None = None
    heaped: bool = False


def validate_selection(selection: Selection, entries: Sequence[CatalogueEntry]) -> list[str]:
    """Complaints about a selection, one sentence each: unknown names, starting places without room."""
    variants = {entry.name: looks_of(entry) for entry in entries}
    points = {entry.name: {p.link for p in entry.functional_points} for entry in entries}
    complaints = []
    for chosen in selection.objects:
        if chosen.asset not in variants:
            complaints.append(f"there is no asset {chosen.asset!r}{_nearest(chosen.asset, list(variants))}")
        elif chosen.variant not in variants[chosen.asset]:
            known = ", ".join(variants[chosen.asset])
            complaints.append(f"{chosen.asset} has no variant {chosen.variant!r}; it has {known}")
        if chosen.starts_in in points and chosen.starts_in_part not in points[chosen.starts_in]:
            complaints.append(_no_room(chosen, points[chosen.starts_in]))
    return complaints


def _no_room(chosen: SelectedAsset, parts: Iterable[str | None]) -> str:
    """Why an object cannot start where it was said to, with the parts that have room."""
    where = f"{chosen.starts_in_part} of {chosen.starts_in}" if chosen.starts_in_part else chosen.starts_in
    with_room = ", ".join(sorted(part for part in parts if part))
    known = f"; it has room in its {with_room}" if with_room else ""
    return f"{chosen.asset} cannot start in or on {where}, which has no room for things{known}"


def _nearest(name: str, names: list[str]) -> str:
    close = difflib.get_close_matches(name, names, n=3)
    return f"; did you mean {' or '.join(close)}?" if close else ""


def name_objects(selection: Selection, entries: Sequence[CatalogueEntry]) -> list[NamedObject]:
    """Names for a valid selection, in its order (see :class:`NamedObject`).

    Raises:
        KeyError: the selection names something outside the catalogue (see :func:`validate_selection`).
    """
    by_name = {entry.name: entry for entry in entries}
    named: list[NamedObject] = []
    containers: dict[str, str] = {}  # asset → id of its first object
    for chosen in selection.objects:
        entry = by_name[chosen.asset]
        variant = look(entry, chosen.variant)
        if variant is None:
            raise KeyError(f"{chosen.asset}/{chosen.variant}")
        base = f"{entry.name}_{variant.id}" if variant.painted or len(entry.variants) > 1 else entry.name
        taken, phrase = {other.id for other in named}, phrase_of(entry, variant)
        start = (chosen.starts_in, chosen.starts_in_part if chosen.starts_in else None)
        named.append(NamedObject(_unique(base, taken), entry.name, variant.id, phrase, chosen.role, *start))
        containers.setdefault(entry.name, named[-1].id)
    return [replace(o, starts_in=containers.get(o.starts_in) if o.starts_in else None) for o in named]


def entries_of(objects: Iterable[NamedObject], entries: Iterable[CatalogueEntry]) -> dict[str, CatalogueEntry]:
    """The catalogue's entry of each object, with no other look than its own, by its id."""
    by_name, found = {entry.name: entry for entry in entries}, dict[str, CatalogueEntry]()
    for one in objects:
        own = look(by_name[one.asset], one.variant)
        if own is not None:
            found[one.id] = with_look(by_name[one.asset], own)
    return found


def instructed(instruction: str, objects: Iterable[NamedObject], things: Mapping[str, CatalogueEntry]) -> Instructed:
    """An instruction and the objects that it is about, which ``things`` has the entries of."""
    objects = list(objects)
    lying = {o.id: o.starts_in for o in objects if o.starts_in is not None}
    return Instructed(instruction, things, lying, [o.id for o in objects if o.role == "content"])


def phrase_of(entry: CatalogueEntry, variant: Variant) -> str:
    """The words for a look of a kind, with its colour if the kind comes in several."""
    several = variant.painted is not None or len({v.colour for v in entry.variants}) > 1
    return f"{variant.colour} {entry.words.name}" if several else entry.words.name


def room_complaints(objects: Sequence[NamedObject], items: Mapping[str, TableItem]) -> list[str]:
    """Objects without room where they start, one sentence each with the sizes. Moving parts are checked elsewhere.

    Args:
        objects: of a scene, before they have places.
        items: geometry by object id.
    """
    items = {name: _as_placed(item) for name, item in items.items()}
    found, lying = list[str](), list[Relation]()
    for o in objects:
        if o.starts_in is not None and o.starts_in_part is None and not o.heaped:
            word = "inside" if items[o.starts_in].holds == "in" else "on"
            tried = [*lying, Relation(subject=o.id, relation=word, reference=o.starts_in)]
            complaints = contradictions(tried) + size_complaints(tried, items, overhang=False)
            if complaints:
                found.append(f"{o.id} has no room where it starts, {word} {o.starts_in}: {'; '.join(complaints)}")
            else:
                lying = tried
    return found


def starting_as_described(
    objects: Sequence[NamedObject], descriptions: Sequence[Description]
) -> tuple[list[NamedObject], list[str]]:
    """The objects with their described starting places, and contradictions, a sentence
    each."""
    named = dict.fromkeys(name for d in descriptions for name in (d.subject, d.reference))
    known = {TABLE, *(o.id for o in objects)}
    holding = [d for d in descriptions if d.relation in HOLDING]
    by_thing = {d.subject: d for d in holding if d.reference != TABLE}
    by_table = {d.subject: d for d in holding if d.reference == TABLE}
    complaints = [f"there is no object {name!r}" for name in named if name not in known]
    for o in objects:
        complaints += _contradictions(o, by_thing.get(o.id), by_table.get(o.id))
    return [_starting(o, by_thing.get(o.id)) for o in objects], complaints


def _starting(o: NamedObject, where: Description | None) -> NamedObject:
    return o if where is None else replace(o, starts_in=where.reference, starts_in_part=where.part)


def _contradictions(o: NamedObject, by_thing: Description | None, by_table: Description | None) -> Iterator[str]:
    """Complaints about an object that does not start at its described place."""
    if by_thing is not None and o.starts_in not in (None, by_thing.reference):
        said = f"{by_thing.relation} {by_thing.reference} ({by_thing.words!r})"
        yield f"{o.id} starts in or on {o.starts_in}, not {said}"
    starts_in = _starting(o, by_thing).starts_in
    if by_table is not None and starts_in:
        yield f"{o.id} starts in or on {starts_in}, not on the table ({by_table.words!r})"


def _as_placed(item: TableItem) -> TableItem:
    """The item with the opening that a placement uses: contents keep clear of the walls."""
    if item.opening is None:
        return item
    width, depth = (max(side - 2 * CONTENT_MARGIN_M, 0.0) for side in item.opening.size)
    return replace(item, opening=replace(item.opening, size=(width, depth)))


def _unique(base: str, taken: set[str]) -> str:
    name, number = base, 1
    while name in taken:
        number += 1
        name = f"{base}_{number}"
    return name
