"""An instruction in tokens: what each word, or several in a row, does in the sentence."""

from __future__ import annotations

import difflib
import functools
import itertools
import re
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

from vcage.base.words import ANYTHING, CATEGORIES, COLOURS, COUNTED, KINDS, NUMBERS, ORDINALS, PARTS, lemma
from vcage.models.rules.lexicon import BASES, FORMS, IS, LONGEST, OTHERS, PHRASES, SLIPS, Kind, Verb

_PIECE = re.compile(r"[a-z0-9]+(?:['-][a-z0-9]+)*|[^\s\"'`“”‘*]")


@dataclass(frozen=True)
class Token:
    """A word, or several in a row that do one thing.

    Args:
        kind: what it does.
        value: which of those that do so: ``in`` for 'into'.
        text: as written, in lower case.
        start, end: where in the instruction, in characters.
        glued: bound to the word before it by a hyphen.
        first: 'first' stands beside it: 'but first open it', 'but scan it first'.
        wished: words such as 'make sure that' stand before it.
    """

    kind: Kind
    value: str
    text: str
    start: int
    end: int
    glued: bool = False
    first: bool = False
    wished: bool = False

    @property
    def base(self) -> str | None:
        """The base form of the verb that it may be."""
        return self.text if self.text in BASES else FORMS.get(self.text)

    @property
    def verb(self) -> Verb | None:
        """What it asks for if it is a verb."""
        return BASES.get(self.base or "")

    @property
    def bare(self) -> bool:
        """Whether it has a verb's base form, as commands have."""
        return self.text in BASES


_KNOWN = frozenset(word for phrase in PHRASES for word in phrase) | frozenset(
    (*BASES, *FORMS, *OTHERS, *COLOURS, *KINDS, *CATEGORIES, *ANYTHING, *PARTS, *ORDINALS, *NUMBERS)
)
ALIKE = 0.8
"""How alike an unknown word and a known one are spelled at least for it to be a slip."""


@dataclass(frozen=True)
class _Word:
    text: str
    start: int
    end: int
    glued: bool = False


def tokens(instruction: str, names: Collection[str] = ()) -> list[Token]:
    """The tokens of an instruction, noise left out.

    Args:
        names: words that things are called by; a word that is none of them, and unknown, may be one with a slip.
    """
    words = _mended(_words(instruction), frozenset(names))
    found: list[Token] = []
    at = 0
    while at < len(words):
        token, length = _token(words, at, found[-1] if found else None, names)
        found.append(token)
        at += length
    useful: list[Token] = []
    for at, token in enumerate(found):
        ends = at + 1 == len(found) or found[at + 1].kind in ("stop", "query")
        if token.value == "earlier" and useful:  # '… . Before that, open the box'; '… before that.' is not clear
            kept = len(useful) - (useful[-1].kind == "stop")
            useful[kept:] = [replace(token, kind="word" if ends else "and")]
            continue
        if (token.text == "instead" and ends) or (token.text == "i mean" and found[max(at - 1, 0)].text == "one"):
            continue  # 'scan the juice instead', 'the white one I mean'
        begins = not useful or useful[-1].kind in ("and", "stop", "then")
        led = next((other for other in reversed(found[:at]) if other.text != ","), None)
        before = "" if led is None else led.kind if led.kind == "first" else found[at - 1].kind
        alone = ends and bool(useful) and useful[-1].kind in ("and", "then", "stop")
        joined = at > 0 and found[at - 1].kind in ("and", "then", "stop")
        if (alone and token.text in ("again", "once more")) or (joined and token.text == "me"):
            useful.append(replace(token, kind="word"))  # 'ring it, then again', 'give her the pen and me the book'
            continue
        if token.text == "up" and _is_counted(useful):  # 'the third drawer up', not 'open the drawer up'
            useful.append(replace(token, kind="word"))
            continue
        if token.kind == "first" and not begins:
            useful[-1] = replace(useful[-1], first=True)
        elif token.kind not in ("noise", "wish", "first"):
            useful.append(replace(token, first=begins and before == "first", wished=before == "wish"))
    return [_before_noun(token, useful[at + 1 : at + 2]) for at, token in enumerate(useful)]


