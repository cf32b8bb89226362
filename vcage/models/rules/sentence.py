"""From a sentence to commands by the grammar in ``instruction.lark``: every way in which it can be read."""

from __future__ import annotations

import difflib
import functools
import math
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from lark import Lark, Token, Transformer, Tree, UnexpectedInput, v_args
from lark.visitors import CollapseAmbiguities

from vcage.base.errors import UnreadInstruction
from vcage.base.files import resource
from vcage.base.words import COLOURS, FUNCTION_WORDS, NUMBERS, is_plural, lemma, tokens
from vcage.models.rules.nouns import Noun, noun_of

REFUSED = {
    r"head-up|horizontally": "no goal says which way up a thing is held",
    r"slightly(?! away)|twice|vigorously": "no goal says how far, how often or how hard something is done",
    r"(every|each) (?:(?!and )[^,.;])* (in|on|into|onto|to) its":
        "no goal says that each thing has a place of its own; name the places",
    r"sorry|i mean|or rather|no wait": "a correction is not read; say only what is meant",
    r"(by )?(\d+|ninety|forty-five)(?= ?°| degrees)|(a )?(half|quarter) turn|upside down":
        "no goal says by which angle a thing is turned",
    r"[4-9]\d|\d{3,}": "no table holds so many; ask for 1 to 39",
    r"(corner|edge) of the (table|desk)": "this place of the table is none that a goal can name",
    r"under(neath)?|below|beneath": "what is under a thing is no place that a goal can name",
}  # fmt: skip
"""Words that no goal of the vocabulary can keep, and why."""

_TWO_ARMS = re.compile(
    r"\b(simultaneously|at the same time"
    r"|(both|two|separate|each|another)( (of|the|your|available|free|separate))* (arm|hand|gripper)s?)\b"
)
_ONE_BY_ONE = "two arms at once cannot be promised; say which arm does what, left or right, or leave the arms out"
"""Why two arms are not read where they do anything but hold something up."""

