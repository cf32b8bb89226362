"""Commands of a sentence, made of a tree of the grammar."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from lark import Token, Transformer, Tree, v_args

from vcage.base.words import NUMBERS, lemma
from vcage.models.rules.nouns import Noun, noun_of, with_relations

ONE_ARM, OTHER_ARM = "one", "other"
"""Stand for an arm that is left open, and for the one that was not named before."""


USING = ("hit", "wipe")
"""Verbs of what is done to a thing with a tool in a hand."""


_PUSHED_IN = {"drawer": "close", "button": "press"}
"""Parts of things → the command by which they are pushed in."""


@dataclass(frozen=True)
class Command:
    """One thing that a sentence asks for.

    Args:
        verb: a rule of the grammar: put, pick, open, close, turn, turn_off, press, push_in, weigh, scan, show, hand,
            lift, shake, hit, wipe, pour, hang, insert, hold, in_hands, hold_with_both, away, face, stand_up, stack,
            tower, stamp, row, swap, together; fallen for what lies on its side.
        things: its objects; none where a row or a tower is of other things than those that are named.
        how: in, on, left_of, right_of, in_front_of, behind, beside, near, centred or to; for ``hand`` who gets it.
        place: where things go, or the tool.
        source: where they are taken from.
        source_how: in if they are taken out of the source, off if from its top, where it has one; else to.
        arm: left or right, where one is named; :data:`ONE_ARM` or :data:`OTHER_ARM`.
        group: commands of a lower group come first.
        at: where in the sentence it begins.
        words: of the sentence, from there to the next command.
        typed: the sentence.
        may_be: what its pronoun may be, as typed, where that is a tool or what was hit or wiped with it.
    """

    verb: str
    things: tuple[Noun, ...] = ()
    how: str = ""
    place: Noun | None = None
    source: Noun | None = None
    source_how: str = "to"
    arm: str | None = None
    group: float = 0
    at: int = 0
    words: str = ""
    typed: str = ""
    may_be: tuple[str, ...] = ()

    def pushed_in(self) -> list[Command]:
        """The commands that push its things in: a drawer is closed, a button pressed, anything else inserted."""
        verbs = [_PUSHED_IN.get(noun.part or "", "insert") for noun in self.things]
        return [
            replace(
                self, verb=verb, things=tuple(noun for noun, own in zip(self.things, verbs, strict=True) if own == verb)
            )
            for verb in dict.fromkeys(verbs)
        ]


def nouns_of(commands: Iterable[Command]) -> list[Noun]:
    """All nouns of commands, and those that they are described by."""
    return list(with_relations(*(noun for c in commands for noun in (*c.things, c.place, c.source))))


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
JOINT = re.compile(r"(?:[\s,.;]|\b(?:and|then|but)\b)+$", re.IGNORECASE)
"""Words and signs that join a command to the next."""


def commands_of(tree: Tree[Any], typed: str) -> tuple[Command, ...]:
    """The commands of one reading of a sentence, in order.

    Args:
        tree: of the grammar, without ambiguities.
        typed: the sentence.
    """
    return _Commands(typed).transform(tree)


@v_args(meta=True)
class _Commands(Transformer[Token, Any]):
    """One tree to its commands: parts of a sentence become fields of them, a rule without a method is a verb."""

    def __init__(self, typed: str):
        super().__init__()
        self._typed = typed

    def start(self, _: Any, groups: list[list[Command]]) -> tuple[Command, ...]:
        begun = {command.at for group in groups for command in group}
        ends = {at: min((b for b in begun if b > at), default=None) for at in begun}
        told = {ends[command.at]: command.at for command in groups[0] if command.verb == "fallen"}
        words = {at: JOINT.sub("", self._typed[told.get(at, at) : end]) for at, end in ends.items()}
        return tuple(
            replace(command, group=number, words=words[command.at], typed=self._typed)
            for number, group in enumerate(groups)
            for command in group
        )

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
        (command,) = self.__default__("pour", fields, meta)
        # "Everything out of the cup" is poured by tipping the cup.
        if command.source is not None and [noun.everything for noun in command.things] == [True]:
            return [replace(command, things=(command.source,), source=None, source_how="to")]
        return [command]

    def fallen(self, meta: Any, parts: list[Any]) -> list[Command]:
        """The words of a fallen thing belong to the command after it."""
        # "A bottle has fallen over": it is the one that is spoken of afterwards.
        told = [
            replace(noun, quantifier="the") if noun.quantifier in ("", "a") else noun for noun in parts[0]["things"]
        ]
        return [Command("fallen", tuple(replace(noun, lies=True) for noun in told), at=meta.start_pos)]

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

    def TOGETHER(self, words: Token) -> dict[str, str]:
        return {"how": "near" if words.startswith(("near", "close")) else "beside"}

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

    def source(self, _: Any, parts: list[Any]) -> dict[str, Any]:
        return {} if parts[0].of_table else {"source": parts[0]}

    def out_of(self, _: Any, parts: list[Any]) -> dict[str, Any]:
        return {"source": parts[0], "source_how": "in"}

    def off(self, _: Any, parts: list[Any]) -> dict[str, Any]:
        return self.source(_, parts) | {"source_how": "off"}

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
