"""The objects of a scene that the nouns of a sentence mean, and their required state at the start."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from vcage.base.text import listed
from vcage.base.words import SHALLOW
from vcage.models.rules.nouns import Doubt, Noun
from vcage.models.rules.plain_text import IN_NO_HOLE
from vcage.objects.names import names_of
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import Description
from vcage.schema.plan import TABLE

Things = Mapping[str, CatalogueEntry]

_ORDERS = {"x": ("left", "middle", "right"), "y": ("front", "middle", "back")}
_TABLE_RELATIONS = {
    "left": "left_of",
    "right": "right_of",
    "front": "in_front_of",
    "back": "behind",
    "middle": "center",
}
BESIDE = ("left_of", "right_of", "in_front_of", "behind", "beside", "near")
_RELATION = {"in": "inside", "on": "on"}
_BEFORE = {"x": ("left_of", "right_of"), "y": ("in_front_of", "behind")}


@dataclass(frozen=True)
class Spot:
    """Target of a placement: in or on an object, or one of its parts; without a name where the word says it."""

    name: str
    relation: str
    part: str | None = None


@dataclass
class Meanings:
    """Finds for each noun the objects that it means; the same noun means the same throughout.

    Args:
        things: catalogue's entries by object id, each with the object's own look only.
        lying: object id → id of its container or support.
        nouns: all of the sentence, in order.
    """

    things: Things
    lying: Mapping[str, str]
    nouns: Sequence[Noun]
    descriptions: dict[str, Description] = field(default_factory=dict)
    excepted: list[str] = field(default_factory=list)
    tools: list[str] = field(default_factory=list)
    _meant: dict[Noun, list[str]] = field(default_factory=dict)
    _parts_named: list[tuple[str, str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        certain = (self._called(noun) for noun in self.nouns if noun.definite and not noun.several)
        self._claimed = {found[0] for found in certain if len(found) == 1}  # "another one" is none of these

    def objects(self, noun: Noun, besides: Collection[str] = ()) -> list[str]:
        """The objects that a noun means.

        Args:
            besides: objects it does not mean.

        Raises:
            Doubt: there are none, or it is ambiguous.
        """
        if noun not in self._meant:
            self.excepted += [name for but in noun.but for name in self.objects(but)]
            found = self._called(noun, () if noun.position or noun.quantifier == "other" else besides)
            if not found:
                raise Doubt(noun.text, "nothing that is there is called so")
            used = self._used()
            self._meant[noun] = [self._at_position(noun, found)] if noun.position else self._chosen(noun, found, used)
            self._relate(noun)
        return self._meant[noun]

    def _relate(self, noun: Noun) -> None:
        """Describe a noun's object by its place."""
        for how, other in noun.relations:
            if noun.several:  # everything in the bowl, but for the bowl
                self._meant[noun] = [name for name in self._meant[noun] if name not in self.objects(other)]
            for name in self._meant[noun]:
                self.lies(name, how, other)

    def _used(self) -> set[str]:
        return {*self.tools, *(n for names in self._meant.values() for n in names), *(n for n, _ in self._parts_named)}

    def _called(self, noun: Noun, besides: Collection[str] = ()) -> list[str]:
        """All objects that fit a noun's words: the best matches; of several the portable ones."""
        found = list(noun.named({name: e for name, e in self.things.items() if name not in besides}, short=True))
        return [name for name in found if self.things[name].can_be_carried or not noun.several] or found

    def _chosen(self, noun: Noun, found: list[Any], used: Collection[Any]) -> list[Any]:
        """As many of the matching objects as the noun asks for."""
        if noun.quantifier in ("other", "rest"):
            chosen = [one for one in found if one not in used]
            chosen = chosen if len(chosen) < len(found) else []  # there must be another one
        elif not noun.definite:
            chosen = [one for one in found if one not in used and one not in self._claimed][: noun.count]
        else:
            chosen = found[: noun.number] if noun.relations else found  # identifying which one
        if not chosen or noun.number not in (None, len(chosen)):
            raise Doubt(noun.text, f"nobody can tell which of {listed(found)} is meant, and how many")
        return chosen

    def _at_position(self, noun: Noun, found: list[str]) -> str:
        """The left one of several, described against the others; of one, against the table."""
        position = str(noun.position)
        if len(found) == 1 and position in _TABLE_RELATIONS:
            self.describe(found[0], _TABLE_RELATIONS[position], TABLE, noun)
            return found[0]
        asked = noun.positions(self.nouns)
        axis = "x" if {"front", "back"}.isdisjoint(asked) else "y"
        at = _ORDERS[axis] if len(found) > 2 else _ORDERS[axis][::2]
        if noun.several or len(found) > 3 or not set(asked) <= set(at):
            raise Doubt(noun.text, f"which of {listed(found)} it is cannot be told by where it is")
        order = dict(zip([*asked, *(where for where in at if where not in asked)], found))  # as mentioned
        for where in (other for other in order if other != position):
            word = _BEFORE[axis][at.index(position) > at.index(where)]
            self.describe(order[position], word, order[where], noun)
        return order[position]

    def lies(self, name: str, how: str, other: Noun) -> None:
        """Describe an object by another: by its place, or by its container at the start; or by a side of the table.

        Raises:
            Doubt: it lies somewhere else.
        """
        if other.of_table and how in _TABLE_RELATIONS:
            return self.describe(name, _TABLE_RELATIONS[how], TABLE, other)
        if how in ("in", "to") and any(self.things[one].holes for one in self._called(other)):
            raise Doubt(other.text, IN_NO_HOLE)
        spot = self.spots(other, how, [name])[0]
        if spot.name == name:
            raise Doubt(other.text, f"{name} cannot lie in or on itself")
        if spot.relation in ("inside", "on") and self.lying.get(name, spot.name) != spot.name:
            raise Doubt(other.text, f"{name} lies in {self.lying[name]}")
        self.describe(name, spot.relation, spot.name, other, spot.part)

    def describe(self, name: str, relation: str, other: str, noun: Noun, part: str | None = None) -> None:
        """State where an object is at the start, in the words of a noun."""
        values = {"subject": name, "relation": relation, "reference": other, "part": part, "words": noun.text}
        found = Description.model_validate(values)
        self.descriptions[str(found)] = found

    def parts(self, noun: Noun, good: Callable[[str, str], bool]) -> list[tuple[str, str]]:
        """The moving parts meant by a noun, or belonging to its objects: (object, part).

        Args:
            good: tells of an object and a part if the part will do.

        Raises:
            Doubt: there are none, or it is ambiguous.
        """
        found = [pair for pair in self._parts(noun) if good(*pair)]
        found = self._named_before(noun, found) or found
        if not found or noun.but or noun.quantifier == "rest" or (noun.several and noun.position is not None):
            raise Doubt(noun.text, "there is no such part, or it says too little: name each part that is meant")
        chosen = self._chosen(noun, found, self._parts_named)
        self._parts_named += chosen
        return chosen

    def _named_before(self, noun: Noun, found: list[tuple[str, str]]) -> list[tuple[str, str]]:
        """The parts named before, as "the drawer" means one of them, or else parts of objects named before."""
        again = self._parts_named if noun.quantifier == "the" and not noun.several else []
        return [pair for pair in found if pair in again] or [pair for pair in found if pair[0] in self._used()]

    def spots(self, noun: Noun, how: str, besides: Collection[str] = ()) -> list[Spot]:
        """Targets of objects put in, on, to or beside a noun's objects.

        Raises:
            Doubt: nothing is put there, or the place is ambiguous.
        """
        if noun.of_table and how == "on":
            return [Spot(TABLE, "on")]
        if how == "centred":
            return [Spot("", how)]
        of_part = noun.of_part(self.things.values())
        if of_part and how in ("in", "to"):
            places = {name: {point.part for point in entry.functional_points} for name, entry in self.things.items()}
            return [Spot(name, "inside", part) for name, part in self.parts(noun, lambda n, p: p in places[n])]
        owners = self._owners(noun) if of_part else self.objects(noun, besides)
        if len(owners) != 1:
            raise Doubt(noun.text, f"nobody can tell which of {listed(owners)} is meant")
        return [self.spot_of(owners[0], how, noun)]

    def _owners(self, noun: Noun) -> list[str]:
        if noun.position is not None:
            raise Doubt(noun.text, "things go in such a part, not on it or beside it")
        return self._called(noun)

    def spot_of(self, name: str, how: str, noun: Noun) -> Spot:
        """The target of objects put in, on, to or beside an object.

        Raises:
            Doubt: nothing is put there.
        """
        if how in BESIDE:
            return Spot(name, how)
        entry = self.things[name]
        how = _where_on(entry) if how == "off" else how
        shallow = names_of(entry).words[-1] in SHALLOW  # people put things both in and on it
        suits = {
            (point.link, point.holds)
            for point in entry.functional_points
            if how == "to" or (how == "in" if point.link else shallow or point.holds == how)
        }
        if not suits and entry.pegs:
            name = " ".join(names_of(entry).words)
            raise Doubt(
                noun.text, f"nothing is put on a {name} or hangs there at the start; a mug is hung on it: say hang"
            )
        if len(suits) != 1:
            raise Doubt(noun.text, f"nothing can be put {how} it, or not without saying where")
        ((link, holds),) = suits
        return Spot(name, _RELATION[holds], link)

    def _parts(self, noun: Noun) -> list[tuple[str, str]]:
        if noun.of_part(self.things.values()):
            return [(n, p) for n in self._called(noun) for p in self.things[n].parts if noun.names_part(p)]
        return [(name, part) for name in self.objects(noun) for part in self.things[name].moving_parts]


def _where_on(entry: CatalogueEntry) -> str:
    """The preposition for what is taken off a thing: on, if that has a top, else to."""
    return "on" if any(point.holds == "on" and point.link is None for point in entry.functional_points) else "to"
