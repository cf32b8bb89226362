"""Reads an imperative sentence: which things are moved, where to, and how many of each."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from vcage.models.offline.words import COLOURS, DETERMINERS, KINDS, NUMBERS, colour_of, is_plural, lemma, tokens

SEVERAL = 3
"""How many things a plural without a number means."""

_INTO = ("on top of", "inside of", "into", "inside", "onto", "upon", "in", "on", "to", "beside", "near", "next to")
_FROM = ("from", "off", "out of", "with", "for", "using", "so that", "at", "by")
_PREPOSITION = re.compile(r"\b(" + "|".join(sorted(_INTO + _FROM, key=len, reverse=True)) + r")\b")
_CLAUSE = re.compile(
    r"[.;!?]|,?\s*\b(?:and then|then|afterwards|finally)\b|\band\b(?=\s+(?:put|place|pack|set|move|drop)\b)"
)
_PARTICLES = frozenset(
    ["please", "away", "up", "down", "together", "back", "carefully", "neatly", "can", "could", "you"]
)
_SURFACES = frozenset(("table", "desk", "tabletop", "worktop", "counter"))


@dataclass(frozen=True)
class Phrase:
    """A noun phrase.

    Args:
        text: as written, without articles.
        lemmas: words without numbers, articles and (unless it is the head) colours; the head is last.
        colour: the colour that is asked for.
        count: how many things; ``None`` for "several, as many as fit".
    """

    text: str
    lemmas: tuple[str, ...]
    colour: str | None
    count: int | None

    @property
    def head(self) -> str:
        return self.lemmas[-1]


@dataclass(frozen=True)
class Request:
    """One clause: ``contents`` go to ``receptacle`` (none when no place is named, or it is the table itself)."""

    verb: str
    contents: tuple[Phrase, ...]
    receptacle: Phrase | None


def parse_phrase(text: str) -> Phrase | None:
    """Read one noun phrase; ``None`` when it holds no word that carries meaning."""
    words = [word for word in tokens(text) if word not in DETERMINERS]
    count: int | None = 1
    counted = False
    content = []
    for word in words:
        if word in NUMBERS or word.isdigit():
            value = int(word) if word.isdigit() else NUMBERS[word]
            count, counted = _with_number(count if counted else None, value), True
        else:
            content.append(word)
    if not content:
        return None
    head = content[-1]
    if not counted and (is_plural(head) or lemma(head) in KINDS):
        count = None
    if counted and count == 1 and is_plural(head):
        count = None
    colours = [word for word in content[:-1] if word in COLOURS]
    kept = [lemma(word) for word in content[:-1] if word not in COLOURS] + [lemma(head)]
    return Phrase(" ".join(content), tuple(kept), colour_of(colours[0]) if colours else None, count)


def _with_number(before: int | None, value: int | None) -> int | None:
    """The number that two words name: 'two dozen', 'twenty-five', 'a hundred'; else the latter rules."""
    if not before or not value:
        return value
    if value in (12, 100, 1000):
        return before * value
    return before + value if value < 10 and before % 10 == 0 and before >= 20 else value


def _phrases(text: str) -> tuple[Phrase, ...]:
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


def _clause(text: str) -> list[Request]:
    """The requests of one clause: 'the apple in the bowl and the pen in the box' are two with one verb."""
    words = [word for word in re.sub(r"[^\w\s,&'-]", " ", text.lower()).split() if word not in _PARTICLES]
    if not words:
        return []
    verb, rest = words[0].strip(","), " ".join(words[1:])
    pieces = _PREPOSITION.split(rest)
    contents = _phrases(pieces[0])
    found = []
    for preposition, piece in zip(pieces[1::2], pieces[2::2], strict=True):
        targets = _phrases(piece) if preposition in _INTO else ()
        if not targets or not contents:
            continue
        on_table = targets[0].head in _SURFACES and preposition in ("on", "onto")
        found.append(Request(verb, contents, None if on_table else replace(targets[0], count=1)))
        contents = targets[1:]
    return found + ([Request(verb, contents, None)] if contents else [])


def parse_instruction(instruction: str) -> list[Request]:
    """The clauses of an instruction that ask for something to be moved, in order."""
    return [request for clause in _CLAUSE.split(instruction) if clause for request in _clause(clause)]
