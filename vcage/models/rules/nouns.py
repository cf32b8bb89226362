"""Noun phrases of a sentence, and how well each names a kind of the catalogue: all of its words count."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from lark import Token

from vcage.base.words import (
    COLOURS,
    MASS_KINDS,
    NUMBERS,
    PART_WORDS,
    SIDES,
    SIZES,
    WHICH_PART,
    colours_of,
    is_plural,
    lemma,
)
from vcage.objects.names import EXACT, HEAD, KIND, SYNONYM, best_looks, colour_level
from vcage.schema.asset import CatalogueEntry, Variant

_QUANTIFIERS = {
    "other": "other", "another": "other", "rest": "rest", "remaining": "rest", "others": "rest", "all": "all",
    "every": "all", "each": "all", "both": "all", "everything": "all", "anything": "all", "else": "rest",
}  # fmt: skip


_FALLEN = re.compile(r"\b((lying|fallen|toppled|overturned)( over)?|(tipped|knocked) over) (?=\S)")
"""Words of a thing that has fallen over, before its name."""


class Doubt(Exception):
    """Words that mean nothing or too much in a scene, and why; of the whole sentence if empty."""


class Conflict(Doubt):
    """A reading that is sound word by word but contradicts itself: the sentence may have been meant so."""


@dataclass(frozen=True)
class Noun:
    """A noun phrase for a thing.

    Args:
        words: lemmas, the head last, without colours and the words of other fields; empty without a head.
        colour: the requested one; of two, as in ``yellow and white``.
        size: the requested one, in one spelling.
        quantifier: the, a, all, other, rest, or "" without one.
        count: the number, if given.
        plural: True for a plural form.
        position: left, right, middle, front or back among several, or on the table; of parts top, middle or bottom.
        relations: (preposition, noun) that identify the object, or give its place at the start; (side, the table) too.
        but: the exceptions.
        lies: True where it is said to have fallen over.
        pronoun: it or them, if it is one.
        text, at: as typed, and where in the sentence.
    """

    words: tuple[str, ...] = ()
    colour: str | None = None
    size: str | None = None
    quantifier: str = ""
    count: int | None = None
    plural: bool = False
    position: str | None = None
    relations: tuple[tuple[str, Noun], ...] = ()
    but: tuple[Noun, ...] = ()
    lies: bool = False
    pronoun: str = ""
    text: str = ""
    at: int = 0

    @property
    def name(self) -> tuple[str, ...]:
        """The words that tell what it is: its size, and the lemmas."""
        return self.words if self.size is None else (self.size, *self.words)

    @property
    def part(self) -> str | None:
        """First word of the name of a moving part that it may mean; the words before the head name the owner."""
        return PART_WORDS.get(self.words[-1]) if self.words else None

    @property
    def of_table(self) -> bool:
        """True for the table that all stands on."""
        return self.words in (("table",), ("desk",), ("counter",), ("tabletop",))

    @property
    def everything(self) -> bool:
        """True for "everything" with nothing more said of it."""
        plain = replace(self, text="", at=0)
        return plain == Noun(words=("thing",), quantifier="all", plural=True)

    @property
    def headless(self) -> bool:
        """True for a phrase that leans on another noun: "the red one", "the other", "the rest"."""
        return not self.words and not self.pronoun

    @property
    def several(self) -> bool:
        """True if it means more than one thing."""
        mass = bool(set(self.words[-1:]) & MASS_KINDS) and self.quantifier in ("the", "")
        return self.count not in (None, 1) or (self.count is None and (self.plural or self.quantifier == "all" or mass))

    @property
    def owner(self) -> Noun:
        """The owner of the part that it names; itself where it names no part, or no owner."""
        owner = self.words[:-2]
        return replace(self, words=owner, position=None) if self.part and owner and self.words[-2] == "of" else self

    @property
    def both_of_two(self) -> bool:
        """True for the first of "both the apple and the lemon", or of "both the red and the blue block"."""
        return not self.plural and self.text.lower().startswith("both ")

    @property
    def number(self) -> int | None:
        """The number of objects it means; None for several or all the rest."""
        return self.count or (None if self.several or self.quantifier == "rest" else 1)

    @property
    def definite(self) -> bool:
        """True if it names known objects, and not just any similar ones."""
        return self.quantifier not in ("a", "other") and (self.count is None or self.quantifier in ("the", "all"))

    def positions(self, nouns: Sequence[Noun]) -> list[str]:
        """Find the places by which a sentence tells things of this name apart."""
        same = [noun for noun in nouns if (noun.name, noun.colour) == (self.name, self.colour)]
        return list(dict.fromkeys(noun.position for noun in same if noun.position is not None))

    def like(self, other: Noun) -> Noun:
        """The same of another noun's kind."""
        return replace(self, words=other.words, but=()).without(self.but)

    def without(self, but: Sequence[Noun]) -> Noun:
        """The same, but for some; "the red one" is one of its kind."""
        return replace(self, but=(*self.but, *(noun.like(self) if noun.headless else noun for noun in but)))

    def names_part(self, part: str) -> bool:
        """Check if it may mean a moving part of this name."""
        kind, *which = part.split("_")
        return (kind == self.part or (kind, self.part) == ("screen", "lid")) and self.position in (None, *which)

    def of_part(self, entries: Iterable[CatalogueEntry]) -> bool:
        """Check if it names a part, and not a thing whose name ends so, such as "the cash drawer"."""
        named = not self.words[1:] or "of" in self.words or all(self.fit(entry)[0] < HEAD for entry in entries)
        return self.part is not None and named

    def named(self, entries: Mapping[str, CatalogueEntry], short: bool = False) -> dict[str, list[Variant]]:
        """The kinds that match its name best, or whose part it means, by name, with the matching looks.

        Args:
            entries: by any name.
            short: "the eraser" may be short for the pencil eraser, where "eraser" is another's name.
        """
        best = self._best(entries, short)
        out = [but.named(entries) for but in self.but if but.part is None]
        left = {name: [v for v in looks if all(v not in o.get(name, ()) for o in out)] for name, looks in best.items()}
        if best and not any(left.values()):
            raise Doubt(self.but[0].text, "nothing is left without it")
        return {name: looks for name, looks in left.items() if looks}

    def _best(self, entries: Mapping[str, CatalogueEntry], short: bool) -> dict[str, list[Variant]]:
        fit = self.owns if self.of_part(entries.values()) else self.fit
        fits = {name: fit(entry) for name, entry in entries.items()}
        least = self._least([level for level, _ in fits.values()], short)
        found = {name: looks for name, (level, looks) in fits.items() if level >= least}
        if self.colour is not None and least < EXACT and self._is_carried(entries.values()):
            found = {name: looks for name, looks in found.items() if entries[name].can_be_carried}
        return self._nearest_in_colour(found)

    def _nearest_in_colour(self, found: Mapping[str, list[Variant]]) -> dict[str, list[Variant]]:
        exact = max((colour_level(look, self.colour) for looks in found.values() for look in looks), default=0)
        kept = {n: [look for look in looks if colour_level(look, self.colour) == exact] for n, looks in found.items()}
        return {name: looks for name, looks in kept.items() if looks}

    def _is_carried(self, entries: Iterable[CatalogueEntry]) -> bool:
        """True where things of its very name are carried: "the blue can" is no trash can where cans are red."""
        plain = replace(self, colour=None)
        return any(entry.can_be_carried for entry in entries if plain.fit(entry)[0] == EXACT)

    def _least(self, levels: Sequence[int], short: bool) -> int:
        best = max([KIND, *levels])
        if short and best == SYNONYM and len(self.name) == 1 and self.position is None:
            best = HEAD
        return KIND if self.several and best < EXACT else best

    def owns(self, entry: CatalogueEntry) -> tuple[int, list[Variant]]:
        """Return how well its words for an owner name a kind that has the part, and the looks that they fit."""
        if sum(map(self.names_part, entry.parts)) < (self.count or 2 if self.several else 1):
            return 0, []
        owner = [word for word in self.name[:-1] if word != "of"]
        anyone = owner in ([], [self.part])  # "the layer of the drawer"
        return (KIND, entry.variants) if anyone else best_looks(owner, self.colour, entry)

    def fit(self, entry: CatalogueEntry) -> tuple[int, list[Variant]]:
        """Return how well it names a kind (0: not at all), and the looks that it fits; see :func:`best_looks`."""
        return best_looks(self.name, self.colour, entry)


