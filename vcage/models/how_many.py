"""The check that the goals of a reading are about as many things as the instruction says."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace

from vcage.base.words import COLOURS, COUNTED, NO_PLURAL, colour_of
from vcage.models.checked_reading import CheckedReading
from vcage.models.phrases import compiled, phrase
from vcage.models.which_one import coloured, meant
from vcage.objects.mentions import Noun, stated_count

MANY = frozenset(("each", "every", "all", "everything", "both", "another", "other", "others", "rest", "more", "any"))
"""Words by which "a mug" may be several."""
_ORDINALS = frozenset(((), *((word,) for word in COUNTED)))
"""Ends of names that are not counted: "the second"."""
_ALONE = compiled(
    phrase(
        "<both|two|three|four|five>",
        before="(of them|of these|of those|in*|on*|to*|go*|,|.|;|:|!|?)",
        or_end=True,
        not_after="of / of the",
    )
)
"""Numbers without a noun."""
_ELIDED = re.compile(r"(?<!\S)(?P<number>\w+) (?P<colour>\w+) (?:and|,|, and)(?: the)?$")
"""A number and a colour that lean on the noun after them."""


def miscounted(read: CheckedReading) -> Iterator[str]:
    """Number words that differ from the number of objects of that name in the reading."""
    subjects, words = {goal.subject for goal in read.goals}, read.task.text.split(" ")
    times = Counter(_names(read.said) if MANY.isdisjoint(words) else ())
    yield from _too_few(read)
    for noun in (one for one in read.said if one.name[-1:] not in _ORDINALS):
        elided = list(_elided(words, noun))
        number = sum(_number(words, one) for one in (*elided, noun))
        there, moved = (len(meant(noun, read.things, names)) for names in (read.spoken, subjects))
        if there < number:
            yield f"{noun.words!r} asks for {number}, but the goals speak of {there}"
        elif moved > number > 0 and times[noun.name] == 1:
            yield f"{noun.words!r} asks for {number}, but goals are given for {moved}"
        yield from _miscounted_colours(read, words, [*elided, noun], times[noun.name]) if elided else ()


def _miscounted_colours(read: CheckedReading, words: Sequence[str], nouns: Sequence[Noun], times: int) -> Iterator[str]:
    """Numbers of several colours that share a noun, said so many times, and differ from the objects of the colour."""
    subjects = {goal.subject for goal in read.goals}
    for noun in nouns:
        asked = _number(words, noun)
        there, moved = (len({*coloured(noun, read.things)} & names) for names in (read.spoken, subjects))
        if there < asked or (moved > asked and times == 1):
            yield f"{noun.words!r} asks for {asked}, but goals are given for {moved}"


def _names(said: Sequence[Noun]) -> Iterator[tuple[str, ...]]:
    """The names of the nouns: of "a blue one" after "two red blocks" it may be that of the blocks."""
    for at, noun in enumerate(said):
        yield from [noun.name] if noun.name else {one.name for one in said[:at] if one.colours}


def _elided(words: Sequence[str], noun: Noun) -> Iterator[Noun]:
    """The nouns before one whose name they share: "two red" in "two red and three blue blocks"."""
    end = noun.at
    while noun.number is not None and noun.colours and (found := _ELIDED.search(" ".join(words[:end]))):
        number, colour = found["number"], found["colour"]
        count = stated_count(number)
        if count is None or colour not in COLOURS:
            return
        yield replace(noun, words=f"{number} {colour}", colours=(str(colour_of(colour)),), number=count)
        end -= len(found[0].split(" "))


def _too_few(read: CheckedReading) -> Iterator[str]:
    """Numbers without a noun that are larger than the number of things or places of the goals."""
    subjects, references = {(g.subject, g.part) for g in read.goals}, {(g.reference, g.part) for g in read.goals}
    most = max(len(subjects), len(references))
    for word in _ALONE.findall(read.task.text):
        if most < (stated_count(word) or 0):
            yield f"{word!r} is said, but the goals are about {most}"


def _number(words: Sequence[str], noun: Noun) -> int:
    """The number that a noun asks for, or 0: 2 of "a pair of mugs", but not of "a pair of scissors"."""
    before = [word for word in words[max(noun.at - 3, 0) : noun.at] if word not in ("of", "the")]
    pair = before[-1:] in (["pair"], ["couple"]) and noun.name[-1] not in NO_PLURAL
    return noun.number or (2 if pair else 0)
