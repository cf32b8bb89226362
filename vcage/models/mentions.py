"""What an instruction mentions, found without a grammar: nouns that name kinds of objects, their colours and numbers.

It serves checks that must not object to a sentence that was read right: where a word may be something else, it is
passed over.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from vcage.base.words import (
    CATEGORIES,
    COLOURS,
    DETERMINERS,
    KINDS,
    NUMBERS,
    PARTS,
    colour_of,
    lemma,
    lemmas,
    same_word,
    tokens,
)
from vcage.models.english import AFTER_A_NOUN, ASIDE, FUNCTION_WORDS, VERBS
from vcage.objects.names import is_of_kind, names_of
from vcage.schema.asset import CatalogueEntry

_LATIN = re.compile(r"[^\W\d_]")
_ADJECTIVES_BEFORE = 4
_LONGEST_NAME = 5
_WORD = re.compile(r"[a-z0-9]+(?:'[a-z]+)?|[,.;:!?()]")

_ALIKE = (
    {"grey", "silver"},
    {"gold", "yellow"},
    {"beige", "cream", "tan", "brown"},
    {"teal", "turquoise", "cyan"},
    {"navy", "blue"},
    {"pink", "magenta", "purple"},
)
"""Colours that people take for one another."""


@dataclass(frozen=True)
class Mention:
    """A noun of an instruction that names objects.

    Args:
        words: as in the instruction: "two red mugs".
        noun: its lemmas, the head last; empty for "one" and "ones".
        colours: that are said of it.
        number: how many are said, None where it is not said.
    """

    words: str
    noun: tuple[str, ...]
    colours: tuple[str, ...] = ()
    number: int | None = None

    def names(self, entry: CatalogueEntry) -> bool:
        """Check if an object of this kind may be called so, its colour aside."""
        if not self.noun:
            return True
        names, noun, head = names_of(entry), list(self.noun), self.noun[-1]
        split = "".join(map(lemma, tokens(self.words)[-2:]))  # "sauce pan"
        if any(_same(name, noun) or name == [split] for name in names.all):
            return True
        if len(noun) == 1:
            return any(same_word(head, name[-1]) for name in names.all) or is_of_kind(head, entry, names)
        said = [word for text in _texts(entry) for word in lemmas(text)]
        rest = all(any(_akin(word, other) for other in said) for word in noun[:-1])
        return rest and any(same_word(head, name[-1]) for name in names.all)


def is_plain(instruction: str) -> bool:
    """Check if an instruction names only what it asks for: it takes nothing back and leaves nothing out."""
    return not any(word in ASIDE or word.endswith("n't") for word in tokens(instruction))


def in_english(instruction: str, entries: Iterable[CatalogueEntry]) -> bool:
    """Check if at least half of the words are known to be English; of another language no words are checked."""
    letters = _LATIN.findall(instruction)
    if sum(letter.isascii() for letter in letters) < len(letters) * 0.9:
        return False
    named = {word for entry in entries for text in _texts(entry) for word in tokens(text)}
    named |= {lemma(word) for word in named}
    known = FUNCTION_WORDS | VERBS | COLOURS | DETERMINERS | NUMBERS.keys() | PARTS | named
    said = tokens(instruction)
    return 2 * sum(word in known or lemma(word) in known for word in said) >= len(said)


def has_colour(entry: CatalogueEntry, colour: str) -> bool:
    """Check if the object's look, or its name, has the colour or one that people take for it."""
    texts = [text for v in entry.variants for text in (v.id, v.colour, v.description)] + _texts(entry)
    known = {found for text in texts for word in tokens(text) if (found := colour_of(word))}
    alike = {colour}.union(*(group for group in _ALIKE if colour in group))
    return bool(known & alike)


def mentions(instruction: str, entries: Iterable[CatalogueEntry]) -> list[Mention]:
    """The nouns of an instruction that name kinds among the entries, in its order."""
    vocabulary = _vocabulary(entries)
    words = _WORD.findall(instruction.lower().replace("_", " ").replace("-", " "))
    found, at, last = list[Mention](), 0, 0
    while at < len(words):
        end, noun = _longest(words, at, vocabulary)
        if noun is None:
            if words[at] in ("one", "ones") and at and words[at - 1] in COLOURS:
                found.append(_mention(words, at, at + 1, (), last))
            at += 1
            continue
        if not _is_something_else(words, at, end, last, vocabulary):
            found.append(_mention(words, at, end, noun, last))
        at = last = end
    return found


