"""The request of an instruction, apart from exceptions, alternatives and retractions.

An aside ends at its noun, so that the rest of the sentence is still checked: "put the apple, not the pear, in
the bowl" becomes "put the apple in the bowl".
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace

from vcage.base.words import COLOURS, marked_tokens
from vcage.models.phrases import compiled, group, phrase
from vcage.objects.mentions import Noun, nouns
from vcage.schema.asset import CatalogueEntry

_TAKEN_BACK = compiled(
    phrase("(wait|i mean|meant|oops|scratch that|scratch|correction|nothing|hang on|or rather)"),
    phrase("sorry", not_before="(to|for|about)"),
    phrase("actually", not_after="not"),
    phrase("instead", not_before="of"),
    phrase("no", before="(#|the|a|an|not|that|it|i|make|put|on|in|into|to)"),
)
"""Words by which a speaker changes the sentence; it is open how much of what was said before still stands."""
_UNLESS = compiled(phrase("(unless|otherwise)"))
_MOVED = "put*|mov*|touch*|tak*|pick*|us*|disturb*|add*|plac*|includ*|bring*|grab*"
_NEVER = "(don't|do not|never|mustn't|must not|shouldn't|should not|without)"
_ASIDE = compiled(
    group(
        "state",
        phrase("(is|are|was|were|be|that's|it's|they're) not"),
        phrase("(isn't|aren't|wasn't|weren't)"),
        phrase("(doesn't|didn't|does not|did not) _"),
        phrase(f"{_NEVER} !({_MOVED}|forget*|worry*|mind*|hesitate*|you|we|the|a|an|any)"),
    ),
    group("but", phrase("(but|bar|save) for"), phrase("(but|bar|save)", not_before="not")),
    group(
        "list",
        phrase("(except|excepting) [for]"),
        phrase("(with the exception of|apart from|other than|excluding|neither|never mind)"),
    ),
    group("kept", phrase("(leave|leaving)"), phrase(f"{_NEVER} ({_MOVED})")),
    phrase("(without|instead of|rather than|skip|skipping)"),
    phrase("no", before="*s"),
    phrase("not", not_after="if / or / why", not_before="only"),
)
"""Beginnings of asides: what is not so, or not done; what is left out; what stays where it is."""
_ALL = compiled(phrase("(all|every|everything|anything|each|any)"))
_CLAUSE = re.compile(rf"{_ALL.pattern}.* (?:go|goes|in|into|on|onto)\b")
_GOES = compiled(phrase("(go|goes|should|must|belong|belongs|has|need|needs)"))
_LEFT_ALONE = re.compile(r"(?:is |are |it |they |be )*(?:alone|where|out|be|as|untouched|there|behind|in peace)\b")
_LATER = re.compile(r"until\b|till\b|before\b|, (?:which|that|it|those|they|he|she)\b")
"""Words after an aside that say when or where its things are used after all."""
_MAX_GAP_WORDS = 3
"""Words between an aside's first word and its noun."""
_PREPOSITIONS = frozenset(("in", "into", "on", "onto", "to", "from", "off", "inside"))
_TO = compiled(phrase("(in|into|on|onto|inside|to|next to|behind|beside|near) [the|a|an|my|your|any]"))


@dataclass(frozen=True)
class AskedPart:
    """An instruction without its asides, whose words give way to commas.

    Args:
        whole: all words and marks.
        text: the words that need an answer.
        open_text: the same with the alternatives to choose from: "the apple or the pear".
        excluded: nouns of objects not to use.
        kept: nouns of objects not to move, with the forbidden place if named.
    """

    whole: str
    text: str
    open_text: str
    excluded: tuple[Noun, ...] = ()
    kept: tuple[tuple[Noun, Noun | None], ...] = ()