def _is_counted(before: Sequence[Token]) -> bool:
    """Whether a part was named last by its number: 'the third drawer'."""
    return len(before) > 1 and before[-1].text in PARTS and before[-2].text in COUNTED


def _before_noun(token: Token, following: Sequence[Token]) -> Token:
    """'inside its drawer', not 'put it inside': a preposition."""
    if token.text == "an" and following and following[0].bare:  # 'the roll in the box an open the microwave'
        return replace(token, kind="and", value="")
    named = bool(following) and following[0].kind in ("article", "quantity", "number")
    bare = bool(following) and following[0].kind == "word" and not following[0].bare
    if token.kind == "instead" and token.text == "no" and bare:  # 'no pens', not 'no, the pens'
        return replace(token, kind="not", value="")
    if token.text == "bar" and named:  # 'all the bottles bar the blue one'
        return replace(token, kind="except", value="")
    return (
        replace(token, kind="prep", value="in") if token.text == "inside" and token.kind == "there" and named else token
    )


def _words(instruction: str) -> list[_Word]:
    """Lower-case words and marks; 'first-aid' is two words that are glued together."""
    text = "".join(c.lower() if len(c.lower()) == 1 else c for c in instruction)
    text = text.replace("’", "'").replace("_", " ").replace("...", ",  ").replace("…", ",")
    found: list[_Word] = []
    pieces = list(_PIECE.finditer(text))
    for match, following in itertools.zip_longest(pieces, pieces[1:]):
        parts = match[0].split("-") if len(match[0]) > 1 else [match[0]]
        numbers = len(parts) > 1 and all(part in NUMBERS for part in parts)
        start = match.start()
        for part in parts:
            short = part.endswith("'s") and following is not None and following[0] in IS
            whole = f"{part[:-2]} is" if short and part not in SLIPS else SLIPS.get(part, part)
            glued = len(parts) > 1 and not numbers
            for word in whole.split():
                found.append(_Word(word, start, start + len(part), glued))
            start += len(part) + 1
    return found


_BOUND: tuple[Kind, ...] = ("then", "first", "back", "there", "prep", "noise", "instead")
"""What a word is not after an article: 'the last drawer', 'the inside'; the first two not after a number either."""


def as_typed(instruction: str, text: str, start: int = 0, end: int = 0) -> str:
    """Words that were read, as the instruction spells them.

    Args:
        instruction: as it was typed.
        text: words in lower case, slips mended, perhaps in another order or in the singular.
        start, end: where in the instruction they were read, in characters; what is found nowhere is quoted from there.
    """
    words = _words(instruction)
    places = _places_of(text, words, start)
    if not places:
        return instruction[start:end].strip() or text
    first, last = min(places), max(places)
    between = (words[at].text for at in range(first, last) if at not in places)
    if all(word == "," or PHRASES.get((word,), ("word",))[0] == "article" for word in between):
        return instruction[words[first].start : words[last].end]
    return " ".join(instruction[words[at].start : words[at].end] for at in places)


def _places_of(text: str, words: Sequence[_Word], start: int) -> list[int]:
    """The places of the words that were typed for those of a text, those from ``start`` on first; none where a word is
    found nowhere."""
    near = sorted(range(len(words)), key=lambda at: (words[at].start < start, at))
    typed = [(at, words[at].text.removesuffix("'s")) for at in near]
    found = {word: _place_of(word, typed) for word in text.split()}
    missing = {word for word, at in found.items() if at is None} - {"of"}
    return [] if missing else [at for word in text.split() if (at := found[word]) is not None]


