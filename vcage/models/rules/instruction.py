"""Reads an imperative sentence: which things are moved, where to, with what, and how many of each."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from vcage.models.rules.clauses import (
    EMPTYING,
    FILLING,
    FROM,
    GATHERING,
    INTO,
    OPENING,
    PREPOSITION,
    SOURCES,
    TOOL_VERBS,
    clauses,
    plain_clause,
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


def parse_instruction(instruction: str) -> list[Request]:
    """The clauses of an instruction that ask for something to be moved, in order; pronouns are resolved."""
    reader = _Reader()
    for text, announces in clauses(instruction):
        reader.read(plain_clause(text), announces)
    return reader.finish()


class _Reader:
    """Reads one clause after another and remembers what 'it', 'them', 'there' and 'inside' stand for."""

    def __init__(self) -> None:
        self._requests: list[Request] = []
        self._announced: tuple[Phrase, ...] = ()
        self._place: Phrase | None = None
        self._idle: list[Request] = []
        """Clauses that move nothing, asked for only when there are no others: 'Open the drawer'."""

    def read(self, text: str, announces: bool) -> None:
        """Read one clause; ``announces``: a colon follows, so that it says in general what the next one details."""
        verb, _, rest = text.partition(" ")
        if not rest:
            return
        pieces = PREPOSITION.split(rest)
        filled = verb in FILLING and "with" in pieces[1::2] and not set(pieces[1::2]) & set(INTO)
        if filled:
            at = pieces.index("with", 1)
            self._add(verb, pieces[at + 1], parse_place(pieces[0]), ())
        elif verb in EMPTYING and not set(pieces[1::2]) & set(SOURCES) and (place := _place_off_table(pieces[0])):
            goal = next((p for w, p in zip(pieces[1::2], pieces[2::2], strict=True) if w in INTO), "")
            self._requests.append(
                Request(verb, (_WHATEVER,), self._read_place(goal, "into")[0], sources=((_WHATEVER, place),))
            )
        elif verb in OPENING or _pulls_a_part(verb, pieces[0]):
            if not is_pronoun(pieces[0]):
                self._place = parse_place(pieces[0]) or self._place
                self._idle.append(Request(verb, parse_phrases(pieces[0]), None))
        elif announces and not set(pieces[1::2]) & set(INTO):
            self._announced = _movable(parse_phrases(pieces[0]))
        else:
            self._read_moves(verb, pieces)

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

    def _read_moves(self, verb: str, pieces: list[str]) -> None:
        """'the apple in the bowl and the pen in the box' are two requests with one verb."""
        contents = pieces[0]
        tools: tuple[Phrase, ...] = ()
        source: Phrase | None = None
        for preposition, piece in zip(pieces[1::2], pieces[2::2], strict=True):
            if preposition == "using" or (preposition == "with" and verb in TOOL_VERBS):
                tools += tuple(phrase for phrase in parse_phrases(piece) if not is_pronoun(phrase.text))
            if preposition in SOURCES:
                source = _place_off_table(_first_part(piece)[0]) or source
            if preposition in FROM or not contents:
                continue
            place_text, following = _first_part(piece)
            place, on_table = self._read_place(place_text, preposition)
            if place is None and not on_table:
                continue
            self._add(verb, contents, place, tools, source)
            contents, tools, source = following, (), None
        if contents:
            self._add(verb, contents, None, tools, source)

    def _read_place(self, text: str, preposition: str) -> tuple[Phrase | None, bool]:
        """The place, and whether it is the table itself, which is no place to plan for."""
        if not text.strip() or is_pronoun(text) or points_back(text):
            return (self._place, False) if self._place else (None, preposition == "there")
        owned = parse_place(text, self._place)
        if owned is not None and owned.head in _SURFACES and preposition in ("on", "onto", "to"):
            return None, True
        return owned, False

    def _add(
        self,
        verb: str,
        contents: str,
        place: Phrase | None,
        tools: tuple[Phrase, ...],
        source: Phrase | None = None,
    ) -> None:
        """Note a request; a pronoun takes over what was named before and has no place yet."""
        sources: tuple[tuple[Phrase, Phrase], ...] = ()
        fresh: tuple[Phrase, ...] = ()
        again: tuple[Phrase, ...] = ()
        for part in _parts(contents):
            if is_pronoun(part) and (self._requests or self._announced):
                taken, more_tools, moved, started = self._take_over()
                sources += started
                fresh, again, tools = (*fresh, *taken), (*again, *moved), (*more_tools, *tools)
            else:
                named = _movable(parse_phrases(part)) if verb in GATHERING else parse_phrases(part)
                fresh += named
                sources += tuple((phrase, source) for phrase in named if source is not None)
        if place is not None:
            self._place = place
        if fresh or again:
            self._requests.append(Request(verb, fresh, place, again, tools, sources))

    def _take_over(
        self,
    ) -> tuple[tuple[Phrase, ...], tuple[Phrase, ...], tuple[Phrase, ...], tuple[tuple[Phrase, Phrase], ...]]:
        """(things without a place so far, their tools, things that were moved before, where things start)."""
        waiting = [r for r in self._requests if r.receptacle is None]
        last = self._requests[-1] if self._requests else None
        fresh = tuple(phrase for r in waiting for phrase in r.contents)
        tools = tuple(phrase for r in waiting for phrase in r.tools)
        sources = tuple(pair for r in waiting for pair in r.sources)
        again = (*last.contents, *last.again) if last is not None and last.receptacle is not None else ()
        self._requests = [r for r in self._requests if r.receptacle is not None]
        if not fresh and not again:
            fresh, self._announced = self._announced, ()
        return fresh, tools, again, sources


def _pulls_a_part(verb: str, text: str) -> bool:
    place = parse_place(text) if verb in ("pull", "push") else None
    return place is not None and place.part is not None


def _place_off_table(text: str) -> Phrase | None:
    """The place that a text names, if it is not the table itself, where everything is anyway."""
    place = None if not text.strip() or is_pronoun(text) or points_back(text) else parse_place(text)
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
