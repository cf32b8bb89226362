"""Find names and nouns of kinds in a sentence, without a grammar.

The nouns serve checks that must accept a sentence that was read correctly: a word that may be something else does not
count.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field

from vcage.base.words import (
    AFTER_A_NOUN,
    CATEGORIES,
    COLOURS,
    DETERMINERS,
    FUNCTION_WORDS,
    KINDS,
    MASS_KINDS,
    NUMBERS,
    PARTS,
    SIDES,
    VERBS,
    colour_of,
    is_plural,
    lemma,
    lemmas,
    marked_tokens,
    same_word,
    tokens,
)
from vcage.objects.names import Name, head_may_mean, names_of, texts_of
from vcage.schema.asset import CatalogueEntry

_ADJECTIVES_BEFORE = 4
_LONGEST_NAME = 10
"""Words of a name, with those that carry no meaning."""
NOT_NAMES = frozenset((*PARTS, *SIDES, "side", "area", "top", "all", "everything", "with"))
"""Words that name no object by themselves, though a name may end or begin with them."""
_KNOWN = FUNCTION_WORDS | VERBS | DETERMINERS | NUMBERS.keys()
"""Words that are no adjectives."""
_FOLLOWS_A_VERB = DETERMINERS - {"of"} | NUMBERS.keys() | {"it", "them", "everything"}
_BEFORE_A_COMMAND = frozenset(("", ",", ".", "and", "or", "then", "please", "to", "you"))
_FOLLOWS_CAN = VERBS | {"go", "be", "you", "we", "i", "it"}
_PHRASAL_VERBS = (("switch", "on"), ("switch", "off"))
_UPRIGHT = frozenset(("up", "upright"))
_BEFORE_A_NOUN = DETERMINERS | COLOURS | NUMBERS.keys()


@dataclass(frozen=True)
class Noun:
    """A noun of a sentence that names kinds of objects.

    Args:
        words: as in the sentence: "two red mugs".
        name: its lemmas; empty for "one" and "ones".
        colours: in its description.
        number: how many are said, None where it is not said.
        at, end: place of its words among the sentence's words and marks, the end not included.
    """

    words: str
    name: Name
    colours: tuple[str, ...] = ()
    number: int | None = None
    at: int = field(default=0, compare=False)
    end: int = field(default=0, compare=False)

    @property
    def is_several(self) -> bool:
        """True for a noun that may mean more than one object: "mugs", "two mugs", "fruit"."""
        head = tokens(self.words)[-1]
        return self.number not in (None, 1) or is_plural(head) or head in MASS_KINDS

    def may_mean(self, entry: CatalogueEntry) -> bool:
        """True if the noun may name an object of this kind, its colour aside."""
        if not self.name:
            return True
        names, head = names_of(entry), self.name[-1]
        split = "".join(map(lemma, tokens(self.words)[-2:]))  # "sauce pan"
        if any(_same(name, self.name) or name == (split,) for name in names.all):
            return True
        if len(self.name) == 1:
            return head_may_mean(head, entry)
        return _contains_all(self.name[:-1], entry) and any(same_word(head, name[-1]) for name in names.all)


def nouns(sentence: str, entries: Iterable[CatalogueEntry]) -> list[Noun]:
    """Find the nouns that name kinds among the entries, in the order of the sentence."""
    words, known = marked_tokens(sentence), _vocabulary(entries)
    found, at, last = list[Noun](), 0, 0
    while at < len(words):
        end = longest_name(words, at, known)
        if end > at and not _is_something_else(words, at, end, last, known):
            found.append(_noun(words, at, end, lemmas_of(words[at:end]), last))
        elif end == at and words[at] in ("one", "ones") and at and words[at - 1] in COLOURS:
            found.append(_noun(words, at, at + 1, (), last))
        last = end if end > at and not _is_lone_verb(words, at, end) else last
        at = max(end, at + 1)
    return found


def full_names(entries: Iterable[CatalogueEntry]) -> frozenset[Name]:
    """Return the names and synonyms that name a kind without more words."""
    named = {name for names in map(names_of, entries) for name in (names.words, *names.synonyms)}
    return frozenset(name for name in named if len(name) > 1 or name[0] not in NOT_NAMES)


def find_names(said: Sequence[str], names: Collection[Name], taken: Collection[int]) -> list[str]:
    """Find the names in a sentence.

    Args:
        said: the sentence's tokens.
        names: to search for (:func:`full_names`).
        taken: places of tokens that name something else.
    """
    found, at = list[str](), 0
    while at < len(said):
        end = longest_name(said, at, names)
        if end > at and not {*range(at, end)} & {*taken} and not (end == at + 1 and is_verb(said, at)):
            found.append(" ".join(said[at:end]))
        at = max(end, at + 1)
    return found


def longest_name(said: Sequence[str], at: int, names: Collection[Name]) -> int:
    """Return the end of the longest name that begins at a token; ``at`` without one."""
    best, name = at, Name()
    for end in range(at, min(at + _LONGEST_NAME, len(said)) if said[at] != "of" else at):
        if said[end] != "of":
            name = (*name, lemma(said[end]))
            best = end + 1 if name in names else best
    return best


def lemmas_of(said: Sequence[str]) -> Name:
    """The lemmas of tokens that are a name."""
    return tuple(lemma(word) for word in said if word not in DETERMINERS)


def is_verb(said: Sequence[str], at: int) -> bool:
    """Check if a token that may be a name is a verb: "present the card", "can you"."""
    before, word, after = ["", *said, ""][at : at + 3]
    if word == "can" and after in _FOLLOWS_CAN:
        return True
    if before in _BEFORE_A_NOUN or (before.isalpha() and before not in _KNOWN):
        return False
    phrasal = (word, after) in _PHRASAL_VERBS or (word == "stand" and not _UPRIGHT.isdisjoint(said[at:]))
    begins = before in _BEFORE_A_COMMAND and (word in ("tap", "present") or phrasal)
    return after in _FOLLOWS_A_VERB or word == "can" or begins


def stated_count(word: str) -> int | None:
    """Return the number that a word states; None where it is not exact."""
    if word.isdigit():
        return int(word)
    return None if word in ("few", "several", "couple", "pair", "no", "some") else NUMBERS.get(word)


def _vocabulary(entries: Iterable[CatalogueEntry]) -> frozenset[Name]:
    """Collect the names of kinds, the heads of these names, and words for categories."""
    found: set[Name] = {(word,) for word in (*KINDS, *CATEGORIES)}
    for entry in entries:
        names = names_of(entry)
        found |= {*names.all, (names.words[-1],), (lemma(entry.words.category),)}
    no_nouns = FUNCTION_WORDS - {"can"}
    return frozenset(name for name in found if name[0] not in no_nouns and (name[-1] not in PARTS or len(name) > 1))


def _is_something_else(words: Sequence[str], at: int, end: int, last: int, known: Collection[Name]) -> bool:
    """True if the words may be a verb, or qualify another noun.

    Args:
        words: of the sentence.
        at, end: of the noun.
        last: where the noun before it ends.
        known: names.
    """
    after = words[end] if end < len(words) else ""
    if last and (at == last or words[last:at] in (["of"], ["of", "the"])):
        return True  # "chips tube lid", "a tin of tomatoes"
    if _is_lone_verb(words, at, end):
        return True
    if words[at] in COLOURS and after in ("one", "ones"):
        return True
    return after != "can" if (lemma(after),) in known else _is_noun(after)


def _is_lone_verb(words: Sequence[str], at: int, end: int) -> bool:
    """True if a name of one word is a verb."""
    return end - at == 1 and is_verb(words, at)


def _is_noun(word: str) -> bool:
    """True if a word after a noun may continue it to a longer, unknown name."""
    return word.isalpha() and word not in _KNOWN | PARTS | AFTER_A_NOUN and not word.endswith(("s", "ing"))


def _noun(words: Sequence[str], at: int, end: int, name: Name, last: int) -> Noun:
    begin = at
    while begin > max(last, at - _ADJECTIVES_BEFORE) and _describes(words, begin - 1):
        begin -= 1
    colours = tuple(colour for word in reversed(words[begin:at]) if (colour := colour_of(word)))
    number = _number(words[:begin])
    begin -= number is not None and words[begin - 1] not in ("of", "the")
    return Noun(" ".join(words[begin:end]), name, colours, number, begin, end)


def _describes(words: Sequence[str], at: int) -> bool:
    """True if a word before a noun is its adjective: a colour, "and" between colours, or an unknown word."""
    if words[at] == "and":
        return at > 0 and words[at - 1] in COLOURS and words[at + 1] in COLOURS
    return words[at].isalpha() and words[at] not in _KNOWN


def _number(before: Sequence[str]) -> int | None:
    """Return the number stated before a noun and its adjectives: "two", "both of the", but not "one of the two"."""
    number = stated_count(before[-1]) if before else None
    if number is not None:
        before = before[:-1]
    while before and before[-1] in ("the", "of", "my", "your", "our", "these", "those", "last"):
        if before[-1] == "of" and len(before) > 1:
            outer = stated_count(before[-2])
            return outer if outer is not None or number is None else None
        before = before[:-1]
    return number


def _contains_all(words: Name, entry: CatalogueEntry) -> bool:
    """True if the texts of an entry contain all words."""
    said = [word for text in texts_of(entry) for word in lemmas(text)]
    return all(any(_akin(word, other) for other in said) for word in words)


def _same(name: Sequence[str], other: Sequence[str]) -> bool:
    return len(name) == len(other) and all(map(same_word, name, other))


def _akin(word: str, other: str) -> bool:
    return same_word(word, other) or (len(word) >= 4 and len(other) >= 4 and word[:4] == other[:4])
