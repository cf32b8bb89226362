"""Noun phrases: what is named, in which colour, how many of it, and which part of a place."""

from __future__ import annotations

import functools
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from vcage.models.rules.words import (
    COLOURS,
    DETERMINERS,
    MASS_KINDS,
    NUMBERS,
    colour_of,
    is_plural,
    lemma,
    tokens,
)

SEVERAL = 3
"""How many things a plural without a number means."""

PARTS = frozenset(["drawer", "compartment", "shelf"])
"""Parts of furniture that things are put into."""

_LEAST_PARTS = {
    "top": 2, "upper": 2, "bottom": 2, "lower": 2, "first": 2, "second": 2, "other": 2, "middle": 3, "third": 3,
    "last": 2, "fourth": 4, "fifth": 5,
}  # fmt: skip
"""How many parts a place must have for the word to make sense: a 'lower drawer' is one of two or more."""

_PRONOUNS = frozenset(["it", "them", "they", "these", "those", "this", "that", "both", "everything", "all"])
_BACK = frozenset(["there", "same", "inside"])


@dataclass(frozen=True)
class Phrase:
    """A noun phrase.

    Args:
        text: as written, without articles.
        lemmas: words without numbers, articles and (unless it is the head) colours; the head is last.
        colour: the colour that is asked for.
        count: how many things; ``None`` for "several, as many as fit".
        part: the part of a place that is meant ("drawer"), where one is named.
        least_parts: how many of these the place has at least.
    """

    text: str
    lemmas: tuple[str, ...]
    colour: str | None
    count: int | None
    part: str | None = None
    least_parts: int = 0

    @property
    def head(self) -> str:
        return self.lemmas[-1]


def parse_phrase(text: str) -> Phrase | None:
    """Read one noun phrase; ``None`` when it holds no word that carries meaning."""
    numbers: list[int | None] = []
    content: list[str] = []
    counted: str | None = None
    for word, compound in _words(text):
        if not compound and _is_number(word):
            numbers.append(NUMBERS[word] if word in NUMBERS else int(word))
        elif word == "of" and content and counted is None:
            counted = content[-1]
        elif word not in DETERMINERS:
            content.append(word)
    if not content:
        return None
    *qualifiers, head = content
    kept = (*(lemma(word) for word in qualifiers if word not in COLOURS), lemma(head))
    count = _count(numbers, counted or head, kept[-1])
    return Phrase(" ".join(content), kept, colour_of(" ".join(qualifiers)), count)


def _count(numbers: Sequence[int | None], counted: str, head: str) -> int | None:
    """How many things a phrase asks for; None for several.

    Args:
        numbers: the numbers that it names.
        counted: what they count: 'slices' in 'two slices of toast'.
        head: lemma of what these are: 'toast'.
    """
    if not numbers:
        return None if is_plural(counted) or head in MASS_KINDS else 1
    count = functools.reduce(_with_number, numbers, None)
    return None if count == 1 and is_plural(counted) else count


def _is_number(word: str) -> bool:
    return word in NUMBERS or word.isdigit()


def _words(text: str) -> list[tuple[str, bool]]:
    """Words, each with whether it is bound to a noun by a hyphen: 'three-drawer', against 'twenty-five'."""
    found = []
    for chunk in text.lower().split():
        words = tokens(chunk)
        compound = len(words) > 1 and not all(map(_is_number, words))
        found += [(word, compound) for word in words]
    return found


def _with_number(before: int | None, value: int | None) -> int | None:
    """The number that two words name: 'two dozen', 'twenty-five', 'a hundred'; else the latter rules."""
    if not before or not value:
        return value
    if value in (12, 100, 1000):
        return before * value
    return before + value if value < 10 and before % 10 == 0 and before >= 20 else value


def parse_phrases(text: str) -> tuple[Phrase, ...]:
    """Phrases joined by commas and 'and'; a bare colour takes the head of the next phrase."""
    parts = [parse_phrase(part) for part in re.split(r",|\band\b|&|\bas well as\b|\bplus\b", text)]
    found: list[Phrase] = []
    for part in reversed([p for p in parts if p is not None]):
        if found and part.head in COLOURS:
            following = found[-1]
            single = following.count is None or part.count == 1
            if single and following.colour and following.count is None:
                found[-1] = replace(following, count=1)
            part = replace(
                part, text=f"{part.text} {following.head}", lemmas=following.lemmas, colour=colour_of(part.head)
            )
        found.append(part)
    return tuple(reversed(found))


def parse_place(text: str, before: Phrase | None = None) -> Phrase | None:
    """Read a place: 'the bowl', 'the top drawer of the cabinet', 'the third drawer'.

    Args:
        before: the place that was named last, whose part 'its drawer' is.
    """
    part_text, of, owner_text = text.partition(" of ")
    part = parse_phrase(part_text if of else text)
    if part is None or part.head not in PARTS:
        whole = parse_phrase(text)
        return replace(whole, count=1) if whole is not None else None
    words = tokens(part_text if of else text)
    least = max([_LEAST_PARTS.get(word, 1) for word in words] + [2 if is_plural(words[-1]) else 1])
    owner = parse_phrase(owner_text) if of else before if "its" in words else None
    if owner is None:
        kept = tuple(word for word in part.lemmas[:-1] if word not in _LEAST_PARTS)
        owner = replace(part, lemmas=(*kept, part.head))
    return replace(owner, count=1, part=part.head, least_parts=max(least, owner.least_parts))


def is_pronoun(text: str) -> bool:
    """Whether the text only points back at things: 'them', 'both of them'."""
    words = [word for word in tokens(text) if word not in ("of", "the", "each")]
    return bool(words) and all(word in _PRONOUNS for word in words)


def points_back(text: str) -> bool:
    """Whether the text only points back at a place: 'there', 'the same place'."""
    words = [word for word in tokens(text) if word not in ("the", "place", "too")]
    return bool(words) and all(word in _BACK for word in words)
