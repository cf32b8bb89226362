"""Noun phrases: what is named, in which colour, how many of it, which part of a place, and what is left out."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from vcage.base.words import (
    ANYTHING,
    COLOURS,
    HIGHEST,
    LOWEST,
    MASS_KINDS,
    NUMBERS,
    ORDINALS,
    PARTS,
    PIECES,
    colour_of,
    is_plural,
    lemma,
)
from vcage.models.rules.tokens import Token, as_typed

MARKS = (",", "-", "–", "—", "(", ")")

SEVERAL = 3
"""How many things a plural without a number means."""

Quantity = Literal["the", "a", "all", "both", "rest"]
"""Which of those that answer: a certain one (or certain ones), any, all, both, or those that were not named yet."""

_ATTRIBUTES = {"eat": "edible", "eatable": "edible", "write": "writing", "drink": "drinkable"}
_ONE = ("one", "ones")
_STATES = ("open", "opened", "shut", "closed")
_PARTICLES = ("out", "down", "across", "along")
_POINTING = ("those", "these", "that", "this")
_EVERY = ("everything", "anything", "whatever", "things")


@dataclass(frozen=True)
class Phrase:
    """A noun phrase; a pronoun has no lemmas.

    Args:
        text: as written, without articles.
        lemmas: words without numbers, articles and (unless it is the head) colours; the head is last.
        colour: the colour that is asked for.
        count: how many things; ``None`` for "several, as many as fit".
        quantity: which of those that answer.
        part: the part that is meant ("drawer"), where one is named; ``lemmas`` then name what it belongs to, if that is
            named too.
        which: words that tell the part from others.
        least_parts: how many of these there are at least.
        but: what is left out.
        start: where in the instruction: tells two mentions in the same words apart.
        end: where the words end that were read last, without exceptions; 0 where it was not read in the instruction.
    """

    text: str
    lemmas: tuple[str, ...]
    colour: str | None = None
    count: int | None = 1
    quantity: Quantity = "the"
    part: str | None = None
    which: tuple[str, ...] = ()
    least_parts: int = 0
    but: tuple[Phrase, ...] = ()
    start: int = 0
    end: int = field(default=0, compare=False)

    def as_typed(self, instruction: str) -> str:
        """Its words, as they were typed."""
        return as_typed(instruction, self.text, self.start, self.end)

    @property
    def head(self) -> str:
        """The last lemma: what it is."""
        return self.lemmas[-1]

    @property
    def is_pronoun(self) -> bool:
        """Whether it only points back at things."""
        return not self.lemmas

    @property
    def plural(self) -> bool:
        """Whether it may mean more than one thing."""
        return self.count is None or self.count > 1


class Cursor:
    """A place in a row of tokens."""

    def __init__(self, tokens: Sequence[Token]):
        self.tokens = tokens
        self.at = 0
        self.excepting = False
        """Whether an exception is read, which ends at 'but'."""
        self.commas_end = False
        """Whether a comma ends a list: 'before you set the timer, the carrot …'."""

    def peek(self, ahead: int = 0) -> Token | None:
        """The token that comes after ``ahead`` others, if there is one."""
        at = self.at + ahead
        return self.tokens[at] if at < len(self.tokens) else None

    def kind(self, ahead: int = 0) -> str:
        """What that token does; "" at the end."""
        token = self.peek(ahead)
        return "" if token is None else token.kind

    def text(self, ahead: int = 0) -> str:
        """That token as it is written; "" at the end."""
        token = self.peek(ahead)
        return "" if token is None else token.text

    def take(self) -> Token:
        """The next token, which is then behind."""
        self.at += 1
        return self.tokens[self.at - 1]

    def skip(self, *kinds: str) -> bool:
        """Take tokens of these kinds; whether there was one."""
        begun = self.at
        while self.kind() in kinds:
            self.at += 1
        return self.at > begun


def noun_phrase(cursor: Cursor, exceptions: bool = True) -> Phrase | None:
    """The noun phrase that begins here, which is then behind; None where none does.

    Args:
        exceptions: whether an exception that follows belongs to it, and not to what was named before.
    """
    begun = cursor.at
    if cursor.kind() == "pronoun":
        token = cursor.take()
        count = 1 if token.value in ("it", "the other") else _told(token.text)
        return Phrase(
            token.value,
            (),
            count=count,
            quantity="rest" if token.value in ("the rest", "everything else") else "the",
            start=token.start,
            end=token.end,
        )
    if cursor.text() in _POINTING and cursor.kind(1) in ("be", "belong", "ought", "prep", "", "and", "stop"):
        token = cursor.take()
        return Phrase(
            "them" if token.text in _POINTING[:2] else "it",
            (),
            count=None if token.text in _POINTING[:2] else 1,
            start=token.start,
            end=token.end,
        )
    quantity, numbers = _determiners(cursor)
    bare = quantity in ("both", "all") and cursor.text() in _STATES and cursor.kind(1) != "word"  # 'leave both open'
    words = [] if bare else [*_led(cursor, numbers), *_named(cursor)]
    if not words and not numbers and quantity in ("both", "all"):
        ends = {"start": cursor.tokens[begun].start, "end": cursor.tokens[cursor.at - 1].end}
        return Phrase("them", (), count=2 if quantity == "both" else None, **ends)
    if not words and not numbers and quantity != "rest":
        cursor.at = begun
        return None
    start = cursor.tokens[begun].start
    phrase = _from_an_end(cursor, _phrase(words, quantity, numbers, start))
    phrase = replace(_related(cursor, phrase), end=cursor.tokens[cursor.at - 1].end)
    return replace(phrase, but=(*phrase.but, *_left_out(cursor, phrase))) if exceptions else phrase


def _determiners(cursor: Cursor) -> tuple[Quantity | None, list[int | None]]:
    """Articles, quantities and numbers before the words of a noun phrase."""
    quantity: Quantity | None = None
    numbers: list[int | None] = []
    single = counted = False
    while cursor.kind() in ("article", "quantity", "number") or (cursor.text() == "of" and (quantity or numbers)):
        if cursor.text() in _ONE and cursor.kind(1) != "word" and cursor.text(1) != "of" and (quantity or numbers):
            break
        token = cursor.take()
        counted = counted or (token.text == "of" and bool(numbers))
        if counted and token.kind in ("number", "article"):
            continue  # 'two of the three mugs'
        if token.kind == "number":
            numbers.append(_value(token))
        elif token.kind == "quantity":
            if token.value == "one":
                single = True
                quantity = "a"
            else:
                quantity = token.value  # pyrefly: ignore
        elif token.kind == "article" and quantity is None and token.text != "of":
            quantity = token.value  # pyrefly: ignore
            if token.text in ("some", "any"):
                numbers.append(None)
            if token.text == "some" and not is_plural(cursor.text()) and lemma(cursor.text()) not in MASS_KINDS:
                numbers.append(0)  # 'some salt' is no salt shaker
    return quantity, [1] if single else numbers


def _told(pronoun: str) -> int | None:
    """How many 'them both' or 'all three' are; None where that is not said."""
    pairs = {"both": 2, "two": 2, "pair": 2, "three": 3, "four": 4}
    return next((pairs[word] for word in pronoun.split() if word in pairs), None)


def _value(number: Token) -> int | None:
    return NUMBERS[number.text] if number.text in NUMBERS else int(number.text)


def _led(cursor: Cursor, numbers: list[int | None]) -> list[Token]:
    """An ordinal before a number, which joins the numbers: 'the top two drawers'."""
    if cursor.text() not in ORDINALS or cursor.kind(1) != "number" or cursor.kind(2) != "word":
        return []
    led = cursor.take()
    numbers.append(_value(cursor.take()))
    return [led]


def _from_an_end(cursor: Cursor, phrase: Phrase) -> Phrase:
    """'the third drawer from the bottom': the third lowest."""
    end = cursor.text(2)
    told = cursor.text() == "from" and cursor.kind(1) == "article" and end in (*HIGHEST, *LOWEST)
    if not told or cursor.kind(3) == "word" or phrase.part is None or len(phrase.which) != 1:
        return phrase
    cursor.at += 3
    return replace(phrase, which=(*phrase.which, end), text=f"{phrase.text} from the {end}")


def _named(cursor: Cursor) -> list[Token]:
    """The words of a noun phrase, with those of what it is a part of: 'top drawer of the cabinet'."""
    words: list[Token] = []
    while cursor.kind() == "word" or (cursor.text() in _ONE and cursor.kind() == "number"):
        token = cursor.peek()
        if cursor.text() == "of" and not words:
            break
        if words and token is not None and (cursor.text() in _PARTICLES or (cursor.commas_end and token.bare)):
            break
        if words and token is not None and cursor.kind(1) != "word" and _participle(token):
            break  # 'the stapler handed over', 'the kit standing to the left'
        words.append(cursor.take())
        if cursor.text() == "with" and _part_follows(cursor):  # 'the box with the lid'
            words.append(cursor.take())
            cursor.skip("article", "number")
        owned = words[-1].text in ("of", "on", "in") and cursor.kind() == "article"
        if owned:
            cursor.take()
    while words and words[-1].text == "of":
        words.pop()
        cursor.at -= 1
    return words


def _part_follows(cursor: Cursor) -> bool:
    ahead = 1
    while cursor.kind(ahead) in ("article", "number"):
        ahead += 1
    return cursor.kind(ahead) == "word" and lemma(cursor.text(ahead)) in PARTS


def _participle(token: Token) -> bool:
    return token.text in ("standing", "lying", "sitting", "resting", "sat", "stood", "put", "kept") or (
        bool(token.verb) and token.text.endswith("ed")
    )


def _piece_last(texts: list[str], owned: str) -> list[str]:
    """Move a piece of a thing to the end, as the head of its phrase: 'the stem of the apple' is not an apple.

    Args:
        texts: words of a noun phrase, such as "stem of apple".
        owned: last word of what the phrase calls a thing's own ("stem" in "apple's stem"); empty without a possessive.
    """
    at = texts.index("of") if "of" in texts[1:] else 0
    named = lemma(texts[at - 1])
    piece = named in PIECES or (named == owned and named not in ("code", "barcode"))  # a code is shown with its thing
    return [*texts[at + 1 :], *texts[:at]] if at and piece and named not in PARTS else texts


def _phrase(words: Sequence[Token], quantity: Quantity | None, numbers: Sequence[int | None], start: int) -> Phrase:
    texts = [text for word in words if (text := word.text.removesuffix("'s"))] or ["one"]
    owned = ""
    if any(word.text.endswith("'s") for word in words):  # 'the cabinet's top drawer': what owns it comes first
        owner = next(i for i, word in enumerate(words) if word.text.endswith("'s"))
        owned = lemma(texts[-1])
        texts = [*texts[owner + 1 :], "of", *texts[: owner + 1]]
    text = " ".join(texts)
    texts = _piece_last(texts, owned)
    if texts[0] in _EVERY and len(texts) > 1:  # 'everything yellow'
        named = _phrase([w for w in words[1:] if w.text != "else"], quantity, numbers, start)
        is_colour = len(texts) == 2 and texts[1] in COLOURS
        kept = () if is_colour else named.lemmas
        return replace(
            named, text=text, lemmas=("thing", *kept), colour=colour_of(texts[-1]), count=None, quantity="all"
        )
    counted = texts[texts.index("of") - 1] if "of" in texts[1:] else texts[-1]
    part, which, texts = _part(texts)
    *qualifiers, head = texts
    colour = colour_of(" ".join(qualifiers)) or (colour_of(head) if _all_colours(texts) and len(texts) > 1 else None)
    kept = tuple(lemma(word) for word in qualifiers if word not in COLOURS and word != "of")
    lemmas = (*kept, "one" if head in _ONE else lemma(head))
    if quantity == "both" and not is_plural(counted):
        quantity = "the"  # 'both the duck and the sponge'
    single = quantity == "a" and (numbers == [1] or not (numbers or is_plural(counted)))
    count = 1 if single else _count(numbers, counted)
    if lemmas[0] in _EVERY[:3]:
        quantity, count, numbers = "all", None, []
    if quantity in ("all", "both", "rest") and not numbers:
        several = is_plural(counted) or lemma(counted) in MASS_KINDS or quantity == "all"
        count = 2 if quantity == "both" else None if several else 1
    plain = count is not None and bool(numbers) and quantity is None
    several = max(2, count or 0) if is_plural(counted) else 1
    stated = [
        NUMBERS.get(a) or 0 for a, b in itertools.pairwise(texts) if lemma(b) == part
    ]  # 'the three-drawer cabinet'
    least = max([several, *stated, *(ORDINALS.get(word, 1) for word in which)]) if part else 0
    return Phrase(
        text=text,
        lemmas=lemmas,
        colour=colour,
        count=count,
        quantity=quantity or ("a" if plain else "the"),
        part=part,
        which=which,
        least_parts=least,
        start=start,
    )


def _all_colours(texts: Sequence[str]) -> bool:
    return all(word in COLOURS for word in texts)


def _part(texts: list[str]) -> tuple[str | None, tuple[str, ...], list[str]]:
    """The part that is named, what tells it from others, and the words for what it belongs to, or for itself."""
    if "with" in texts:
        return None, (), texts
    at = texts.index("of") if "of" in texts[1:] else len(texts)
    before, owner = texts[:at], texts[at + 1 :]
    part = lemma(before[-1]) if before else ""
    if part not in PARTS:
        return None, (), texts
    which = tuple(word for word in before[:-1] if word in ORDINALS)
    kept = [word for word in before[:-1] if word not in ORDINALS]
    return part, which, owner or [*kept, before[-1]]


def _count(numbers: Sequence[int | None], counted: str) -> int | None:
    """How many things a phrase asks for; None for several.

    Args:
        numbers: the numbers that it names.
        counted: what they count: 'slices' in 'two slices of toast'.
    """
    if not numbers:
        return None if is_plural(counted) or lemma(counted) in MASS_KINDS else 1
    count = functools.reduce(_with_number, numbers, None)
    if count is None and not is_plural(counted) and lemma(counted) not in MASS_KINDS:
        return 1  # 'any pen'
    return None if count == 1 and is_plural(counted) else count


def _with_number(before: int | None, value: int | None) -> int | None:
    """The number that two words name: 'two dozen', 'twenty-five', 'a hundred'; else the latter rules."""
    if not before or not value:
        return value
    if value in (12, 100, 1000):
        return before * value
    return before + value if value < 10 and before % 10 == 0 and before >= 20 else value


def _related(cursor: Cursor, phrase: Phrase) -> Phrase:
    """With what a relative clause says of it: 'everything that is red', 'things you can eat'."""
    begun = cursor.at
    if cursor.kind() == "be" and cursor.text().startswith(("that", "which", "who")):
        cursor.take()
        if cursor.kind() == "not":
            return _unlike(cursor, phrase, begun)
    elif cursor.text() == "that" and cursor.kind(1) == "not":
        cursor.take()
        return _unlike(cursor, phrase, begun)
    elif cursor.kind() == "which":
        cursor.take()
        while cursor.text() in ("can", "could", "may", "is", "are"):
            cursor.take()
    else:
        return phrase
    cursor.skip("article")
    words = _named(cursor)
    texts = [_ATTRIBUTES.get(word.text, word.text) for word in words if word.text not in ("with", "coloured")]
    if not texts:
        cursor.at = begun
        return phrase
    if cursor.kind() == "prep" and cursor.text() == "with" and "writing" in texts:
        cursor.take()
    colours = [word for word in texts if word in COLOURS and not (word == texts[-1] == "orange" and len(texts) > 1)]
    others = tuple(lemma(word) for word in texts if word not in colours)
    return replace(
        phrase,
        text=f"{phrase.text} {' '.join(word.text for word in words)}",
        colour=colour_of(" ".join(colours)) or phrase.colour,
        lemmas=others if others and phrase.head in ANYTHING else (*phrase.lemmas, *others),
    )


def _unlike(cursor: Cursor, phrase: Phrase, begun: int) -> Phrase:
    """'every mug that isn't blue': without those that are."""
    cursor.take()
    words = _named(cursor)
    texts = [word.text for word in words]
    if len(texts) != 1 or texts[0] not in COLOURS:
        cursor.at = begun
        return phrase
    return replace(
        phrase, but=(*phrase.but, replace(phrase, colour=colour_of(texts[0]), text=f"{texts[0]} {phrase.text}"))
    )