def _vocabulary(entries: Iterable[CatalogueEntry]) -> frozenset[tuple[str, ...]]:
    """Names of kinds, the heads of their proper names, and words for the kinds of things that they are."""
    found: set[tuple[str, ...]] = set()
    for entry in entries:
        names = names_of(entry)
        found |= {tuple(name) for name in names.all} | {(names.words[-1],), (lemma(entry.words.category),)}
    found |= {(word,) for word in (*KINDS, *CATEGORIES)}
    return frozenset(name for name in found if name[-1] not in PARTS or len(name) > 1)


def _longest(words: list[str], at: int, vocabulary: frozenset[tuple[str, ...]]) -> tuple[int, tuple[str, ...] | None]:
    """Where the longest name ends that begins at a word, and its lemmas; None without one."""
    best: tuple[int, tuple[str, ...] | None] = (at, None)
    if words[at] in DETERMINERS or words[at] in FUNCTION_WORDS - {"can"}:
        return best
    noun: tuple[str, ...] = ()
    for end in range(at, min(at + 2 * _LONGEST_NAME, len(words))):
        if not words[end][0].isalnum():
            break
        if words[end] not in DETERMINERS:
            noun = (*noun, lemma(words[end]))
            if noun in vocabulary:
                best = end + 1, noun
    return best


def _is_something_else(words: list[str], at: int, end: int, last: int, vocabulary: frozenset[tuple[str, ...]]) -> bool:
    """Check if the words may be a verb, or say what kind of another thing is meant.

    Args:
        words: of the instruction.
        at, end: of the noun.
        last: where the noun before it ends.
        vocabulary: nouns.
    """
    before, after = words[at - 1] if at else "", words[end] if end < len(words) else ""
    if last and (at == last or words[last:at] in (["of"], ["of", "the"])):
        return True  # "chips tube lid", "a tin of tomatoes"
    if end - at == 1 and _may_be_verb(words[at], before, after):
        return True
    if words[at] in COLOURS and after in ("one", "ones"):
        return True
    if (lemma(after),) in vocabulary:
        return after != "can"
    known = after in FUNCTION_WORDS or after in VERBS or after in PARTS or after in DETERMINERS or after in NUMBERS
    return after.isalpha() and not known and after not in AFTER_A_NOUN and not after.endswith(("s", "ing"))


def _may_be_verb(word: str, before: str, after: str) -> bool:
    if word == "can":
        return before not in DETERMINERS | COLOURS | NUMBERS.keys() or after in VERBS | {
            "go",
            "be",
            "you",
            "we",
            "i",
            "it",
        }
    begins = before in ("", "please", "you", "then", ",", ".", "and", "to", "kindly", "just", "yeah", "i", "we", "or")
    return begins and (
        after in DETERMINERS | NUMBERS.keys() | {"it", "them", "everything"} or word in ("tap", "present")
    )


def _mention(words: list[str], at: int, end: int, noun: tuple[str, ...], last: int) -> Mention:
    begin, colours = at, list[str]()
    while begin > max(last, at - _ADJECTIVES_BEFORE) and _describes(words, begin - 1):
        begin -= 1
        if colour := colour_of(words[begin]):
            colours.append(colour)
    number = _number(words, begin)
    begin -= number is not None and words[begin - 1] not in ("of", "the")
    return Mention(" ".join(words[begin:end]), noun, tuple(colours), number)


def _describes(words: list[str], at: int) -> bool:
    """Check if a word before a noun is an adjective of it: a colour, "and" between colours, or no word that we know."""
    if words[at] == "and":
        return at > 0 and words[at - 1] in COLOURS and words[at + 1] in COLOURS
    known = words[at] in FUNCTION_WORDS or words[at] in VERBS or words[at] in DETERMINERS or words[at] in NUMBERS
    return words[at].isalpha() and not known


def _number(words: list[str], begin: int) -> int | None:
    """How many are said before the adjectives of a noun: "two", "both of the", but not "one of the two"."""
    before = words[:begin]
    number = _count(before[-1]) if before else None
    if number is not None:
        before = before[:-1]
    while before and before[-1] in ("the", "of", "my", "your", "our", "these", "those", "last"):
        if before[-1] == "of" and len(before) > 1:
            outer = _count(before[-2])
            return outer if outer is not None or number is None else None
        before = before[:-1]
    return number


def _count(word: str) -> int | None:
    if word.isdigit():
        return int(word)
    return None if word in ("few", "several", "couple", "pair", "no", "some") else NUMBERS.get(word)


def _texts(entry: CatalogueEntry) -> list[str]:
    words = entry.words
    return [entry.name, words.name, words.plural, *words.synonyms, words.category, words.description]


def _same(name: list[str], noun: list[str]) -> bool:
    return len(name) == len(noun) and all(map(same_word, name, noun))


def _akin(word: str, other: str) -> bool:
    return same_word(word, other) or (len(word) >= 4 and len(other) >= 4 and word[:4] == other[:4])
