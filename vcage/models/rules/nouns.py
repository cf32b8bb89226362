"""Noun phrases of a sentence, and how well each names a kind of the catalogue: all of its words count."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from lark import Token

from vcage.base.words import COLOURS, MASS_KINDS, NUMBERS, PART_WORDS, SIDES, WHICH_PART, colour_of, lemma
from vcage.objects.names import EXACT, HEAD, KIND, SYNONYM, looks_named
from vcage.schema.asset import CatalogueEntry, Variant

_QUANTIFIERS = {
    "other": "other", "another": "other", "rest": "rest", "remaining": "rest", "others": "rest", "all": "all",
    "every": "all", "each": "all", "both": "all", "everything": "all", "anything": "all",
}  # fmt: skip


@dataclass(frozen=True)
class Noun:
    """A noun phrase for a thing.

    Args:
        words: lemmas, the head last, without colours and what the other fields say; empty where it has no head.
        colour: that is asked for.
        quantifier: the, a, all, other, rest, or "" where it has none.
        count: how many, if that is said.
        plural: whether its form says several.
        part: first word of the name of a moving part that it may mean, and ``which``: top, middle, bottom.
        owner: lemmas of what has the part; empty where nothing is said of it.
        position: left, right, middle, front or back among several, or on the table.
        relation: (preposition, noun) that says which one is meant, or where it lies at the start.
        but: what is excepted.
        pronoun: it, them or both, where it is one.
        text, at: as typed, and where in the sentence.
    """

    words: tuple[str, ...] = ()
    colour: str | None = None
    quantifier: str = ""
    count: int | None = None
    plural: bool = False
    part: str | None = None
    which: str | None = None
    owner: tuple[str, ...] = ()
    position: str | None = None
    relation: tuple[str, Noun] | None = None
    but: tuple[Noun, ...] = ()
    pronoun: str = ""
    text: str = ""
    at: int = 0

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
    def definite(self) -> bool:
        """True if it names known things, and not any that are alike."""
        return self.quantifier not in ("a", "other") and (self.count is None or self.quantifier in ("the", "all"))

    def like(self, other: Noun) -> Noun:
        """The same of another noun's kind."""
        same = replace(self, words=other.words, part=other.part, owner=other.owner, which=self.which or other.which)
        return replace(same, but=()).without(self.but)

    def without(self, but: Sequence[Noun]) -> Noun:
        """The same, but for some; "the red one" is one of its kind."""
        return replace(self, but=(*self.but, *(noun.like(self) if noun.headless else noun for noun in but)))

    def names_part(self, part: str) -> bool:
        """Check if it may mean a moving part of this name."""
        kind, *which = part.split("_")
        return (kind == self.part or (kind, self.part) == ("screen", "lid")) and self.which in (None, *which)

    def of_part(self, entries: Iterable[CatalogueEntry]) -> bool:
        """Check if it names a part, and not a thing whose name ends so, such as "the cash drawer"."""
        return self.part is not None and (len(self.words) == 1 or all(self.fit(e)[0] < HEAD for e in entries))

    def named(self, entries: Mapping[str, CatalogueEntry], short: bool = False) -> dict[str, list[Variant]]:
        """Those of some kinds that it names best, or whose part it means, by name, with the looks that it fits.

        Args:
            entries: by any name.
            short: "the eraser" may be short for the pencil eraser, where "eraser" is another's name.
        """
        fit = self.owns if self.of_part(entries.values()) else self.fit
        fits = {name: fit(entry) for name, entry in entries.items()}
        least = self._least([level for level, _ in fits.values()], short)
        told = {name: looks for name, (level, looks) in fits.items() if level >= least}
        for out in [but.named(entries) for but in self.but]:
            told = {name: [v for v in looks if v not in out.get(name, ())] for name, looks in told.items()}
        return {name: looks for name, looks in told.items() if looks}

    def _least(self, levels: Sequence[int], short: bool) -> int:
        best = max([KIND, *levels])
        if short and best == SYNONYM and len(self.words) == 1 and self.position is None:
            best = HEAD
        return KIND if self.several and best < EXACT else best

    def owns(self, entry: CatalogueEntry) -> tuple[int, list[Variant]]:
        """How well its words for an owner name a kind that has the part, and the looks that they fit."""
        if sum(map(self.names_part, entry.moving_parts)) < (self.count or 2 if self.several else 1):
            return 0, []
        anyone = self.owner in ((), (self.part,))
        return (KIND, entry.variants) if anyone else Noun(words=self.owner, colour=self.colour).fit(entry)

    def fit(self, entry: CatalogueEntry) -> tuple[int, list[Variant]]:
        """How well it names a kind (0: not at all), and the kind's looks that it fits; see :func:`looks_named`."""
        return looks_named(self.words, self.colour, entry)