_POLITE = re.compile(
    r"\b(please|pls|kindly|carefully|gently|again|thanks|thank you|cheers|ta|for me|as well|now|just|hey|(?<!the )robot"
    r"|directly|slightly(?= away)|straight|somewhere)\b"
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
_CLAUSE_ENDS = re.compile(r"[,.;]|\b(and|then)\b")
_COLOUR = "|".join(sorted(COLOURS))
_TWO_COLOURED = re.compile(rf"\b({_COLOUR}) and ({_COLOUR})(?= (?P<name>[a-z]+))")
_FALLEN_OVER = re.compile(r"\b(?<!has )(fallen|toppled|tipped|knocked) over(?= (?!up\b)[a-z])")
_NOT_READ = re.compile(r"[^a-z0-9 ,.;'-]")


@dataclass(frozen=True)
class Limits:
    """Limits on sentences.

    Args:
        words: of a sentence.
        readings: ways to read it that are tried.
        several: objects that are chosen for "several".
    """

    words: int = 60
    readings: int = 200
    several: int = 3


LIMITS = Limits()

ONE_ARM, OTHER_ARM = "one", "other"
"""Stand for an arm that is left open, and for the one that was not named before."""


USING = ("hit", "wipe")
"""Verbs of what is done to a thing with a tool in a hand."""


@dataclass(frozen=True)
class Command:
    """One thing that a sentence asks for.

    Args:
        verb: a rule of the grammar: put, pick, open, close, turn, turn_off, press, weigh, scan, show, hand, lift,
            shake, hit, wipe, pour, hang, hold, in_hands, hold_with_both, away, face, stand_up, stack, tower, stamp,
            row, swap.
        things: its objects; none where a row or a tower is of other things than those that are named.
        how: in, on, left_of, right_of, in_front_of, behind, beside, near, centred or to; for ``hand`` who gets it.
        place: where things go, or the tool.
        source: where they are taken from.
        arm: left or right, where one is named; :data:`ONE_ARM` or :data:`OTHER_ARM`.
        group: commands of a lower group come first.
        at: where in the sentence it begins.
        words: of the sentence, from there to the next command.
        may_be: what its pronoun may be, as typed, where that is a tool or what was hit or wiped with it.
    """

    verb: str
    things: tuple[Noun, ...] = ()
    how: str = ""
    place: Noun | None = None
    source: Noun | None = None
    arm: str | None = None
    group: float = 0
    at: int = 0
    words: str = ""
    may_be: tuple[str, ...] = ()


_GRAMMAR = Path(__file__).with_name("instruction.lark").read_text("utf-8").replace("~?", " *").replace("~", " +")
FORMS = tuple(re.findall(r"^// > (.+)$", _GRAMMAR, re.MULTILINE))
"""One sentence of each form."""


@functools.lru_cache(maxsize=100)
def parse(instruction: str) -> tuple[tuple[Command, ...], ...]:
    """Every way in which a sentence can be read; pronouns and "one" are still to be resolved.

    Kept, since objects are chosen for a sentence before its goals are read with them.

    Raises:
        UnreadInstruction: there is none; names the first word that does not fit and the nearest form that does.
    """
    typed = " ".join(instruction.split())
    text = _normal(typed)
    try:
        tree = _grammar().parse(text)
    except UnexpectedInput as error:
        if found := _TWO_ARMS.search(text):
            raise not_read(typed, found[0], _ONE_BY_ONE) from None
        at = len(text) if error.pos_in_stream in (None, -1) else int(error.pos_in_stream)
        raise not_read(typed, _misfit(typed, text, at), "it does not fit any form of sentence that is read") from None
    if _readings(tree) > LIMITS.readings:
        raise not_read(typed, typed, f"there are more than {LIMITS.readings} ways to read it")
    ways = map(_located, CollapseAmbiguities().transform(tree))
    return tuple(dict.fromkeys(_Commands(typed).transform(one) for one in ways))


def not_read(instruction: str, words: str, why: str) -> UnreadInstruction:
    """The error for unread words: the nearest known form, and the models that can read them."""
    verbs = _verbs(instruction)
    same = [form for form in FORMS if not verbs.isdisjoint(_verbs(form))] or FORMS
    near, *_ = difflib.get_close_matches(instruction, same, n=1, cutoff=0)
    words = words or instruction
    return UnreadInstruction(
        f"{words[:200]!r} in {instruction[:200]!r} is not understood: {why}",
        hint=f"write it like {near!r} (forms: {resource('docs', 'instructions.md')}), or let a model read it: "
        "--models agent, gemini, openai, anthropic or ollama",
        details={"unread": words, "understood": [], "form": near},
    )


def _verbs(text: str) -> set[str]:
    """The verbs in a text, by the names of the terminals that a form of sentence begins with."""
    starts = [word.start() for word in re.finditer(r"\b[a-z]", text.lower())]
    return {name for name, verb in _first_verbs().items() for at in starts if verb.match(text.lower(), at)}


@functools.cache
def _first_verbs() -> dict[str, re.Pattern[str]]:
    """The terminals that a form of sentence begins with, by name."""
    begin = {t.name: re.compile(t.pattern.to_regexp()) for t in _grammar().terminals if t.name not in ("WORD", "_AND")}
    return {name: verb for name, verb in begin.items() if any(verb.match(form.lower()) for form in FORMS)}


def _joined(found: re.Match[str]) -> str:
    """A two-coloured look as one word: "the yellow and white mug"; "the red and blue blocks" are of two looks."""
    no_name = found["name"] in FUNCTION_WORDS - {"can"}  # "in the order of red, green and blue from left to right"
    return found[0] if no_name or is_plural(found["name"]) else found[0].replace(" ", "-")


def _normal(typed: str) -> str:
    """The sentence in the grammar's form: of the same length, so that places in it are preserved."""
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
        raise not_read(typed, _word_at(typed, odd.start() if odd else 0), "it is no plain statement in English")
    return text


def _misfit(typed: str, text: str, at: int) -> str:
    """The first word that does not fit: where parsing ends, or the first word of the clause, if that is no verb."""
    begins = max((found.end() for found in _CLAUSE_ENDS.finditer(text, 0, at)), default=0)
    clause = text[begins:].lstrip()
    known = any(re.match(t.pattern.to_regexp(), clause) for t in _grammar().terminals if t.name not in ("WORD", "_AND"))
    return _word_at(typed, at if known else begins)


def _word_at(typed: str, at: int) -> str:
    rest = re.match(r"\S+", typed[at:].lstrip())
    return rest[0].strip(",.;") or rest[0] if rest else f"the end after {typed.split()[-1]!r}"


@functools.lru_cache(maxsize=1)
def _grammar() -> Lark:
    return Lark(_GRAMMAR, ambiguity="explicit", propagate_positions=True, maybe_placeholders=False)


def _located(tree: Tree[Any]) -> Tree[Any]:
    """A tree with the place of every part in the sentence: lark leaves it out where a part has several readings."""
    for part in tree.iter_subtrees():
        if part.meta.empty:
            places = [child if isinstance(child, Token) else child.meta for child in part.children]
            part.meta.start_pos = min(place.start_pos or 0 for place in places)
            part.meta.end_pos = max(place.end_pos or 0 for place in places)
            part.meta.empty = False
    return tree


def _readings(tree: Tree[Any]) -> int:
    counts = [_readings(child) for child in tree.children if isinstance(child, Tree)]
    return sum(counts) if tree.data == "_ambig" else math.prod(counts)


def _is_order_of(row: tuple[Noun, ...], named: tuple[Noun, ...]) -> bool:
    """True where a row has each of the named things once: of their colours, or as many as "the blocks" are."""
    if len(named) == 1 and named[0].several and named[0].colour is None:
        return named[0].count in (None, len(row))
    return {noun.colour for noun in row} == {noun.colour for noun in named}


_HOW = {
    "INTO": "in", "INSIDE": "in", "ONTO": "on", "left": "left_of", "right": "right_of", "front": "in_front_of",
    "behind": "behind", "near": "near", "close": "near",
}  # fmt: skip
"""Terminals and words for places → relations."""
_JOINT = re.compile(r"(?:[\s,.;]|\b(?:and|then|but)\b)+$", re.IGNORECASE)
"""Words and signs that join a command to the next."""


@v_args(meta=True)
class _Commands(Transformer[Token, Any]):
    """One tree to its commands: parts of a sentence become fields of them, a rule without a method is a verb."""

    def __init__(self, typed: str):
        super().__init__()
        self._typed = typed

    def start(self, _: Any, groups: list[list[Command]]) -> tuple[Command, ...]:
        begun = {command.at for group in groups for command in group}
        words = {at: _JOINT.sub("", self._typed[at : min((b for b in begun if b > at), default=None)]) for at in begun}
        return tuple(replace(c, group=number, words=words[c.at]) for number, group in enumerate(groups) for c in group)

    def before(self, meta: Any, groups: list[list[Command]]) -> tuple[Command, ...]:
        return self.start(meta, groups[::-1])

    def group(self, _: Any, parts: list[list[Command]]) -> list[Command]:
        return [command for part in parts for command in part]

    def clause(self, meta: Any, parts: list[Any]) -> list[Command]:
        arm = next((part["arm"] for part in parts if isinstance(part, dict)), None)
        commands = [command for part in parts if isinstance(part, list) for command in part]
        return [replace(command, arm=command.arm or arm, at=meta.start_pos) for command in commands]

    def stack(self, _: Any, items: list[list[Command]]) -> list[Command]:
        return [replace(c, verb="tower", how="to" if c.how in ("in", "on") else c.how) for item in items for c in item]

    def item(self, meta: Any, parts: list[Any]) -> list[Command]:
        but = [noun for part in parts if isinstance(part, list) for noun in part]
        (command,) = self.__default__("put", [part for part in parts if isinstance(part, dict)], meta)
        return [replace(command, things=tuple(noun.without(but) for noun in command.things))]

    def in_hands(self, meta: Any, parts: list[Any]) -> list[Command]:
        things = parts[0]["things"]
        if len(things) == 1 and things[0].count in (None, 1):  # "one bottle with each arm"
            things = (replace(things[0], quantifier="", count=2),)
        return self.__default__("in_hands", [{"things": things}], meta)

    def hand(self, meta: Any, parts: list[Any]) -> list[Command]:
        things, *giver, gets = parts
        return self.__default__("hand", [things, *giver, {"how": gets["arm"] or "any"}], meta)

    def built(self, meta: Any, parts: list[Any]) -> list[Command]:
        told = {part.type: str(part) for part in parts if isinstance(part, Token)}
        lowest, *others = [part for part in parts if not isinstance(part, Token)]
        if "STOREYS" in told:
            kinds = {noun.words[-1:] for noun in (lowest, *(above for above, _ in others))}
            if NUMBERS[told["STOREYS"].rstrip("-")] != 1 + len(others) or kinds - {(), (lemma(told["WORD"]),)}:
                return [Command("tower", at=meta.start_pos)]
        found = [Command("put", (above,), "on", below, at=meta.start_pos) for above, below in others]
        if "CENTRE" in told:
            middle = Noun(words=("table",), text=told["CENTRE"], at=meta.start_pos)
            found.insert(0, Command("put", (lowest,), "centred", middle, at=meta.start_pos))
        return found

    def on_it(self, _: Any, parts: list[Any]) -> tuple[Noun, Noun]:
        return parts[0], parts[-1]

    def pour(self, meta: Any, parts: list[Any]) -> list[Command]:
        fields = [{"things": (part,)} if isinstance(part, Noun) else part for part in parts]  # contents of it
        return self.__default__("pour", fields, meta)

    def stand_up(self, meta: Any, parts: list[Any]) -> list[Command]:
        """Standing something up somewhere is putting it there, upright."""
        things, *rest = parts
        but = [noun for part in rest if isinstance(part, list) for noun in part]
        named = tuple(noun.without(but) for noun in things["things"])
        put = [Command("put", named, **place, at=meta.start_pos) for place in rest if isinstance(place, dict)]
        return [*put, Command("stand_up", named, at=meta.start_pos)]

    def stamp(self, meta: Any, parts: list[Noun]) -> list[Command]:
        it = Noun(pronoun="it", text="stamp", at=meta.start_pos)
        return [Command("stamp", (it,), "on", parts[0], at=meta.start_pos)]

    def swap(self, meta: Any, parts: list[Any]) -> list[Command]:
        named, *other = parts
        return self.__default__("swap", [{"things": (*named["things"], *other)}], meta)

    def row(self, meta: Any, parts: list[Any]) -> list[Command]:
        things, *order, where = parts
        named = things["things"]
        row = tuple(noun.like(named[0]) for noun in order[0]["things"]) if order else named
        row = row if not order or _is_order_of(row, named) else ()
        return self.__default__("row", [{"things": row[::-1] if "right to left" in where else row}], meta)

    def things(self, _: Any, parts: list[Any]) -> dict[str, Any]:
        but = [noun for part in parts if isinstance(part, list) for noun in part]
        named = [part for part in parts if isinstance(part, Noun)]
        if len(named) == 2 and named[0].both_of_two:  # "both the apple and the lemon"
            named[0] = replace(named[0], quantifier="the", count=None)
        return {"things": tuple(noun.without(but) for noun in named)}

    def but(self, _: Any, parts: list[Noun]) -> list[Noun]:
        return parts

    def PRONOUN(self, words: Token) -> Noun:
        return Noun(pronoun="it" if words == "it" else "them", text=str(words), at=words.start_pos or 0)

    def noun(self, meta: Any, parts: list[Any]) -> Noun:
        return noun_of(parts, self._typed[meta.start_pos : meta.end_pos], meta.start_pos)

    def of(self, _: Any, parts: list[Token]) -> Token:
        return Token("OF", " ".join([*(part for part in parts if part.type == "WORD"), "of"]))

    def place(self, meta: Any, parts: list[Any]) -> dict[str, Any]:
        spoken = (parts[0].type, *parts[0].split())
        how = next((_HOW[word] for word in spoken if word in _HOW), parts[0].type.lower())
        if parts[0].type == "CENTRED":
            return {"how": "centred", "place": Noun(words=("table",), text=str(parts[0]), at=meta.start_pos)}
        noun, *but = parts[1:] or [Noun(pronoun="it", text=str(parts[0]), at=meta.start_pos)]
        return {"how": how, "place": noun.without([one for several in but for one in several])}

    def tool(self, _: Any, parts: list[Noun]) -> dict[str, Noun]:
        return {"place": parts[0]}

    def source(self, _: Any, parts: list[Any]) -> dict[str, Noun]:
        return {} if parts[0].of_table else {"source": parts[0]}

    def placed(self, _: Any, parts: list[Any]) -> Noun:
        noun, where = parts
        if noun.words == ("hole",) and isinstance(where, dict) and where["how"] in ("in", "on"):
            block = where["place"]  # "the hole in the block"
            if noun.colour is None and noun.position is None and not block.pronoun:
                return replace(block, words=(*block.words, "of", *noun.words), text=noun.text, at=noun.at)
        several = where if isinstance(where, list) else [where]
        where = [(one["how"], one["place"]) for one in several if one["how"] != "on" or not one["place"].of_table]
        return replace(noun, relations=(*noun.relations, *where))

    def between(self, _: Any, parts: list[Noun]) -> list[dict[str, Any]]:
        left, right = parts
        return [{"how": "right_of", "place": left}, {"how": "left_of", "place": right}]

    def ARM(self, words: Token) -> dict[str, str | None]:
        said = ("left", "right", OTHER_ARM, ONE_ARM)
        return {"arm": next((arm for arm in said if arm in words.split()), None)}

    def __default__(self, data: Any, children: Any, meta: Any) -> Any:  # pyrefly: ignore
        fields: dict[str, Any] = {key: value for part in children for key, value in part.items()}
        return [Command(str(data), **fields, at=meta.start_pos)]
