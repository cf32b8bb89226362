"""Which objects of a scene a noun phrase means: strictly, so that every word of it is accounted for."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from enum import Enum

from vcage.base.words import ANYTHING, CATEGORIES, COLOURS, KINDS, colour_of, lemma, lemmas, same_word, tokens
from vcage.models.rules.phrases import Phrase
from vcage.objects.names import is_of_kind, names_of
from vcage.schema.asset import CatalogueEntry

_EDIBLE = CATEGORIES["food"] | {"drink", "pastry"}
_ATTRIBUTES = {"edible": _EDIBLE, "drinkable": frozenset(("drink",))}


_JOINTS = ("of", "with", "a", "an")


class Meaning(Enum):
    """What the objects must be good for."""

    ANY = "any"
    CARRIED = "carried"
    HOLDS = "holds"
    MOVING = "moving"


def words_of(entries: Collection[CatalogueEntry]) -> frozenset[str]:
    """Every word that things are called by, singular and plural, and those for their looks."""
    texts = [
        text
        for entry in entries
        for text in (entry.name, entry.words.name, entry.words.plural, *entry.words.synonyms, entry.words.category)
    ]
    looks = [text for e in entries for v in e.variants for text in (v.id, v.colour)]
    words = {word for text in texts for word in tokens(text)}
    return frozenset(words | {f"{word}s" for word in words}.union(*(tokens(look) for look in looks)))


def meant(
    phrase: Phrase, things: Mapping[str, CatalogueEntry], meaning: Meaning, besides: Collection[str] = ()
) -> list[str]:
    """Ids of the objects that all words of a phrase fit: those that it fits best.

    Args:
        phrase: with its colour; how many it asks for is the caller's matter.
        things: catalogue's entries by object id, each with the object's own look only.
        meaning: of several that the words fit, only those that are good for it, if there are any.
        besides: what it cannot mean.
    """
    others = {name: entry for name, entry in things.items() if name not in besides}
    fits = {name: _fit(phrase, entry) for name, entry in others.items()}
    good = {name: fit for name, fit in fits.items() if fit > 0 and _good_for(others[name], meaning)}
    fits = good or {name: fit for name, fit in fits.items() if fit > 0}
    if not fits and " of " in phrase.text:  # 'tin of corn': corn tin
        before, after = (tuple(w for w in lemmas(t) if w not in COLOURS) for t in phrase.text.split(" of ", 1))
        turned = replace(phrase, text=" ".join((*after, *before)), lemmas=(*after, *before))
        return meant(turned, things, meaning, besides)
    if not fits:
        return []
    if _is_kind_word(phrase):
        return list(fits)
    best = max(fits.values())
    proper = [names[:3] for names in (names_of(things[name]) for name in fits)]
    if (
        meaning is Meaning.CARRIED
        and len(phrase.lemmas) == 1
        and not any(list(phrase.lemmas) in names for names in proper)
    ):
        best = min(best, 2)  # 'the eraser', short for the whiteboard eraser, may be the pencil eraser
        return [name for name, fit in fits.items() if fit >= best]
    return [name for name, fit in fits.items() if fit == best]


def _is_kind_word(phrase: Phrase) -> bool:
    return len(phrase.lemmas) == 1 and (phrase.head in KINDS or phrase.head in CATEGORIES or phrase.head in ANYTHING)


def _good_for(entry: CatalogueEntry, meaning: Meaning) -> bool:
    if meaning is Meaning.CARRIED:
        return entry.can_be_carried
    if meaning is Meaning.HOLDS:
        return bool(entry.functional_points)
    if meaning is Meaning.MOVING:
        return bool(entry.moving_parts)
    return True


def _fit(phrase: Phrase, entry: CatalogueEntry) -> int:
    """3: it is called so; 2: its head is, and the other words describe it; 1: it is of that kind; 0: neither."""
    words = phrase.lemmas
    colour = entry.variants[0]
    if phrase.colour is not None and phrase.colour not in _colours(entry):
        return 0
    attributes = [word for word in words if word in _ATTRIBUTES]
    if attributes:
        category = entry.words.category.lower()
        words = tuple(word for word in words if word not in _ATTRIBUTES)
        drink = any(name[-1] in KINDS["drink"] for name in names_of(entry).all)
        if not all(category in _ATTRIBUTES[word] or (word == "drinkable" and drink) for word in attributes):
            return 0
        if not words:
            return 1
    names = [[word for word in name if word not in _JOINTS] for name in names_of(entry).all]
    plain = [word for word in words if word not in _JOINTS]
    if any(_same(plain, name) for name in names):
        return 3
    colours = set(lemmas(colour.colour)) | set(lemmas(colour.id))
    described = {w for name in names for w in name} | set(lemmas(entry.words.description)) | colours
    described.add(lemma(entry.words.category.lower()))
    *qualifiers, head = plain or [""]
    if head in ANYTHING:  # 'the writing things' are not those whose description has the word
        described = {lemma(entry.words.category.lower()), *colours}
        qualifiers = [word for word in qualifiers if not is_of_kind(word, entry, names_of(entry))]
    explained = all(any(_describes(word, other) for other in described) for word in qualifiers)
    if explained and any(same_word(head, name[-1]) for name in names):
        return 2
    if explained and is_of_kind(head, entry, names_of(entry)):
        return 1
    return 0


def _describes(word: str, other: str) -> bool:
    """Whether a qualifier says what a known word does: 'wooden', 'wood'."""
    return same_word(word, other) or (len(other) >= 4 and word.startswith(other))


def _same(words: Collection[str], name: Collection[str]) -> bool:
    """Whether two names are made of the same words, whatever their order: 'box of tea', 'tea box'; 'mouth wash'."""
    if len(words) == len(name) and all(same_word(a, b) for a, b in zip(sorted(words), sorted(name), strict=True)):
        return True
    return "".join(words) == "".join(name)


def _colours(entry: CatalogueEntry) -> set[str]:
    """The colour words of an object."""
    variant = entry.variants[0]
    found = {colour_of(word) for text in (variant.colour, variant.id) for word in tokens(text)}
    return {colour for colour in found if colour is not None}
