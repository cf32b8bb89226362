"""Universal quantifiers of an instruction: which objects fall under "everything" or "all the pens".

The check knows no grammar, so it holds for every reader: a person, a language model, the rules.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from vcage.base.text import listed
from vcage.base.words import COLOURS, NUMBERS, PARTS, colour_of, lemma, marked_tokens, tokens
from vcage.models.checked_reading import CheckedReading
from vcage.models.phrases import compiled, phrase
from vcage.objects.names import head_may_mean, names_of
from vcage.schema.asset import CatalogueEntry

_EVERYTHING = frozenset(("everything", "anything", "whatever"))
_EVERY = frozenset(("all", "every", "each", "rest", "remaining"))
_DEFINITE_QUANTIFIERS = frozenset(("all", "every", "each"))
"""Without a noun these mean what was named before: "the cups and the plates, put them all away"."""
_MAX_BEGINNING_WORDS = 2
"""Words that may stand before such a word where nothing was named: "please put all"."""
_FIXED = compiled(phrase("(first of all|above all|after all|at all|all right|all done|each other|all the way)"))
"""Phrases in which such a word is no quantifier."""
_CONTENTS = compiled(
    phrase(
        "(pour*|empt*|tip*|dump*) [out|over] (everything|anything|all|whatever) [that|that's] [is]"
        " (in|inside|from|out of)",
        before="[_] [_] [_] _ (in|into)",
    )
)
"""Phrases in which it means the contents of a thing: "pour everything in the cup into the bowl"."""
_BEFORE_THE_NOUN = frozenset(("of", "the", "my", "your", "our", "these", "those", "them", "single", "last", *NUMBERS))
_ENDS_THE_NOUN = frozenset(
    word
    for words in (
        "in on into onto to from with inside beside next near at under behind by after before over around off out up",
        "and then but or except that which you there here else away back it one left right separately please for",
        "go goes going is are belong belongs should must has have needs need gets get",
    )
    for word in words.split()
)
_NOTHING = compiled(phrase("(without|not|never|*n't|before|near|than|if) [_] [_] (any|anything) [else]"))
"""Phrases in which "any" is no quantifier of what is asked for: "without touching anything else"."""
_EXCEPT = compiled(
    phrase("(except|exception of|but|bar|apart from|other than|excluding|save|without|isn't|aren't|not)")
)


@dataclass(frozen=True)
class Quantified:
    """A universal quantifier and its range.

    Args:
        words: as in the instruction: "all the red pens".
        noun: lemmas of the noun, the head last; empty for everything in the scene.
        colour: the requested one, if any.
    """

    words: str
    noun: tuple[str, ...]
    colour: str | None

    def covers(self, entry: CatalogueEntry) -> bool:
        """Check if an object of this kind falls under it.

        Args:
            entry: of the catalogue; with the object's own look only, or with all that it may have.
        """
        if self.colour is not None and all(self.colour != colour_of(v.colour) for v in entry.variants):
            return False
        return not self.noun or head_may_mean(self.noun[-1], entry)


def quantified(instruction: str) -> list[Quantified]:
    """The universal quantifiers of an instruction, in its order."""
    text = instruction.lower()
    for phrases in (_FIXED, _CONTENTS, _NOTHING):
        text = phrases.sub(" , ", text)
    words, found = marked_tokens(text), list[Quantified]()
    for at, word in enumerate(words):
        if word in _EVERYTHING or word in _EVERY:
            one = _quantified(words, at)
            of_parts = PARTS.intersection(one.noun)
            if not of_parts and (
                one.noun or one.colour or word not in _DEFINITE_QUANTIFIERS or at <= _MAX_BEGINNING_WORDS
            ):
                found.append(one)
    return found


def _noun_after(words: list[str], at: int) -> tuple[int, int]:
    """Begin and end of the words between a quantifier and what ends its noun, without articles and numbers."""
    begun = at + 1
    while begun < len(words) and words[at] in _EVERY and (words[begun] in _BEFORE_THE_NOUN or words[begun].isdigit()):
        begun += 1
    end = begun
    while end < len(words) and words[end].isalpha() and words[end] not in _ENDS_THE_NOUN:
        end += 1
    return begun, end


def _quantified(words: list[str], at: int) -> Quantified:
    begun, end = _noun_after(words, at)
    said = words[begun:end] or _attribute(words, end)
    noun = tuple(lemma(word) for word in said if word not in COLOURS)
    if words[at] in _EVERYTHING and words[begun:end]:  # "everything blue", "everything on the desk"
        noun = ()
    return Quantified(" ".join(words[at:end]), noun, colour_of(" ".join(said)))


def _attribute(words: list[str], at: int) -> list[str]:
    """The adjective or noun of "everything that's yellow", "everything you can drink"."""
    text = " ".join(words[at : at + 4])
    if found := re.match(r"(?:that's|that is|that are|which is|which are) (\w+)", text):
        return [] if found[1] in _ENDS_THE_NOUN or found[1] in ("not", "still") else [found[1]]
    found = re.match(r"(?:(?:that )?you can|to|one can) (eat|drink)\b", text)
    return [] if found is None else ["food" if found[1] == "eat" else "drink"]


def _excepted(instruction: str, entry: CatalogueEntry) -> bool:
    """Check if words after "except", "but" or "isn't" name an object or its colour."""
    _, marker, rest = _EXCEPT.sub("\n", instruction.lower(), count=1).partition("\n")
    said = {lemma(word) for word in tokens(rest)}
    colours = {colour_of(variant.colour) for variant in entry.variants}
    heads = {name[-1] for name in names_of(entry).all}
    return bool(marker) and bool(said & heads or {colour_of(word) for word in said} & (colours - {None}))


def left_over(read: CheckedReading) -> Iterator[str]:
    """Complaints about objects under a quantifier of the instruction that the reading does not speak of."""
    for quantifier in quantified(read.instruction):
        missed = [name for name, entry in read.things.items() if name not in read.spoken and quantifier.covers(entry)]
        missed = [name for name in missed if not _excepted(read.instruction, read.things[name])]
        if missed:
            yield f"the instruction says {quantifier.words!r}, but no goal speaks of {listed(missed)}"
