"""Which entries of the catalogue answer a noun phrase, and which of several the occasion speaks for."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from vcage.base.words import (
    COLOURS,
    DETERMINERS,
    SHALLOW,
    colour_of,
    lemmas,
)
from vcage.models.rules.instruction import Request
from vcage.models.rules.phrases import Phrase
from vcage.objects.names import is_of_kind, names_of, score_name
from vcage.schema.asset import CatalogueEntry, Variant
from vcage.schema.plan import TABLE

MIN_SCORE = 0.4
"""Below this a name does not answer a phrase."""

THING_SCORE = 0.5
"""Below this a name does not answer a phrase for a thing that is moved: a pencil eraser is no pencil."""

_SYNONYM = 0.97
_KIND = 0.8
_MADE_FOR = 0.2
_HOLDS_SO = 0.2
"""What it is worth that things go ``in`` or ``on`` a place, as it is said."""
_AMBIGUITY = 0.12
"""Scores this close are told apart by the occasion: shared scene tags and the other words of the instruction."""


@dataclass(frozen=True)
class Candidate:
    """A catalogue entry that may answer a phrase."""

    entry: CatalogueEntry
    score: float
    kind: bool
    """Whether the phrase names a kind of things (bread, fruit) that this entry is one of."""


def score_entry(phrase: Phrase, entry: CatalogueEntry) -> Candidate:
    """How well an entry answers a phrase, by its names, its synonyms, and the kind of thing it is."""
    names = names_of(entry)
    score = max(
        *(score_name(phrase.lemmas, name) for name in names[:3]),
        *(_SYNONYM * score_name(phrase.lemmas, name) for name in names.synonyms),
    )
    kind = len(phrase.lemmas) == 1 and is_of_kind(phrase.head, entry, names)
    return Candidate(entry, max(score, _KIND) if kind else score, kind)


def candidates(phrase: Phrase, catalogue: Sequence[CatalogueEntry], least: float = THING_SCORE) -> list[Candidate]:
    """The entries that answer a phrase, best first; ties keep the order of their names.

    Args:
        least: the lowest score that counts as an answer.
    """
    scored = [score_entry(phrase, entry) for entry in catalogue]
    return sorted((c for c in scored if c.score >= least), key=lambda c: (-c.score, c.entry.name))


def places(
    phrase: Phrase, catalogue: Sequence[CatalogueEntry], moved: Iterable[Phrase] = (), holds: str = ""
) -> list[Candidate]:
    """The entries that answer a phrase for a place: those with the part that it names, or those that hold things.

    Args:
        moved: what is put there; a soap dish is the dish for soap.
        holds: whether things go ``in`` or ``on`` it, if that is said; an entry that holds them so comes first.
    """
    named = candidates(phrase, catalogue, MIN_SCORE)
    if phrase.part is None:
        found = [c for c in named if c.entry.functional_points] or named
        told = phrase.head not in SHALLOW
        found = [replace(c, score=c.score + _HOLDS_SO) if told and _holds(c.entry, holds) else c for c in found]
    else:
        found = _with_part(phrase.part, phrase, named, catalogue) or named
    words = {word for thing in moved for word in thing.lemmas}
    found = [replace(c, score=c.score + _MADE_FOR) if _made_for(c.entry, phrase, words) else c for c in found]
    return sorted(found, key=lambda c: (-c.score, c.entry.name))


def _holds(entry: CatalogueEntry, how: str) -> bool:
    return any(point.holds == how for point in entry.functional_points)


def _with_part(
    part: str, phrase: Phrase, named: Sequence[Candidate], catalogue: Sequence[CatalogueEntry]
) -> list[Candidate]:
    """The entries that have the part, as many of it as the phrase needs if there are such; 'a drawer' is anyone's."""
    found = list(named)
    if phrase.head == part:
        own = [names_of(c.entry).words for c in found]  # 'the drawer' is not the cash drawer, whose name it is
        found = [
            replace(c, score=c.score - _HOLDS_SO) if len(words) > 1 and words[-1] == part else c
            for c, words in zip(found, own, strict=True)
        ]
        known = {c.entry.name for c in named}
        found += [Candidate(entry, _KIND, True) for entry in catalogue if entry.name not in known]
    counts = [(c, count_parts(c.entry, part)) for c in found]
    enough = max(phrase.least_parts, 1)
    exactly = [c for c, count in counts if count == enough]
    return exactly or [c for c, count in counts if count >= enough] or [c for c, count in counts if count]


def _made_for(entry: CatalogueEntry, phrase: Phrase, words: set[str]) -> bool:
    """Whether the place's name is the phrase and what is put there: 'dish', 'soap' and 'soap dish'."""
    *qualifiers, head = names_of(entry).words
    return head == phrase.head and bool(qualifiers) and set(qualifiers) <= words | set(phrase.lemmas)


