"""Names of the catalogue's kinds: matching of words and phrases, and kinds that look alike."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import NamedTuple

from vcage.base.words import (
    ANYTHING,
    CATEGORIES,
    COLOURS,
    KINDS,
    SIZES,
    colour_of,
    colours_of,
    kinds_of,
    lemma,
    lemmas,
    same_word,
    tokens,
)
from vcage.objects.painting import in_colour
from vcage.schema.asset import CatalogueEntry, Variant

LOOK_ALIKE = frozenset(("bread", "pastry", "fruit", "vegetable", "cutlery"))
"""Kinds whose members resemble each other."""

EXACT, SYNONYM, HEAD, KIND = 4, 3, 2, 1
"""Quality of a match: a kind's name, a synonym, the head and more of a name, or a word for a category."""

_LIKE_COLOURS = (
    {"grey", "silver"},
    {"gold", "yellow"},
    {"beige", "cream", "tan", "brown"},
    {"teal", "turquoise", "cyan"},
    {"navy", "blue"},
    {"pink", "magenta", "purple"},
)
"""Colours that people confuse."""

_WOODS = frozenset(("wood", "oak", "walnut", "beech", "bamboo", "pine", "cherry", "ash"))
"""Words of looks that are wooden."""

_JOINTS = ("of", "with", "a", "an")

_PLACE_CATEGORIES = frozenset(("container", "furniture", "fixture", "appliance", "mat"))
"""Categories that 'the objects' never are: things that others are put into, or that stay where they are."""

Name = tuple[str, ...]
"""Lemmas of a name, the head last."""


class Names(NamedTuple):
    """Lemmas of an entry's names, the head of each name last. No name is empty: one without a
    Latin word is replaced by the entry's own name, and dropped as a synonym."""

    words: Name
    plural: Name
    own: Name
    synonyms: tuple[Name, ...]

    @property
    def all(self) -> tuple[Name, ...]:
        """Every name, synonyms last."""
        return (self.words, self.plural, self.own, *self.synonyms)


def names_of(entry: CatalogueEntry) -> Names:
    """Names of an entry, by its annotation and in the catalogue."""
    words = entry.words
    return _names(entry.name, words.name, words.plural, tuple(words.synonyms))


@functools.lru_cache(maxsize=10_000)
def _names(own_name: str, name: str, plural: str, synonyms: tuple[str, ...]) -> Names:
    """:func:`names_of`, kept: choosing objects asks for the names of the whole catalogue, many times."""
    own = _name(own_name) or (own_name,)
    return Names(_name(name) or own, _name(plural) or own, own, tuple(name for name in map(_name, synonyms) if name))


def _name(text: str) -> Name:
    """Lemmas of a name, its size in one spelling."""
    return tuple(SIZES.get(word, word) for word in lemmas(text))


def sizes_of(entry: CatalogueEntry, words: Sequence[str]) -> list[str]:
    """The sizes by which an entry's names tell it from others of a name: "small" of the small block."""
    names = names_of(entry).all
    return list(dict.fromkeys(name[0] for name in names if name[0] in SIZES and name[1:] == tuple(words)))


def best_looks(words: Sequence[str], colour: str | None, entry: CatalogueEntry) -> tuple[int, list[Variant]]:
    """Rate words and a colour as a name of a kind (see :func:`name_match`), and return the looks that fit best.

    Args:
        words: lemmas without colours, the head last.
        colour: the requested one, or two: ``yellow and white``.
        entry: the kind.
    """
    looks = _looks_of(colour, entry)
    if len(words) == 1 and words[0] in ANYTHING:
        return (KIND if looks and is_of_kind(words[0], entry) else 0), looks
    least = KIND
    if colour and not looks:  # "brown tape" is a name of packing tape
        words, least, looks = (colour, *words), SYNONYM, entry.variants
    levels = [level if (level := name_match(words, entry, look)) >= least else 0 for look in looks]
    best = max(levels, default=0)
    return best, [look for level, look in zip(levels, looks, strict=True) if level == best]


def _looks_of(colour: str | None, entry: CatalogueEntry) -> list[Variant]:
    """The looks of a colour; the painted one where there is none."""
    looks = [look for look in entry.variants if colour_level(look, colour)]
    painted = in_colour(entry, colour) if colour and not looks else None
    return looks if painted is None else [painted]