def noun_of(parts: Sequence[Token | list[str]], text: str, at: int) -> Noun:
    """A noun from its tokens and the words after "of", as typed and where."""
    found = [part for part in parts if isinstance(part, Token)]
    types = [token.type for token in found]
    told = _words(found, ("WORD",))
    quantifier, count = _quantity(_words(found, ("DET", "REST", "EVERYTHING")))
    last = [*told[-1:], *_words(found, ("ONE", "REST"))[-1:], ""][0].removesuffix("'s")
    position, *_ = [*(SIDES[word] for word in _words(found, ("AT",)) if word in SIDES), None]
    noun = Noun(quantifier=quantifier, count=count, plural=lemma(last) != last, text=text, at=at)
    if "EVERYTHING" in types:
        return _everything(noun, told)
    of = [lemma(word) for part in parts if not isinstance(part, Token) for word in part]
    return _named(replace(noun, position=position), told, of, one="ONE" in types)


def _words(found: Sequence[Token], types: Sequence[str]) -> list[str]:
    return [word for token in found if token.type in types for word in token.replace("-", " ").split()]


def _everything(noun: Noun, told: list[str]) -> Noun:
    """'Everything', or 'everything red'; other words must name a kind."""
    coloured = len(told) == 1 and told[0] in COLOURS
    words = tuple(map(lemma, told)) if told and not coloured else ("thing",)
    return replace(noun, words=words, colour=colour_of(" ".join(told)) if coloured else None, plural=True)


def _named(noun: Noun, told: list[str], of: list[str], one: bool) -> Noun:
    """With the words that are left when colour, position and part are told."""
    plain = [lemma(word.removesuffix("'s")) for word in told]
    if one or (not of and set(plain) <= COLOURS - {"orange"}):
        return _headless(noun, plain)
    noun = replace(noun, colour=colour_of(" ".join(plain[:-1])))
    words = [*filter(lambda word: word not in COLOURS, plain[:-1]), plain[-1]]
    if words[-1] in PART_WORDS:
        return _part(noun, words, of)
    if words[0] in SIDES and words[1:]:
        noun, words = replace(noun, position=SIDES[words[0]]), words[1:]
    return replace(noun, words=(*of, *words))


def _headless(noun: Noun, plain: list[str]) -> Noun:
    """'The red one', 'the top one', 'the red', 'the rest'."""
    first, *_ = [*(word for word in plain if word not in COLOURS), ""]
    noun = replace(noun, position=SIDES.get(first, noun.position), which=WHICH_PART.get(first))
    return replace(noun, colour=colour_of(" ".join(plain)))


def _part(noun: Noun, words: list[str], of: list[str]) -> Noun:
    """'The top drawer of the cabinet'."""
    which, *_ = [*(WHICH_PART[word] for word in words if word in WHICH_PART), None]
    words = [word for word in words if word not in WHICH_PART]
    owner = tuple(of or words[:-1])
    return replace(noun, words=tuple(words), part=PART_WORDS[words[-1]], owner=owner, which=which)


def _quantity(words: list[str]) -> tuple[str, int | None]:
    """The quantifier and the number that words before a noun say."""
    numbers = [int(word) if word.isdigit() else NUMBERS.get(word) for word in words]
    count, *_ = [*[1] * ("another" in words), *filter(lambda number: number is not None, numbers), None]
    quantifiers = [_QUANTIFIERS[word] for word in words if word in _QUANTIFIERS]
    if quantifiers or not words:
        return "".join(quantifiers[:1]), count
    if words[0] not in ("any", "some", *NUMBERS) and not words[0].isdigit() and "of" not in words[:2]:
        return "the", count
    return "a" * (count is not None or "any" in words), count