def _left_out(cursor: Cursor, phrase: Phrase) -> tuple[Phrase, ...]:
    """What an exception names: 'all the fruit except the banana', 'the pens but not the red one'."""
    begun = cursor.at
    but = phrase.quantity == "all" and cursor.text() == "but" and not _begins_clause_at(cursor, 1)
    cursor.skip("and")
    if cursor.kind() not in ("except", "not") and but:
        return _excepted(cursor)
    if cursor.kind() not in ("except", "not"):
        cursor.at = begun
        return ()
    doubtful = cursor.take().text == "no" and phrase.count == 1  # 'the apple, no banana' may be a slip
    if (
        doubtful
        or cursor.text() in ("touch", "move", "use", "disturb")
        or (_begins_clause(cursor) and cursor.kind() == "word")
    ):
        cursor.at = begun
        return ()
    found = _excepted(cursor)
    if not found:
        cursor.at = begun
    return found


def _excepted(cursor: Cursor) -> tuple[Phrase, ...]:
    cursor.excepting = True
    found = noun_phrases(cursor)
    cursor.excepting = False
    return found


def noun_phrases(cursor: Cursor) -> tuple[Phrase, ...]:
    """Noun phrases in a list; a bare colour takes the head of the next one: 'the red, green and blue blocks'."""
    found: list[Phrase] = []
    while True:
        begun = cursor.at
        marked = cursor.text() in MARKS
        ended_by_comma = cursor.text() == "," and cursor.kind(1) != "and"
        ended = (cursor.commas_end and ended_by_comma) or (cursor.excepting and cursor.text() == "but")
        joined = cursor.skip("and")
        if found and (not joined or ended or _begins_clause(cursor)):
            cursor.at = begun
            break
        if cursor.kind() == "instead":
            break
        if ended_by_comma and cursor.text() == "any":  # 'a pen, any pen'
            again = noun_phrase(cursor)
            if again is not None and found and again.lemmas == found[-1].lemmas:
                continue
            cursor.at = begun
            break
        phrase = noun_phrase(cursor)
        if phrase is None:
            cursor.at = begun
            break
        one = found and marked and phrase.lemmas[-1:] == ("one",) and not (phrase.colour and found[-1].colour)
        if one and (phrase.colour or phrase.lemmas[:-1]) and phrase.quantity == "the" and not found[-1].plural:
            colour, lemmas = phrase.colour or found[-1].colour, (*phrase.lemmas[:-1], *found[-1].lemmas)
            found[-1] = replace(
                found[-1], colour=colour, lemmas=lemmas, quantity="the", text=f"{phrase.text} {found[-1].text}"
            )
            continue  # 'the torch, the red one'
        found.append(phrase)
    if len(found) > 1 and any(
        but.lemmas == ("one",) for but in found[-1].but
    ):  # 'the pens and the blocks, but the red ones'
        found = [replace(phrase, but=(*phrase.but, *found[-1].but)) for phrase in found[:-1]] + found[-1:]
    return _with_heads(found)


