"""Reads an imperative sentence: which things are moved, where to, with what, and how many of each."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from itertools import chain

from vcage.models.rules.clauses import (
    EMPTYING,
    FILLING,
    FROM,
    GATHERING,
    INTO,
    OPENING,
    SOURCES,
    TOOL_VERBS,
    Clause,
    clauses,
)
from vcage.models.rules.phrases import Phrase, is_pronoun, parse_phrases, parse_place, points_back

_WHATEVER = Phrase("things", ("thing",), None, None)
"""What is in a place that is emptied."""

_SURFACES = frozenset(("table", "desk", "desktop", "tabletop", "worktop", "counter", "countertop"))


@dataclass(frozen=True)
class Request:
    """One clause: ``contents`` go to ``receptacle`` (none when no place is named, or it is the table itself).

    Args:
        again: things that an earlier request moves already, and that this one moves on ("…, then put them…").
        tools: what it is done with ("scan it with the scanner").
        sources: (thing, place) of what is in or on a place at the start ("take the pen out of the cup").
    """

    verb: str
    contents: tuple[Phrase, ...]
    receptacle: Phrase | None
    again: tuple[Phrase, ...] = ()
    tools: tuple[Phrase, ...] = ()
    sources: tuple[tuple[Phrase, Phrase], ...] = ()

    def joined(self, other: Request) -> Request:
        """With all that another request moves, and its tools before the own ones."""
        return replace(
            self,
            contents=(*self.contents, *other.contents),
            again=(*self.again, *other.again),
            tools=(*other.tools, *self.tools),
            sources=(*self.sources, *other.sources),
        )


def parse_instruction(instruction: str) -> list[Request]:
    """The clauses of an instruction that ask for something to be moved, in order; pronouns are resolved."""
    reader = _Reader()
    for clause in clauses(instruction):
        reader.read(clause)
    return reader.finish()


class _Reader:
    """Reads one clause after another and remembers what 'it', 'them', 'there' and 'inside' stand for."""

    def __init__(self) -> None:
        self._requests: list[Request] = []
        self._announced: tuple[Phrase, ...] = ()
        self._place: Phrase | None = None
        self._idle: list[Request] = []
        """Clauses that move nothing, asked for only when there are no others: 'Open the drawer'."""

    def read(self, clause: Clause) -> None:
        """Take in one clause, as the first of these that it is: filling, emptying, opening, an announcement, a move."""
        goal = clause.after(INTO)
        filler = clause.after(("with",))
        if clause.verb in FILLING and filler is not None and goal is None:
            self._add(Request(clause.verb, (), parse_place(clause.object)), filler)
        elif clause.verb in EMPTYING and clause.after(SOURCES) is None and (place := _off_table(clause.object)):
            receptacle, _ = self._read_place(goal or "", "into")
            self._requests.append(Request(clause.verb, (_WHATEVER,), receptacle, sources=((_WHATEVER, place),)))
        elif _opens(clause):
            self._read_opening(clause)
        elif clause.announces and goal is None:
            self._announced = _movable(parse_phrases(clause.object))
        else:
            self._read_moves(clause)

    def finish(self) -> list[Request]:
        """All requests, with every place that has parts ('the upper drawer') big enough for all that name it."""
        found = self._requests
        if not found and self._announced:
            found = [Request("put", self._announced, None)]
        if not found:
            found = [request for request in self._idle if request.contents]
        needed: dict[tuple[str, ...], int] = {}
        for place in (r.receptacle for r in found if r.receptacle is not None):
            needed[place.lemmas] = max(place.least_parts, needed.get(place.lemmas, 0))
        return [
            r if r.receptacle is None
            else replace(r, receptacle=replace(r.receptacle, least_parts=needed[r.receptacle.lemmas]))
            for r in found
        ]  # fmt: skip

    def _read_opening(self, clause: Clause) -> None:
        """What is opened is the place that later clauses mean by 'inside'."""
        if not is_pronoun(clause.object):
            self._place = parse_place(clause.object) or self._place
            self._idle.append(Request(clause.verb, parse_phrases(clause.object), None))

    def _read_moves(self, clause: Clause) -> None:
        """'the apple in the bowl and the pen in the box' are two requests with one verb."""
        contents = clause.object
        tools: tuple[Phrase, ...] = ()
        source: Phrase | None = None
        for preposition, words in clause.adjuncts:
            tools += _tools(clause.verb, preposition, words)
            place_words, following = _first_part(words)
            if preposition in SOURCES:
                source = _off_table(place_words) or source
            if preposition in FROM or not contents:
                continue
            place, on_table = self._read_place(place_words, preposition)
            if place is not None or on_table:
                self._add(Request(clause.verb, (), place, tools=tools), contents, source)
                contents, tools, source = following, (), None
        if contents:
            self._add(Request(clause.verb, (), None, tools=tools), contents, source)

    def _read_place(self, text: str, preposition: str) -> tuple[Phrase | None, bool]:
        """The place, and whether it is the table itself, which is no place to plan for."""
        if _names_no_place(text):
            return (self._place, False) if self._place else (None, preposition == "there")
        owned = parse_place(text, self._place)
        if owned is not None and owned.head in _SURFACES and preposition in ("on", "onto", "to"):
            return None, True
        return owned, False

    def _add(self, request: Request, contents: str, source: Phrase | None = None) -> None:
        """Note a request for what ``contents`` says; a pronoun takes over what was named before and has no place yet.

        Args:
            request: verb, place and tools.
            source: where the contents are at the start.
        """
        for part in _parts(contents):
            if is_pronoun(part) and (self._requests or self._announced):
                request = request.joined(self._take_over())
            else:
                named = parse_phrases(part)
                named = _movable(named) if request.verb in GATHERING else named
                started = () if source is None else tuple((phrase, source) for phrase in named)
                request = request.joined(Request(request.verb, named, None, sources=started))
        self._place = request.receptacle or self._place
        if request.contents or request.again:
            self._requests.append(request)

    def _take_over(self) -> Request:
        """What a pronoun stands for: what is waiting for a place, which waits no longer, and what was moved last."""
        waiting = [r for r in self._requests if r.receptacle is None]
        last = [r for r in self._requests[-1:] if r.receptacle is not None]
        self._requests = [r for r in self._requests if r.receptacle is not None]
        contents = tuple(chain.from_iterable(r.contents for r in waiting))
        again = tuple(chain.from_iterable((*r.contents, *r.again) for r in last))
        if not contents and not again:
            contents, self._announced = self._announced, ()
        tools = tuple(chain.from_iterable(r.tools for r in waiting))
        return Request("move", contents, None, again, tools, tuple(chain.from_iterable(r.sources for r in waiting)))


def _opens(clause: Clause) -> bool:
    """Whether a place is opened or closed: 'shut the box', 'pull the drawer'."""
    place = parse_place(clause.object) if clause.verb in ("pull", "push") else None
    return clause.verb in OPENING or (place is not None and place.part is not None)


def _tools(verb: str, preposition: str, words: str) -> tuple[Phrase, ...]:
    """What is named as a tool: 'scan it with the scanner', but not 'put it with the pens'."""
    if preposition == "using" or (preposition == "with" and verb in TOOL_VERBS):
        return tuple(phrase for phrase in parse_phrases(words) if not is_pronoun(phrase.text))
    return ()


def _names_no_place(text: str) -> bool:
    """Whether the words say nothing, or only point back at what was named before."""
    return not text.strip() or is_pronoun(text) or points_back(text)


def _off_table(text: str) -> Phrase | None:
    """The place that a text names, if it is not the table itself, where everything is anyway."""
    place = None if _names_no_place(text) else parse_place(text)
    return None if place is None or place.head in _SURFACES else place


def _movable(phrases: tuple[Phrase, ...]) -> tuple[Phrase, ...]:
    """Without furniture that the task happens on: 'clear the desk' moves no desk."""
    return tuple(phrase for phrase in phrases if phrase.head not in _SURFACES)


def _parts(text: str) -> list[str]:
    """The text in pieces, such that a pronoun stands alone: 'it and the pen' → 'it', 'the pen'."""
    pieces = [piece for piece in re.split(r",|\band\b", text) if piece.strip()]
    return pieces if any(is_pronoun(piece) for piece in pieces) else [text]


def _first_part(text: str) -> tuple[str, str]:
    """'the bowl and the pen' → ('the bowl', 'the pen')."""
    match = re.search(r",\s*and\b|,|\band\b|&", text)
    if match is None:
        return text, ""
    before, after = text[: match.start()], text[match.end() :]
    return (before, after) if before.strip() else _first_part(after)
