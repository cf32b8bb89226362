"""From names in stated goals to objects of a scene: their kinds and looks, and the object that a name means."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, replace

import numpy as np

from vcage.base.errors import UnknownName, UsageError
from vcage.goals import KINDS
from vcage.models.occasion import Occasion
from vcage.models.selection_check import NamedObject, name_objects
from vcage.objects.painting import look, looks_of
from vcage.scenes.stated_goals import StatedGoal, StatedTask, shortened
from vcage.schema.asset import CatalogueEntry
from vcage.schema.plan import SelectedAsset, Selection


@dataclass(frozen=True)
class Wish:
    """An object for the scene.

    Args:
        kind: name of it.
        look: the requested one, if any.
        number: of the object among several alike.
        starts_in: of a ball that nothing names: the place of its vessel among the wishes.
    """

    kind: str
    look: str | None
    number: int = 1
    starts_in: int | None = None


def objects_of(task: StatedTask, catalogue: Sequence[CatalogueEntry], rng: np.random.Generator) -> list[NamedObject]:
    """Return the objects of ``--objects``, or else those of the goals, their tools, and balls in what is poured.

    Unrequested looks are drawn, different ones first; of balls, if possible, in no colour of what comes before them.
    All have the role ``context``.

    Raises:
        UnknownName: the catalogue has no such kind or look.
    """
    kinds = {entry.name: entry for entry in catalogue}
    if task.objects is not None:
        wishes = [_wish(name, kinds, "--objects") for count, name in task.objects for _ in range(count)]
    else:
        wishes = _named(task, kinds)
        wishes += [Wish(tool, None) for tool in _tools(task, catalogue, [kinds[wish.kind] for wish in wishes])]
        wishes += _balls(task, wishes, kinds)
    named = name_objects(Selection(objects=_drawn(wishes, kinds, rng)), catalogue)
    vessels = [None if wish.starts_in is None else named[wish.starts_in].id for wish in wishes]
    return [replace(one, starts_in=vessel) for one, vessel in zip(named, vessels, strict=True)]


def split_part(path: str, kinds: Mapping[str, CatalogueEntry], with_part: bool) -> tuple[str, str | None]:
    """Split a name from the moving part at its end: ``cabinet/oak/drawer`` is the drawer of ``cabinet/oak``.

    Args:
        path: as it was written.
        kinds: the catalogue, by name.
        with_part: True if the name may end with a part; the look of a kind is none.
    """
    *head, last = path.split("/")
    if not head or not with_part:
        return path, None
    entry = kinds.get(head[0])
    is_look = len(head) == 1 and entry is not None and last in looks_of(entry)
    return (path, None) if is_look else ("/".join(head), last)


def object_meant(name: str, objects: Sequence[NamedObject], stated: StatedGoal) -> str:
    """Return the id of the object that a name means: an id, or a kind or ``kind/look`` of exactly one object.

    Raises:
        UnknownName: there is none; lists the known ones.
        UsageError: it may mean several; lists these.
    """
    if any(o.id == name for o in objects):
        return name
    found = [o.id for o in objects if name in (o.asset, f"{o.asset}/{o.variant}")]
    if not found:
        hint = "add it to --objects, or take one of those listed"
        raise UnknownName(f"object in {shortened(stated.text)}:", name, [o.id for o in objects], hint)
    if len(found) > 1:
        raise UsageError(
            f"{name!r} in {shortened(stated.text)} may mean {' or '.join(found)}",
            hint="name one of them",
            details={"name": name, "available": found},
        )
    return found[0]


def _named(task: StatedTask, kinds: Mapping[str, CatalogueEntry]) -> list[Wish]:
    """Return one object for each name; a bare kind is the object of that kind with a look given by another name."""
    wishes = dict.fromkeys(
        _wish(split_part(path, kinds, with_part)[0], kinds, shortened(stated.text))
        for stated in (*task.goals, *task.starts)
        for path, with_part in stated.names
    )
    with_look = {wish.kind for wish in wishes if wish.look is not None}
    return [wish for wish in wishes if wish.look is not None or wish.kind not in with_look]


def _wish(name: str, kinds: Mapping[str, CatalogueEntry], where: str) -> Wish:
    """Return the kind and look of a name: ``marker``, ``marker/red``, or an id such as ``marker_red_2``."""
    kind, _, look = name.partition("/")
    if kind in kinds and look:
        looks = looks_of(kinds[kind])
        if look not in looks:
            raise UnknownName(f"look of {kind} in {where}:", look, looks)
        return Wish(kind, look)
    return Wish(name, _only_look(kinds[name])) if name in kinds else _wish_of_id(name, kinds, where)


def _wish_of_id(name: str, kinds: Mapping[str, CatalogueEntry], where: str) -> Wish:
    ids = {f"{entry.name}_{v}": Wish(entry.name, v) for entry in kinds.values() for v in looks_of(entry)}
    ids |= {entry.name: Wish(entry.name, look) for entry in kinds.values() if (look := _only_look(entry))}
    stem, _, number = name.rpartition("_")
    if name in ids:
        return ids[name]
    if stem not in ids or not number.isdecimal():
        raise UnknownName(f"object in {where}:", name, kinds)
    return replace(ids[stem], number=int(number))


def _only_look(entry: CatalogueEntry) -> str | None:
    return entry.variants[0].id if len(entry.variants) == 1 else None


def _tools(task: StatedTask, catalogue: Sequence[CatalogueEntry], there: Sequence[CatalogueEntry]) -> list[str]:
    """Return the scanner, the scale and the hammer that goals need and nothing names: the first kind by name."""
    words = {stated.word for stated in task.goals}
    found = []
    for word in (word for word, kind in KINDS.items() if kind.tool):
        if word in words and not any(word in entry.tool_for for entry in there):
            found += sorted(entry.name for entry in catalogue if word in entry.tool_for)[:1]
    return found


def _balls(task: StatedTask, wishes: Sequence[Wish], kinds: Mapping[str, CatalogueEntry]) -> list[Wish]:
    """Return balls for each vessel to be poured that nothing is stated to lie in; as many as "several" are."""

    starts = [(*one.names[1], one.text) for one in task.starts if one.word == "inside"]
    into = [_wish(split_part(path, kinds, with_part)[0], kinds, text) for path, with_part, text in starts]
    filled = [_numbers(wish, wishes) for wish in into]
    poured = [_numbers(_wish(one.subject, kinds, one.text), wishes) for one in task.goals if one.word == "poured"]
    alone = {number for several in poured if len(several) == 1 for number in several}.difference(*filled)
    vessels = [number for number in sorted(alone) if kinds[wishes[number].kind].holds_loose]
    balls = sorted(name for name, entry in kinds.items() if entry.loose)[:1] * Occasion.most
    return [Wish(ball, None, starts_in=number) for number in vessels for ball in balls]


def _numbers(wish: Wish, wishes: Sequence[Wish]) -> set[int]:
    """Places of those that a wish may mean."""
    return {n for n, one in enumerate(wishes) if one == wish or (wish.look is None and one.kind == wish.kind)}


def _drawn(
    wishes: Sequence[Wish], kinds: Mapping[str, CatalogueEntry], rng: np.random.Generator
) -> list[SelectedAsset]:
    """The objects wished for, each with a look."""
    taken = Counter((wish.kind, wish.look) for wish in wishes)
    chosen, seen = list[SelectedAsset](), set[str]()
    for wish in wishes:
        drawn = wish.look or _draw_look(kinds[wish.kind], taken, seen, rng)
        taken[wish.kind, drawn] += wish.look is None
        shown = look(kinds[wish.kind], drawn)
        seen |= set(shown.colour.split()) if shown is not None and not kinds[wish.kind].loose else set()
        chosen.append(SelectedAsset(asset=wish.kind, variant=drawn, role="context"))
    return chosen


def _draw_look(
    entry: CatalogueEntry, taken: Counter[tuple[str, str | None]], seen: Set[str], rng: np.random.Generator
) -> str:
    apart = [one for one in entry.variants if not entry.loose or seen.isdisjoint(one.colour.split())]
    variants = apart or entry.variants
    fewest = min(taken[entry.name, variant.id] for variant in variants)
    looks = [variant.id for variant in variants if taken[entry.name, variant.id] == fewest]
    return looks[int(rng.integers(len(looks)))]