def colour_level(look: Variant, colour: str | None) -> int:
    """Rate a requested colour as that of a look: 3 it is, 2 it is one of several, 1 it is painted so, 0 it is not.

    Args:
        look: of a kind.
        colour: one, or the two of a two-coloured look (:func:`vcage.base.words.colours_of`); None for any.
    """
    if colour is None or (look.painted and look.colour == colour):
        return 1
    if colour in (colours_of(look.colour), colours_of(look.id)):
        return 3
    if " and " in (colours_of(look.id) or ""):  # a look that is called by two colours is meant by both only
        return 0
    return 2 if colour in map(colour_of, tokens(f"{look.colour} {look.id}")) else 0


def name_match(words: Sequence[str], entry: CatalogueEntry, look: Variant) -> int:
    """Rate words as a name of a kind: :data:`EXACT`, :data:`SYNONYM`, :data:`HEAD`, :data:`KIND`, or 0.

    All words count: each must be in the one name, or describe the look or its material ("corn tin").

    Args:
        words: lemmas without colours, the head last.
        entry: the kind.
        look: one of its variants.
    """
    names, describing = names_of(entry), _describing(look.id, look.colour)
    rest = tuple(word for word in words if word not in describing)
    level = max(_name_level(stated, names) for stated in {tuple(words), rest})
    if not level and len(words) == 1 and is_of_kind(words[0], entry):
        return KIND
    return level


@functools.lru_cache(maxsize=10_000)
def _describing(look: str, colour: str) -> frozenset[str]:
    """Words that describe a look, its colours aside, and its material: corn, wooden."""
    looks = {*lemmas(look), *lemmas(colour)} - COLOURS
    made_of = {f"{word}{end}" for word in looks if len(word) > 3 for end in ("en", "y")}
    return frozenset(looks | made_of | ({"wooden", "wood"} if looks & _WOODS else set()))


@functools.lru_cache(maxsize=100_000)
def _name_level(words: Name, names: Names) -> int:
    """Rate words as one of an entry's names, kept: it is asked for every look of the catalogue."""
    return max(_likeness(words, name, names) for name in names.all)


def _likeness(words: Name, name: Name, names: Names) -> int:
    stated, own = ([word for word in several if word not in _JOINTS] for several in (words, name))
    if not stated or not own:
        return 0
    if sorted(stated) == sorted(own) or "".join(stated) == "".join(own):
        return EXACT if name in (names.words, names.plural, names.own) else SYNONYM
    ends_alike = stated[-1] == own[-1] and "for" not in own  # a box for shoes is no shoe
    return HEAD if ends_alike and set(stated) <= set(own) else 0


def is_of_kind(word: str, entry: CatalogueEntry) -> bool:
    """Check if a word for a kind of things covers the entry; a word for its very self does not count."""
    category = entry.words.category.lower()
    if word in ANYTHING:
        return entry.can_be_carried and category not in _PLACE_CATEGORIES
    return _is_of_kind(word, category, names_of(entry))


@functools.lru_cache(maxsize=100_000)
def _is_of_kind(word: str, category: str, names: Names) -> bool:
    """:func:`is_of_kind` of a word that is not for anything, kept as names are."""
    head = names.words[-1]
    if same_word(head, word):
        return word in KINDS
    plain = {name[0] for name in names.synonyms if len(name) == 1}
    return (
        word in plain
        or word == lemma(category)
        or category in CATEGORIES.get(word, ())
        or any(word in kinds_of(other, category) for other in {head, *plain})
    )


def head_may_mean(head: str, entry: CatalogueEntry) -> bool:
    """Check if a noun with this head may mean an object of the kind, whatever else the noun says."""
    names = names_of(entry)
    return any(same_word(head, name[-1]) for name in names.all) or is_of_kind(head, entry)


def texts_of(entry: CatalogueEntry) -> list[str]:
    """Return the texts of an entry about the kind."""
    words = entry.words
    return [entry.name, words.name, words.plural, *words.synonyms, words.category, words.description]


def look_texts(entry: CatalogueEntry) -> list[str]:
    """Return the texts of an entry about its looks."""
    return [text for look in entry.variants for text in (look.id, look.colour, look.description)]


def has_colour(entry: CatalogueEntry, colour: str) -> bool:
    """True if the object's look or name has the colour, or one easily confused with it."""
    texts = [*look_texts(entry), *texts_of(entry)]
    known = {found for text in texts for word in tokens(text) if (found := colour_of(word))}
    return not known.isdisjoint({colour}.union(*(group for group in _LIKE_COLOURS if colour in group)))


def confusable(entry: CatalogueEntry, other: CatalogueEntry) -> bool:
    """True if the two have the same head noun, or are foods of one kind, which look alike."""
    a, b = names_of(entry).words[-1], names_of(other).words[-1]
    kinds = kinds_of(a, entry.words.category) & kinds_of(b, other.words.category)
    return a == b or bool(kinds & LOOK_ALIKE)