def _place_of(word: str, typed: Sequence[tuple[int, str]]) -> int | None:
    """The place of the word that was typed for another: itself, another form of it, or with a slip of the pen."""
    tests: tuple[Callable[[str], bool], ...] = (
        lambda text: text == word,
        lambda text: lemma(text) == lemma(word),
        lambda text: _meant(text, frozenset((word,))) == word,
    )
    return next((at for test in tests for at, text in typed if test(text)), None)


def _names(words: Sequence[_Word], at: int) -> bool:
    """Whether the word there names something."""
    if at >= len(words):
        return False
    text = words[at].text
    return (text,) not in PHRASES and text not in BASES and text[0].isalpha() and not _starts_phrase(words, at)


def _starts_phrase(words: Sequence[_Word], at: int) -> bool:
    return any(tuple(w.text for w in words[at : at + length]) in PHRASES for length in range(2, LONGEST + 1))


def _mended(words: list[_Word], names: frozenset[str]) -> list[_Word]:
    """The words with slips of the pen mended, where it is clear what was meant."""
    known = _KNOWN | names
    return [
        word
        if not names or word.text in known or not word.text.isalpha()
        else replace(word, text=_meant(word.text, known))
        for word in words
    ]


@functools.lru_cache(maxsize=10_000)
def _meant(word: str, known: frozenset[str]) -> str:
    """The known word that differs from an unknown one by a slip; itself where there is none, or more than one."""
    if len(word) < 4 or lemma(word) in known:
        return word
    drawn = re.sub(r"(.)\1{2,}", r"\1", word)  # 'pleeease'
    if drawn in known:
        return drawn
    swapped = [
        other for other in known if len(other) == len(word) and other[0] == word[0] and sorted(other) == sorted(word)
    ]
    if len(swapped) == 1:
        return swapped[0]
    near = difflib.get_close_matches(word, known, n=4, cutoff=ALIKE)
    close = [c for c in near if c not in COLOURS and (c not in _KNOWN or _dropped(word, c))][:2]
    likeness = [difflib.SequenceMatcher(None, word, other).ratio() for other in close]
    if (
        len(close) == 1
        or (close and likeness[0] > likeness[1] + 0.05)
        or (close and lemma(close[0]) == lemma(close[1]))
    ):
        return close[0]
    return word


def _dropped(word: str, other: str) -> bool:
    """Whether a letter was left out or typed twice; 'slice' with another letter is no 'slide'."""
    longer, shorter = max(word, other, key=len), min(word, other, key=len)
    return any(longer[:i] + longer[i + 1 :] == shorter for i in range(len(longer)))


def _token(words: Sequence[_Word], at: int, before: Token | None, names: Collection[str]) -> tuple[Token, int]:
    """The longest phrase of the lexicon that starts here, else the word itself; and how many words it takes."""
    named = before is not None and before.kind in ("article", "quantity", "number") and before.value != "it"
    for length in range(min(LONGEST, len(words) - at), 0, -1):
        row = words[at : at + length]
        known = PHRASES.get(tuple(word.text for word in row))
        if known is None or row[0].glued:
            continue
        bound = _BOUND if before is not None and before.kind == "article" else _BOUND[:2]
        if named and length == 1 and known[0] in bound and known[1] != "adjective" and row[0].text != ",":
            continue
        if known[0] in _BOUND[:2] and all(word.text in names for word in words[at : at + 2]) and words[at + 1 :]:
            continue  # 'the red first aid kit'
        if known[0] in ("pronoun", "first") and length > 1 and _names(words, at + length):
            continue  # 'the two towels'
        kind, value = known
        text = value if kind == "word" else " ".join(w.text for w in row)
        return Token(kind, value, text, row[0].start, row[-1].end), length
    word = words[at]
    number = not word.glued and (word.text in NUMBERS or word.text.isdecimal())
    return Token("number" if number else "word", word.text, word.text, word.start, word.end, word.glued), 1