def asked_part(instruction: str, entries: Collection[CatalogueEntry]) -> AskedPart:
    """Leave out the asides of an instruction; at a retraction, also everything before it.

    Args:
        instruction: in English.
        entries: kinds that its nouns may name.
    """
    words = marked_tokens(instruction.replace("’", "'"))
    whole = " ".join(words)
    if _UNLESS.search(whole):
        return AskedPart(whole, "", whole)
    said = nouns(whole, entries)
    out, places = set[int](), _alternatives(words, said)
    for found in _TAKEN_BACK.finditer(whole):
        places |= {*range(whole.count(" ", 0, found.end()) + 1)}
    excluded, kept = list[Noun](), list[tuple[Noun, Noun | None]]()
    for found, begin, last, named in _asides(whole, words, said):
        out |= {*range(begin, last)}
        if _is_used(found, " ".join(words[last : last + 3])):
            continue
        if found["kept"]:
            place = next((noun for noun in said if _TO.fullmatch(" ".join(words[last : noun.at]))), None)
            places |= {*range(last, place.end if place else last)}
            kept += [(noun, place) for noun in named]
        else:
            excluded += named
    return AskedPart(whole, _without(words, out | places), _without(words, out), tuple(excluded), tuple(kept))


def _asides(whole: str, words: list[str], said: list[Noun]) -> Iterator[tuple[re.Match[str], int, int, list[Noun]]]:
    """The beginning of each aside, the places of its first word and of that after its last, and its nouns."""
    last = 0
    for found in _ASIDE.finditer(whole):
        begin, end = (whole.count(" ", 0, place) for place in found.span())
        if begin < last:
            continue
        named = list(_named(words, end + 1, said, found))
        until = named[-1].end if named else _next_mark(words, end + 1)
        if not _adds(found, whole[: found.start()], " ".join(words[until : until + 3])):
            last = until
            yield found, begin, last, named


def _is_used(found: re.Match[str], after: str) -> bool:
    """Check if the object of an aside is used after all: only its state is given, or when and where it is used."""
    left = found[0].startswith("leav") and not _LEFT_ALONE.match(after)
    return bool(left or found["state"] or _LATER.match(after))


def _without(words: list[str], out: Collection[int]) -> str:
    return " ".join("," if at in out else word for at, word in enumerate(words))


def _adds(found: re.Match[str], before: str, after: str) -> bool:
    """Check if "but" begins a clause of its own: "all cups go in the box, but the plate goes on the tray"."""
    own = not _ALL.search(before) or (_GOES.match(after) and _CLAUSE.search(before))
    return bool(found["but"] and own)


def _next_mark(words: list[str], at: int) -> int:
    """Place of the mark that ends a short phrase without a noun; the place itself where none is near."""
    return next(
        (place for place in range(at, min(at + _MAX_GAP_WORDS + 2, len(words))) if not words[place].isalnum()), at
    )


def _named(words: list[str], at: int, said: list[Noun], found: re.Match[str]) -> Iterator[Noun]:
    """The noun after the beginning of an aside and the nouns joined to it; "one" takes the name of the noun before.

    Args:
        words: of the sentence.
        at: place of the word after the beginning.
        said: nouns of the sentence.
        found: the beginning.
    """
    joints = {"or", "nor", "and"} if found["list"] else {"or", "nor"}
    prepositions = _PREPOSITIONS if found[0] != "not" else frozenset[str]()
    for before, noun in itertools.pairwise([Noun("", ()), *said]):
        between = words[at : noun.at]
        fits = len(between) <= _MAX_GAP_WORDS and " ".join(["a", *between]).replace(" ", "").isalpha()
        if noun.at < at or not fits or prepositions.intersection(between):
            continue
        yield noun if noun.name else replace(noun, name=before.name)
        at = noun.end
        if joints.isdisjoint(words[at : at + 1]):
            return


def _alternatives(words: list[str], said: list[Noun]) -> set[int]:
    """Places of the words that name alternatives."""
    found = set[int]()
    for before, after in itertools.pairwise([Noun("", ()), *said]):
        between = words[before.end : after.at]
        if "or" in between and words[before.end + between.index("or") - 1] in COLOURS:
            found |= {*range(before.end + between.index("or") - 1, after.end)}  # the red or the green mug
        elif "or" in between and len(between) <= _MAX_GAP_WORDS + 1:
            found |= {*range(before.at, after.end)}
    return found