def _begins_clause_at(cursor: Cursor, ahead: int) -> bool:
    further = Cursor(cursor.tokens)
    further.at = cursor.at + ahead
    return _begins_clause(further)


def _begins_clause(cursor: Cursor) -> bool:
    """Whether a command begins here, and no further thing of a list."""
    token = cursor.peek()
    if token is None:
        return True
    if token.kind in ("article", "quantity", "number", "pronoun"):
        return False
    if token.kind != "word" or token.verb is None or not token.bare:
        return token.kind != "word"
    following = cursor.kind(1)
    return following not in ("", "and", "stop", "query", "then") and cursor.text(1) != "of"


def _with_heads(phrases: Sequence[Phrase]) -> tuple[Phrase, ...]:
    found: list[Phrase] = []
    for phrase in reversed(phrases):
        told = found and found[-1].part is not None and found[-1].which
        if told and len(phrase.lemmas) == 1 and phrase.part is None and phrase.head in ORDINALS:
            following = found[-1] = replace(found[-1], count=1 if found[-1].count is None else found[-1].count)
            phrase = replace(
                following, which=phrase.lemmas, text=f"{phrase.text} {following.part}", start=phrase.start, count=1
            )
        if found and phrase.lemmas and len(phrase.lemmas) == 1 and phrase.head in COLOURS and phrase.colour is None:
            following = found[-1]
            fruit = phrase.head == "orange" and following.colour is None  # 'the orange and the carrot'
            bare = fruit or (len(following.lemmas) == 1 and following.head in COLOURS and following.colour is None)
            if not bare and (following.colour or following.lemmas != phrase.lemmas):
                single = following.count is None or phrase.count == 1
                if single and following.colour and following.count is None:
                    found[-1] = following = replace(following, count=1)
                phrase = replace(
                    phrase,
                    text=f"{phrase.text} {' '.join(following.lemmas)}",
                    lemmas=following.lemmas,
                    colour=colour_of(phrase.head),
                    part=following.part,
                )
        found.append(phrase)
    return tuple(reversed(found))
