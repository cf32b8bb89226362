"""A typed sentence in the form that the grammar reads: in lower case and without courtesies."""

from __future__ import annotations

import re

from vcage.base.words import COLOURS, DETERMINERS, FUNCTION_WORDS, NUMBERS, is_plural, tokens
from vcage.models.rules.grammar import LIMITS, not_read

_BEFORE_NAMES = {*DETERMINERS, *NUMBERS, *COLOURS} - {"orange", "one", "other"}
_OF_NO_NAME = "".join(rf"(?<!\b{word} )" for word in sorted(_BEFORE_NAMES))
"""Before a word that is no part of a name: "the partly eaten apple" and "the fast food" are names."""
_NAME_ENDS = (
    r"(?= *(?:[,.;!?]|$)| (?:and|then|but|in|into|on|onto|to|inside|next|beside|behind|near|from|out|off|up|away"
    r"|with|using|please|as)\b)"
)
_COLOUR = "|".join(sorted(COLOURS))
IN_NO_HOLE = "nothing is in a hole at the start; leave out where it is, and it lies on the table"
"""Why a peg is not taken out of a hole."""
REFUSED = {
    r"head-up|horizontally": "no goal says which way up a thing is held",
    r"some of": "nobody can tell which of them; say how many, or which",
    rf"{_OF_NO_NAME}(slightly(?! away)|half[ -]?way|part[ -]?way|all the way|(a bit|a lot)(?! of)|twice"
    "|partly|partially|fully|completely|entirely|totally|thoroughly|vigorously|firmly|softly"
    "|slowly|quickly|rapidly|swiftly|hastily|immediately|instantly|in a hurry"
    f"|(a little|quick|quicker|fast|faster|slow|slower|hard|harder){_NAME_ENDS})":
        "no goal says how far, how often, how hard or how fast something is done",
    r"(every|each) (?:(?!and )[^,.;])* (in|on|into|onto|to) its":
        "no goal says that each thing has a place of its own; name the places",
    r"sorry|i mean|or rather|no wait": "a correction is not read; say only what is meant",
    r"(by )?(\d+|ninety|forty-five)(?= ?°| degrees)|(a )?(half|quarter) turn|upside down":
        "no goal says by which angle a thing is turned",
    r"[4-9]\d|\d{3,}": "no table holds so many; ask for 1 to 39",
    r"(corner|edge) of the (table|desk)": "this place of the table is none that a goal can name",
    rf"pegs? (that|which)('s| is| are) in(side)?( of)? (the |a |its )?(({_COLOUR}|peg|wooden) )*(block|hole)":
        IN_NO_HOLE,
    r"under(neath)?|below|beneath": "what is under a thing is no place that a goal can name",
}  # fmt: skip
"""Words that no goal of the vocabulary can keep, and why."""

_POLITE = re.compile(
    r"\b(please|pls|kindly|(very )?(carefully|gently)|again|thanks|thank you|cheers|ta|for me|as well|now|just|hey"
    r"|(?<!the )robot|directly|slightly(?= away)|straight|somewhere)\b"
    r"|[,;]? (i do(n't| not) (mind|care)|it does(n't| not) matter) which( one)?\b"
    r"|[,;]? (whichever you like|any will do)\b"
    r"|\bcent(er|re) of the top( side)?(?= \w)"
    r"|\b(that|which)('s| is)(?= (on|in|inside|at|next to|beside|behind|near|to the) )"
    r"|\bfirst\b(?=,? *(and )?then)|\b(would|could|will|can) you(?= *$)"
    r"|((?<=[.,;] )|^)(((could|can|would|will) you( mind)?|i('d| would) like you to|i (want|need) you to"
    r"|i was wondering if you could|i('d| would) be grateful if you('d| would| could)|let's|first( of all)?,?)\b)"
)
_ENDS = re.compile(r"[ ,.;]+$|^[ ,.;]+")
_ASKS_TO_DO = re.compile(r"^(.*\b(could|can|would|will) you\b.*)\?(?= *$)")
_TWO_COLOURED = re.compile(rf"\b({_COLOUR}) and ({_COLOUR})(?= (?P<name>[a-z]+))")
_FALLEN_OVER = re.compile(r"\b(?<!has )(?<!have )(?<!been )(fallen|toppled|tipped|knocked) over(?= (?!up\b)[a-z])")
_NOT_READ = re.compile(r"[^a-z0-9 ,.;'-]")


def _joined(found: re.Match[str]) -> str:
    """A two-coloured look as one word: "the yellow and white mug"; "the red and blue blocks" are of two looks."""
    no_name = found["name"] in FUNCTION_WORDS - {"can"}  # "in the order of red, green and blue from left to right"
    return found[0] if no_name or is_plural(found["name"]) else found[0].replace(" ", "-")


def plain_text(typed: str) -> str:
    """The sentence in the grammar's form: of the same length, so that places in it are preserved.

    Args:
        typed: the sentence, with one blank between two words.

    Raises:
        UnreadInstruction: it is too long, or has words that no goal can keep, or signs that are not read.
    """
    count = len(tokens(typed))
    if not 0 < count <= LIMITS.words:
        raise not_read(typed, typed[:60], f"it has {count} words; 1 to {LIMITS.words} are read")
    text = re.sub(r"(?<=\w)[_/](?=\w)|[\"“”]", " ", typed.replace("’", "'")).lower()
    for words, why in REFUSED.items():
        if found := re.search(rf"\b({words})\b", text):
            raise not_read(typed, found[0], why)
    text = re.sub(r" - ", " ; ", _ASKS_TO_DO.sub(r"\1 ", text).replace("!", ".").replace(":", ";"))
    for blank in (_POLITE, _ENDS):
        text = blank.sub(lambda found: " " * len(found[0]), text)
    text = _FALLEN_OVER.sub(r"\1-over", _TWO_COLOURED.sub(_joined, text))
    odd = _NOT_READ.search(text)
    if odd or len(text) != len(typed):
        raise not_read(typed, word_at(typed, odd.start() if odd else 0), "it is no plain statement in English")
    return text


def word_at(typed: str, at: int) -> str:
    """The word of a typed sentence that begins at a place, without the signs around it."""
    rest = re.match(r"\S+", typed[at:].lstrip())
    return rest[0].strip(",.;") or rest[0] if rest else f"the end after {typed.split()[-1]!r}"