def count_parts(entry: CatalogueEntry, part: str) -> int:
    """How many moving parts of this sort an entry has: drawers, for example."""
    return sum(part in lemmas(name) for name in entry.moving_parts)


def variants_of(entry: CatalogueEntry, phrase: Phrase) -> list[Variant]:
    """The looks of an entry that have the colour that the phrase asks for; all when it asks for none."""
    if phrase.colour is None:
        return list(entry.variants)
    return [v for v in entry.variants if phrase.colour in (colour_of(v.colour), colour_of(v.id))]


def scene_tags(phrases: Iterable[Phrase], catalogue: Sequence[CatalogueEntry]) -> list[str]:
    """Scene tags of what the phrases most likely are."""
    tags: set[str] = set()
    for phrase in phrases:
        found = candidates(phrase, catalogue)
        tags.update(*(c.entry.words.scene_tags for c in found if c.score == found[0].score))
    return sorted(tags)


def goes_in(entry: CatalogueEntry, place: CatalogueEntry) -> bool:
    """Whether the entry, turned by a quarter if need be, is smaller than the outside of the place."""
    return all(a < b for a, b in zip(sorted(entry.size[:2]), sorted(place.size[:2]), strict=True))


class Occasion:
    """What the rest of the instruction says: breaks ties between entries of nearly equal score."""

    def __init__(self, instruction: str, tags: Iterable[str]):
        self.words = [w for w in lemmas(instruction) if len(w) > 3 and w not in DETERMINERS | COLOURS]
        self.tags = frozenset(tags)

    def fit(self, entry: CatalogueEntry) -> float:
        """Larger for entries whose words and scene tags go with the instruction."""
        names = {word for name in names_of(entry).all for word in name}
        named = sum(any(n.startswith(w) or w.startswith(n) for n in names if len(n) > 3) for w in self.words)
        described = sum(word in lemmas(entry.words.description) for word in self.words)
        return named + 0.25 * described + 0.5 * len(self.tags & set(entry.words.scene_tags))

    def best(self, found: Sequence[Candidate]) -> Candidate:
        """The candidate that fits best among those of nearly the best score."""
        close = [c for c in found if c.score >= found[0].score - _AMBIGUITY]
        return max(close, key=lambda c: (round(self.fit(c.entry), 6), c.score, -found.index(c)))

    def suiting(self, entries: Sequence[CatalogueEntry]) -> list[CatalogueEntry]:
        """The entries that belong to the scene of the occasion; all when fewer than two do."""
        here = [entry for entry in entries if self.tags & set(entry.words.scene_tags)]
        return here if len(here) > 1 else list(entries)


def things_meant(
    phrase: Phrase, catalogue: Sequence[CatalogueEntry], occasion: Occasion, taken: Iterable[str] = ()
) -> list[CatalogueEntry]:
    """The entries that a phrase for moved things means: the best one, or all of a kind that it asks several of.

    Args:
        taken: names that it cannot mean, such as that of the place; empty when only these answer it.
    """
    found = [c for c in candidates(phrase, catalogue) if c.entry.name not in set(taken)]
    found = [c for c in found if variants_of(c.entry, phrase)]
    found = [c for c in found if c.entry.contact_points] or found
    if not found:
        return []
    best = occasion.best(found)
    several = phrase.count is None or phrase.count > 1
    if several and any(c.kind for c in found):
        return [c.entry for c in found if c.kind or c.entry is best.entry]
    return [best.entry]


class Places:
    """The places of an instruction: the same words mean the same place throughout."""

    def __init__(self, catalogue: Sequence[CatalogueEntry]):
        self._catalogue = catalogue
        self._chosen: dict[tuple[object, ...], CatalogueEntry | None] = {}

    def of(self, request: Request, things: Sequence[CatalogueEntry]) -> CatalogueEntry | None:
        """The entry that a clause means by its place; ``None`` when it names none, or nothing answers it.

        Args:
            things: the catalogue of what is moved; where it belongs tells places of nearly equal score apart.
        """
        place = request.place
        if place is None or place.lemmas == (TABLE,):
            return None
        key = (place.lemmas, place.colour, place.part)
        if key not in self._chosen:
            moved = request.things
            words = " ".join([request.asked, *(p.text for p in moved), place.text])
            found = [
                c for c in places(place, self._catalogue, moved, request.preposition) if variants_of(c.entry, place)
            ]
            self._chosen[key] = Occasion(words, scene_tags(moved, things)).best(found).entry if found else None
        return self._chosen[key]