def noun_of(found: Sequence[Token], text: str, at: int) -> Noun:
    """A noun from its tokens, as typed and where."""
    types = {token.type for token in found}
    quantifier, count = _quantity(_words(found, "DET", "REST", "EVERYTHING"))
    last, *_ = [*_words(found, "WORD", "ONE")[-1:], ""]
    plural = "EVERYTHING" in types or is_plural(last)
    words, lies = _without_fallen(_words(found, "WORD"), types)
    noun = Noun(quantifier=quantifier, count=count, plural=plural, lies=lies, text=text, at=at)
    words, sides = list(map(lemma, words)), _words(found, "AT")
    idle = ("empty", "different") if plural else ("empty",)
    words = [SIZES.get(word, word) for word in words if word not in idle]  # nothing lies in what is not said to hold it
    known = COLOURS if "EVERYTHING" in types else COLOURS - {"orange"}
    if not types.isdisjoint(("ONE", "REST")) or set(words) <= known | SIZES.keys():
        noun = _named(noun, words, [], {**SIDES, **WHICH_PART}, sides)
        return replace(noun, words=noun.words or ("thing",) * ("EVERYTHING" in types))
    owner = [SIZES.get(word, word) for word in map(lemma, _words(found, "OF"))]
    colours, name = _owner(owner, words[-1])
    noun = _named(noun, [*colours, *words[:-1]], [*name, words[-1]], _telling_apart(words), sides)
    thirds = [SIDES[word] for word in _words(found, "AT_TABLE") if word in SIDES]
    on_table = tuple((third, Noun(words=("table",), text=text, at=at)) for third in thirds)
    return replace(noun, relations=on_table)


