"""Reads what is put somewhere: things, where from, where to, corrections and exceptions."""

from __future__ import annotations

from dataclasses import dataclass, replace

from vcage.models.rules.phrases import MARKS, Phrase, noun_phrase, noun_phrases
from vcage.models.rules.references import SURFACES, References
from vcage.models.rules.request import ENDS, Request
from vcage.models.rules.tokens import Token

_THROWN = ("throw", "toss", "chuck", "shove", "dump")
_ALONG = ("run", "wave", "swipe")
"""Verbs that mean something only with the scanner: 'run it past the scanner'."""
_SHOWN = (*_ALONG, "hold", "pass", "show", "present")
_PAST = ("past", "through", "across")
"""Verbs, and words, by which a thing is scanned that comes to the scanner."""


@dataclass
class _Move:
    """What is read of things that are moved, while it is read.

    Args:
        things: that are moved.
        begun: where the command began, a token's index.
        takes: whether its verb is one of taking.
        placed: whether it is known where they go.
        tools: what is used for it.
    """

    things: tuple[Phrase, ...]
    begun: int
    takes: bool
    placed: bool = False
    tools: tuple[Phrase, ...] = ()


class Placing(References):
    """Commands that move things."""

    def _put(self, begun: int, *, takes: bool, base: str) -> None:
        """Things and where they go, several times with one verb: 'the apple in the bowl and the pen in the box'."""
        cursor = self._cursor
        if cursor.kind() == "back":
            cursor.take()
            things = self._resolved(noun_phrases(cursor))
            if cursor.kind() in ("prep", "there"):
                self._places_of(things, begun)
                return
            self._require_things(things, begun)
            self._add(Request("back", things), begun)
            return
        if cursor.kind() in ("prep", "toward") and self._waiting and not takes and self._goes_on():
            self._places_of(self._all_waiting(), begun)
            return
        inside = cursor.kind() in ("there", "prep") and cursor.kind(1) in ("article", "quantity", "number", "pronoun")
        particle = cursor.take() if inside and cursor.text() in ("in", "inside", "down", "on", "off", "out") else None
        while cursor.text() in ("down", "out", "hold", "over", "along"):
            cursor.take()
        things = self._resolved(self._movable(noun_phrases(cursor)))
        if particle is not None and cursor.kind() not in ("prep", "toward") and particle.text in ("in", "inside", "on"):
            self._add(self._placed(things, self._known_place(begun), particle.value), begun)
            return
        if not things:
            raise self._refusal(self._words(begun, cursor.at + 1), "nothing is named there")
        while cursor.text() in ("down", "out", "over"):
            cursor.take()
        if base in ("set", "start", "wind", "run") and cursor.kind() not in ("prep", "there", "toward", "back"):
            self._part = things[0]
            self._add(Request("turn", (), things[0]), begun)
            return
        self._places_of(things, begun, takes=takes)

    def _places_of(self, things: tuple[Phrase, ...], begun: int, takes: bool = False) -> None:
        """What follows things that are moved: where from, where to, and further things with their places."""
        move = _Move(things, begun, takes)
        while self._one_place(move):
            pass
        if not move.placed:
            self._waiting, self._things = move.things, move.things
            if not self._announces():
                self._pending |= dict.fromkeys(move.things, self._words(begun, self._cursor.at))

    def _one_place(self, move: _Move) -> bool:
        """Read one more place, or a word about one; whether another may follow."""
        cursor = self._cursor
        self._skip_fillers(move)
        if move.placed and self._adds():
            return False
        if self._instead_follows():
            move.things, move.placed = self._corrected(move.things, move.placed, move.begun)
            return True
        reader = {"back": self._back, "there": self._there, "toward": self._toward, "prep": self._to}.get(cursor.kind())
        if reader is not None and reader(move):
            return True
        if move.placed and self._left_out():
            return True
        if move.placed:
            self._more(move.begun)
        return False

    def _skip_fillers(self, move: _Move) -> None:
        """'down', 'also', a comma or an 'and' before a place: 'off the desk and into the tray'."""
        cursor = self._cursor
        while cursor.text() in ("down", "out", "over", "along", "across", "instead", "straight"):
            cursor.take()
        cursor.skip("also")
        if move.placed:
            return
        if cursor.text() in MARKS and cursor.kind(1) in ("prep", "there", "toward", "back"):
            cursor.take()
        if cursor.kind() == "and" and cursor.kind(1) == "prep" and self._tokens[cursor.at - 1].kind == "word":
            cursor.take()

    def _back(self, move: _Move) -> bool:
        """'… back'; said twice it means the same."""
        self._cursor.take()
        if not (move.placed and self._requests and self._requests[-1].asked == "back"):
            self._require_things(move.things, move.begun)
            self._add(Request("back", move.things), move.begun)
            move.placed = True
        return True

    def _there(self, move: _Move) -> bool:
        """'… in there'; where nothing is known that it could mean it is skipped: 'grab the sign there'."""
        token = self._cursor.take()
        if token.text == "there" and not move.placed and self._part is None and self._place is None:
            return True
        if token.text != "there":
            self._require_clear(self._cursor.at - 1)
        word = "on" if token.text.startswith("on") else "in" if token.text.startswith("in") else self._how
        self._add(self._placed(move.things, self._known_place(move.begun), word), move.begun)
        move.placed = True
        return True

    def _toward(self, move: _Move) -> bool:
        """'… to the customer'."""
        move.placed = self._handed(move.things, move.begun, move.takes) or move.placed
        return True

    def _to(self, move: _Move) -> bool:
        """'… from the bowl', '… into the box'; whether that was read: a second place with one verb is not."""
        cursor = self._cursor
        token = cursor.take()
        if token.value == "from":
            self._taken_out(move.things)
        elif token.value == "with":
            move.tools = noun_phrases(cursor)
            if not (move.tools and all(tool.is_pronoun for tool in move.tools)):  # 'the pens go in there with them'
                raise self._refusal(self._words(move.begun, cursor.at), "what is used for it is not understood")
        elif move.placed:
            cursor.at -= 1
            return False
        elif token.value == "tower":
            self._add(Request("tower", move.things), move.begun)
            move.placed = True
        else:
            if self._tokens[move.begun].base in _ALONG:
                raise self._refusal(self._words(move.begun, self._end_of_clause()), "the robot does not do that")
            place, preposition = self._place_after(token.value, move.things)
            self._add(replace(self._placed(move.things, place, preposition), tools=move.tools), move.begun)
            move.placed = True
        return True

    def _goes_on(self) -> bool:
        """Whether a preposition and a place follow: 'scan it and put in the basket'."""
        at = self._cursor.at
        self._cursor.take()
        phrase = noun_phrase(self._cursor)
        found = phrase is not None and not phrase.is_pronoun and self._is_place(phrase) and self._cursor.kind() in ENDS
        self._cursor.at = at
        return found

    def _more(self, begun: int) -> bool:
        """'… and the pen in the box': further things with one verb."""
        cursor = self._cursor
        at = cursor.at
        also = cursor.text() == "," and cursor.kind(1) == "and"
        also = cursor.text(1 if also else 0) in ("along with", "together with", "as well as", "plus")
        if not cursor.skip("and") and cursor.kind() != "not":
            return False
        negated = cursor.kind() == "not"
        if negated:
            cursor.take()
            if cursor.kind() == "prep":  # '…, not in the bowl': what is denied is not asked for
                cursor.take()
                noun_phrase(cursor)
                return self._more(begun) or True
            if self._at_verb():
                cursor.at = at
                return False
            denied = noun_phrases(cursor)
            if denied and cursor.kind() != "prep":
                self._add(Request("leave", self._inherit(denied, self._things)), begun)
                return True
            cursor.at = at
            return False
        if self._at_verb() or cursor.kind() in ("then", "before", "after", "first"):
            cursor.at = at
            return False
        things = noun_phrases(cursor)
        if things and cursor.kind() in ("prep", "there", "back", "toward"):
            start = at
            self._places_of(self._resolved(self._inherit(things, self._things)), start)
            return True
        if things and (also or cursor.kind() == "also"):
            cursor.skip("also")
            last = self._requests.pop()
            self._requests.append(replace(last, things=(*last.things, *self._resolved(things))))
            return True
        cursor.at = at
        return False

    def _left_out(self) -> bool:
        """'…, except the cereal box': an exception that comes last."""
        cursor = self._cursor
        ahead = 1 if cursor.kind() == "and" else 0
        ahead += cursor.kind(ahead) == "quantity" or cursor.text(ahead) in ("all of them", "them all", "all of it")
        if cursor.kind(ahead) != "except":
            return False
        cursor.at += ahead
        cursor.skip("except")
        denied = noun_phrases(cursor)
        last = self._requests.pop()
        things = tuple(replace(t, but=(*t.but, *denied)) for t in last.things)
        self._requests.append(replace(last, things=things))
        self._things = things
        return True

    def _corrected(self, things: tuple[Phrase, ...], placed: bool, begun: int) -> tuple[tuple[Phrase, ...], bool]:
        """'the apple, no, the banana': what was named last is taken back."""
        cursor = self._cursor
        adds = self._adds()
        cursor.skip("and", "instead", *(("also",) if adds else ()))
        if adds:
            said = noun_phrases(cursor)
            cursor.skip("also")
            if not said:
                raise self._refusal(self._rest(), "whether that is done besides is not clear")
            return (*things, *self._resolved(self._inherit(said, things))), False
        if self._at_verb():
            end = self._end_of_clause()
            adds = any(token.first for token in self._tokens[cursor.at : end])
            if adds:
                raise self._refusal(self._rest(), "whether that is done besides is not clear")
            if placed:
                self._drop_last(begun)
            self._clause()
            return things, True
        if cursor.kind() == "prep" and placed:
            last = self._drop_last(begun)
            place, preposition = self._place_after(cursor.take().value, last.things, last.place)
            self._add(self._placed(last.things, place, preposition), begun)
            return last.things, True
        said = noun_phrases(cursor)
        if not said:
            raise self._refusal(self._rest(), "it corrects nothing")
        if not placed or cursor.kind() == "prep":
            kept = things[:-1] if len(things) > 1 and not placed else ()
            if placed and len(self._drop_last(begun).things) > 1:
                raise self._refusal(self._words(begun, cursor.at), "it is not clear what it corrects")
            return (*kept, *self._resolved(self._inherit(said, things))), False
        last = self._drop_last(begun)
        if len(last.things) > 1 or last.things[0].plural:
            raise self._refusal(self._words(begun, cursor.at), "it is not clear what it corrects")
        named = said[0].lemmas and said[0].lemmas != ("one",)
        if named and not self._is_place(said[0]):  # 'the carrot in the pan, no, the pepper'
            told = (*last.things[:-1], *said)
            self._add(replace(last, things=told), begun)
            return told, True
        place = self._inherit(said[:1], (last.place,) if last.place is not None else ())[0]
        self._add(self._placed(last.things, place, last.preposition), begun)
        return last.things, True

    def _drop_last(self, begun: int) -> Request:
        """Take back the last request of this clause."""
        if not self._requests:
            raise self._refusal(self._words(begun, self._cursor.at), "it corrects nothing")
        return self._requests.pop()

    def _taken_out(self, things: tuple[Phrase, ...]) -> None:
        source = noun_phrase(self._cursor)
        if source is None:
            raise self._refusal(self._rest(), "it names no place")
        if source.is_pronoun:
            source = self._known_place(self._cursor.at)
        if source.lemmas and source.head not in SURFACES:
            self._sources += [(thing, source) for thing in things]

    def _handed(self, things: tuple[Phrase, ...], begun: int, takes: bool = False) -> bool:
        """'to the customer', 'to the left arm'; whether that says where to."""
        token = self._cursor.take()
        value, base = token.value, self._tokens[begun].base
        if base in _THROWN or (base in _ALONG and value != "scanner"):
            raise self._refusal(self._words(begun, self._cursor.at), "the robot does not do that")
        if value.startswith("aside"):
            if self._tokens[begun].verb != "hand" and self._tokens[self._cursor.at - 2].kind != "toward":
                raise self._refusal(token, "it names no place")
            value = value.removeprefix("aside ")
        if value.startswith("from") or (value.startswith("in") and takes):
            self._arms.append((value.split()[-1], self._instruction[token.start : token.end], things))
            return False
        value = value.removeprefix("in ")
        self._require_things(things, begun)
        if value == "customer":
            self._add(Request("present", things), begun)
        elif value == "scanner" and base not in _SHOWN and token.text.split()[0] not in _PAST:
            self._beside_scanner(things, token, begun)
        elif value == "scanner":
            self._add(Request("scan", things), begun)
            self._waiting = things
        else:
            self._add(Request("hand", things, preposition=value), begun)
        return True

    def _beside_scanner(self, things: tuple[Phrase, ...], token: Token, begun: int) -> None:
        """'Put the juice by the scanner': a place, and no scanning."""
        how, _, name = token.text.partition(" the ")
        if how not in ("by", "in front of"):
            raise self._refusal(token, "the robot puts nothing there")
        words = tuple(name.split())
        place = Phrase(name, words, start=token.start)
        self._add(self._placed(things, place, "beside" if how == "by" else "in_front_of"), begun)

    def _place_first(self) -> None:
        """'Into the box go the pens', 'with the scanner, scan the juice'."""
        cursor = self._cursor
        begun = cursor.at
        token = cursor.take()
        phrase = noun_phrase(cursor)
        cursor.skip("and")
        if phrase is None:
            raise self._refusal(self._rest(), "it names no place")
        if phrase.lemmas[-1:] == ("one",) and self._place is not None:
            phrase = self._inherit((phrase,), (self._place,))[0]
        if cursor.kind() == "prep" and cursor.peek().value == "with" and token.value in ("in", "on"):  # pyrefly: ignore
            cursor.take()  # 'into the box with the pens'
            things = self._resolved(noun_phrases(cursor))
            self._require_things(things, begun)
            self._add(self._placed(things, phrase, token.value), begun)
            return
        if token.value == "with":
            count = len(self._requests)
            self._clause()
            self._requests[count:] = [replace(r, tools=(phrase,)) for r in self._requests[count:]]
            return
        if token.value == "from":
            at = cursor.at
            self._clause()
            self._sources += [(thing, phrase) for thing in self._things]
            self._requests = [
                replace(r, sources=tuple((t, phrase) for t in r.things)) if r.start >= self._offset(at) else r
                for r in self._requests
            ]
            return
        cursor.skip("ought", "be", "belong")
        if self._at_verb():
            cursor.take()
        while cursor.text() in ("down",):
            cursor.take()
        things = self._resolved(noun_phrases(cursor))
        self._require_things(things, begun)
        place = self._known_place(begun) if phrase.is_pronoun else phrase
        self._add(self._placed(things, place, token.value), begun)

    def _fill(self, begun: int) -> None:
        """'Fill the bowl with the apples'."""
        cursor = self._cursor
        place = noun_phrase(cursor)
        if place is None or cursor.kind() != "prep" or cursor.take().value != "with":
            raise self._refusal(self._words(begun, cursor.at + 1), "it does not say what with")
        things = self._resolved(noun_phrases(cursor))
        self._require_things(things, begun)
        place = self._known_place(begun) if place.is_pronoun else place
        self._add(self._placed(things, replace(place, count=1), "to"), begun)

    def _filled(self) -> bool:
        """Whether 'with' follows the first thing: 'pack the box with pens'."""
        at = self._cursor.at
        noun_phrase(self._cursor)
        token = self._cursor.peek()
        self._cursor.at = at
        return token is not None and token.kind == "prep" and token.value == "with"

    def _empty(self, begun: int) -> None:
        """'Empty the bowl onto the tray'."""
        cursor = self._cursor
        source = noun_phrase(cursor)
        if source is None or not source.lemmas or source.head in SURFACES:
            raise self._refusal(self._words(begun, cursor.at), "it names nothing that is emptied")
        thing = Phrase("things", ("thing",), count=None, quantity="all", start=source.start)
        self._sources.append((thing, source))
        self._places_of((thing,), begun, takes=True)

    def _gather(self, begun: int) -> None:
        """'Clear the desk: put …', 'tidy the pens into the tray'."""
        cursor = self._cursor
        things = self._movable(noun_phrases(cursor))
        if cursor.text() == "by":
            cursor.take()
            self._waiting = things or self._waiting
            self._clause()
            return
        if things and cursor.kind() in ("prep", "there"):
            self._places_of(self._resolved(things), begun)
            return
        if self._announces():
            self._waiting = things or self._waiting
            return
        raise self._refusal(self._words(begun, cursor.at), "it says no place where that goes")
