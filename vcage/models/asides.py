"""The part of an instruction that asks for something, apart from exceptions, alternatives and what is taken back.

Nouns are what ends an aside, so that the rest of the sentence is still looked at: of "put the apple, not the pear, in
the bowl" it is "put the apple in the bowl".
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace

from vcage.base.words import marked_tokens
from vcage.objects.mentions import Noun, nouns
from vcage.schema.asset import CatalogueEntry

_TAKEN_BACK = re.compile(
    r"\b(?:sorry(?! to\b| for\b| about\b)|wait|(?<!not )actually|i mean|meant|oops|scratch|correction|unless|otherwise"
    r"|nothing|hang|or rather|[,;:] rather|instead(?! of\b)"
    r"|no(?! (?:rush|hurry|problem|worries|matter|need|doubt|longer|one|idea|particular)\b))\b"
)
"""Words by which a speaker changes the sentence: what it asks for then is a matter of grammar."""
_MOVED = r"(?:put|mov|touch|tak|pick|us|disturb|add|plac|includ|bring|grab)\w*"
_STATE = (
    r"(?:is|are|was|were|be|that's|it's|they're) not|(?:is|are|was|were)n't|(?:doesn't|didn't|does not|did not) \w+"
    rf"|(?:don't|do not|never|mustn't|must not|shouldn't|should not|without) (?!{_MOVED})"
    r"(?!forget|worry|mind|hesitate|you\b|we\b|the\b|an?\b|any\b)\w+"
)
_ASIDE = re.compile(
    rf"\b(?:(?P<state>{_STATE})|(?P<but>(?:but|bar|save)(?! not\b)(?: for)?)"
    r"|(?P<list>except(?:ing)?(?: for)?|with the exception of|apart from|other than|excluding|neither|never mind)"
    rf"|(?P<kept>leav(?:e|ing)|(?:don't|do not|never|mustn't|must not|shouldn't|should not|without) {_MOVED})"
    r"|without|instead of|rather than|skip(?:ping)?|(?<!if )(?<!or )(?<!why )not(?! only\b))(?!\w)"
)
"""Beginnings of asides: what is not so, or not done; what is left out; what stays where it is."""
_ALL = re.compile(
    r"\b(?:all|every|everything|anything|each|any)\b(?!.*\b(?:go|goes|in|into|on|onto)\b.* (?:but|bar|save)$)"
)
_LEFT_ALONE = re.compile(r"(?:is |are |it |they |be )*(?:alone|where|out|be|as|untouched|there|behind|in peace)\b")
_LATER = re.compile(r"until\b|till\b|before\b|, (?:which|that|it|those|they|he|she)\b")
"""Words after an aside that say when or where its things are used after all."""
_GAP = 3
"""Words between an aside's first word and the noun that it is about."""
_JOINTS = frozenset(("or", "nor", "and"))


@dataclass(frozen=True)
class Asked:
    """An instruction without its asides.

    Args:
        text: what must be answered.
        open_text: the same with the things of which one is to be chosen: "the apple or the pear".
        excluded: nouns for what is not to be used.
        kept: nouns for what is not to be moved.
    """

    text: str
    open_text: str
    excluded: tuple[Noun, ...] = ()
    kept: tuple[Noun, ...] = ()


def asked_part(instruction: str, entries: Collection[CatalogueEntry]) -> Asked:
    """Leave out the asides of an instruction; of one that takes something back no words must be answered.

    Args:
        instruction: in English.
        entries: kinds that its nouns may name.
    """
    words = marked_tokens(instruction.replace("’", "'"))
    text = " ".join(words)
    if _TAKEN_BACK.search(text):
        return Asked("", text)
    said = nouns(text, entries)
    out, excluded, kept = set[int](), list[Noun](), list[Noun]()
    for found in _ASIDE.finditer(text):
        begin, end = (text[:place].count(" ") for place in found.span())
        if begin in out or (found["but"] and not _ALL.search(text[: found.end()])):
            continue
        named = list(_named(words, end + 1, said, _JOINTS if found["list"] else _JOINTS - {"and"}))
        last = max((noun.end for noun in named), default=_next_mark(words, end + 1))
        out |= {*range(begin, last)}
        after = " ".join(words[last : last + 3])
        if found["state"] or _LATER.match(after) or (found[0].startswith("leav") and not _LEFT_ALONE.match(after)):
            continue
        (kept if found["kept"] else excluded).extend(named)
    chosen = _alternatives(words, said)
    open_text = " ".join("," if at in out else word for at, word in enumerate(words))
    rest = " ".join("," if at in out | chosen else word for at, word in enumerate(words))
    return Asked(rest, open_text, tuple(excluded), tuple(kept))


def _next_mark(words: list[str], at: int) -> int:
    """Place of the mark that ends a short phrase which names nothing; the place itself where none is near."""
    return next((place for place in range(at, min(at + _GAP + 2, len(words))) if not words[place].isalnum()), at)


def _named(words: list[str], at: int, said: list[Noun], joints: frozenset[str]) -> Iterator[Noun]:
    """The noun after a place and those that are joined to it; "one" is named after the noun before."""
    for number, noun in enumerate(said):
        between = words[at : noun.at]
        if noun.at < at or len(between) > _GAP or not all(word.isalpha() or word in joints for word in between):
            continue
        yield noun if noun.name or not number else replace(noun, name=said[number - 1].name)
        at = noun.end
        if not joints.intersection(words[at : at + 1]):
            return


def _alternatives(words: list[str], said: list[Noun]) -> set[int]:
    """Places of the words of which one is to be chosen."""
    found = set[int]()
    for before, after in itertools.pairwise(said):
        between = words[before.end : after.at]
        if "or" in between and len(between) <= _GAP + 1:
            found |= {*range(before.at, after.end)}
    return found