def _without_fallen(words: Sequence[str], types: Collection[str]) -> tuple[list[str], bool]:
    """Drop the words for having fallen over; True where there were some.

    Args:
        words: of a noun phrase, the name last.
        types: of the phrase's tokens; "one" follows the words where ONE is among them.
    """
    one = "ONE" in types
    said = " ".join([*words, *["one"] * one])
    told = _FALLEN.sub("", said)
    return told.split()[: -1 if one else None], told != said or "FALLEN_OVER" in types


def _owner(words: Sequence[str], head: str) -> tuple[list[str], list[str]]:
    """The words after "of": the colours of the owner of a part or hole, and the others; else all belong to the name."""
    own = [word for word in words if (head in PART_WORDS or head == "hole") and word in COLOURS]
    return own, [word for word in words if word not in own]


def _telling_apart(words: Sequence[str]) -> Mapping[str, str]:
    """Words that tell apart what a noun names: parts by their height or side, all else by its side.

    "The left hole" is one of the mouths of a hole, not the hole of the thing on the left.
    """
    if words[-1] == "hole" and words[-2:-1] and words[-2] in SIDES:
        return {}
    return {**SIDES, **WHICH_PART} if words[-1] in PART_WORDS else SIDES


def _named(noun: Noun, before: list[str], name: list[str], sides: Mapping[str, str], at: list[str]) -> Noun:
    """With the words before its name: a colour, a side, or more of the name."""
    where = [*(sides[word] for word in before if word in sides), *(SIDES[word] for word in at if word in SIDES), None]
    words = [word for word in before if word not in COLOURS and word not in sides and word != "and"]
    sizes = [] if set(name[-1:]) & PART_WORDS.keys() else [word for word in words if word in SIZES]
    words = [word for word in words if word not in sizes[:1]]
    noun = replace(noun, colour=colours_of(" ".join(before)), position=where[0])
    return replace(noun, words=(*words, *name), size=next(iter(sizes), None))


def _words(found: Sequence[Token], *types: str) -> list[str]:
    return [word for token in found if token.type in types for word in re.split("[ -]|'s\\b", token) if word]


def _quantity(words: list[str]) -> tuple[str, int | None]:
    """The quantifier and the number that words before a noun say."""
    words = words[1:] if words[:1] == ["a"] and words[1:2] in (["few"], ["couple"]) else words
    numbers = [int(word) if word.isdigit() else NUMBERS[word] for word in words if word.isdigit() or word in NUMBERS]
    count, *_ = [*[0] * (len({*numbers}) > 1), *[1] * ("another" in words), *numbers, *[1] * ("any" in words), None]
    quantifiers = [_QUANTIFIERS[word] for word in words if word in _QUANTIFIERS]
    if quantifiers or not words:
        return "".join(quantifiers[-1:]), count
    if words[0] not in ("any", "some", *NUMBERS) and not words[0].isdigit() and "of" not in words[:2]:
        return "the", count
    return "a" * (count is not None), count


def with_relations(*nouns: Noun | None) -> Iterator[Noun]:
    """Nouns, and those that they are described by: "the bowl on the side" has two."""
    for noun in nouns:
        if noun is not None:
            yield noun
            yield from with_relations(*(other for _, other in noun.relations), *noun.but)
