"""Reads an instruction: what it asks for, clause by clause, of which things, and in which order.

Every word must be of use: what is neither a thing, nor a place, nor a word that holds a command together, is named and
the instruction refused. A sentence is refused rather than misread.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, replace
from typing import Literal

from vcage.base.errors import UnreadInstruction
from vcage.models.rules.phrases import Cursor, Phrase, noun_phrase, noun_phrases
from vcage.models.rules.tokens import tokens
from vcage.models.rules.words import COLOURS, ORDINALS, PARTS, colour_of, lemma

Asked = Literal["put", "open", "close", "press", "turn", "scan", "weigh", "present", "hand", "tower", "back", "leave"]
"""What a request asks for. ``put`` says where by its preposition; ``leave``: not to be touched."""

_SURFACES = frozenset(("table", "desk", "desktop", "tabletop", "worktop", "counter", "countertop"))
_WHATEVER = ("thing",)
_SHUT, _OPEN = ("shut", "closed", "close", "in"), ("open", "out", "opened")
_DONE = {"open": "open", "opened": "open", "closed": "close", "shut": "close", "scanned": "scan", "weighed": "weigh",
         "pressed": "press", "rung": "press", "turned": "turn", "set": "turn", "wound": "turn"}  # fmt: skip
"""'The laptop should be closed': what is wished for, as a command."""
_IDIOMS: dict[str, Asked] = {
    "ring": "press", "press": "press", "push": "press", "ding": "press", "hit": "press",
    "twist": "turn", "turn": "turn", "wind": "turn",
}  # fmt: skip
"""'give the bell a ring'."""
_ENDS = ("", "and", "then", "stop", "query", "also")
"""Where a clause may end."""
_HAPPENED = ("done", "finished", "running", "over", "rung", "ready", "complete")
_DOING = {"scanning": "scan", "weighing": "weigh", "opening": "open", "closing": "close", "ringing": "press"}


@dataclass(frozen=True)
class Request:
    """One thing that a clause asks for.

    Args:
        asked: what.
        things: what it is done to.
        place: where to, or beside what; None where no place is named.
        preposition: how the place is meant: ``in, on, to, beside, near, left_of, right_of, in_front_of, behind``; for
            ``hand`` the arm that gets it.
        tools: what it is done with ("scan it with the scanner").
        sources: (thing, place) of what is in or on a place at the start ("take the pen out of the cup").
        step: requests of an earlier step come first.
        start, end: the words that ask for it, in characters of the instruction.
    """

    asked: Asked
    things: tuple[Phrase, ...]
    place: Phrase | None = None
    preposition: str = ""
    tools: tuple[Phrase, ...] = ()
    sources: tuple[tuple[Phrase, Phrase], ...] = ()
    step: int = 0
    start: int = 0
    end: int = 0


def parse_instruction(
    instruction: str, names: Collection[str] = (), is_place: Callable[[Phrase], bool] = lambda _: True
) -> list[Request]:
    """What an instruction asks for, in the order in which it is to be done; pronouns are resolved.

    Args:
        names: words that things are called by, so that a slip of the pen in one is forgiven.
        is_place: whether a phrase may name a place: what 'in the bowl, no, the pan' corrects.

    Raises:
        UnreadInstruction: some of its words are of no use, or it asks for nothing; names the words.
    """
    return _Reader(instruction, names, is_place).read()


class _Reader:
    """Reads one clause after another and remembers what 'it', 'them', 'there' and 'inside' stand for."""

    def __init__(self, instruction: str, names: Collection[str], is_place: Callable[[Phrase], bool]):
        self._is_place = is_place
        self._instruction = instruction
        self._tokens = tokens(instruction, names)
        self._cursor = Cursor(self._tokens)
        self._requests: list[Request] = []
        self._step = 0
        self._begun = 0
        self._verb: Asked = "put"
        self._things: tuple[Phrase, ...] = ()
        """What was named last as a thing."""
        self._waiting: tuple[Phrase, ...] = ()
        """What was taken hold of, scanned or announced, and has no place yet."""
        self._place: Phrase | None = None
        self._how = "to"
        """How things were put to that place."""
        self._part: Phrase | None = None
        """What was opened last."""
        self._sources: list[tuple[Phrase, Phrase]] = []
        self._pending: dict[Phrase, str] = {}
        """What was taken hold of and must yet be of use, and the words for that."""

    # --- sentences -------------------------------------------------------------------------------------

    def read(self) -> list[Request]:
        """All requests.

        Raises:
            UnreadInstruction: see :func:`parse_instruction`.
        """
        cursor = self._cursor
        while True:
            self._skip_joints()
            if cursor.peek() is None:
                break
            self._sentence_part()
        if self._pending:
            raise self._refusal(next(iter(self._pending.values())), "it does not say where that goes")
        found = self._finished()
        if not any(request.asked != "leave" for request in found):
            raise self._refusal("nothing", "it asks for nothing that the robot can do")
        return found

    def _skip_joints(self) -> None:
        """What stands between clauses; 'to' before a verb, too: 'please to put'."""
        cursor = self._cursor
        if cursor.at == 0 and cursor.text() == "right" and cursor.text(1) == ",":
            cursor.take()
        while (
            cursor.kind() in (*_ENDS[1:], "colon")
            or cursor.text() in ("you can", "we can")
            or (cursor.text() == "to" and (following := cursor.peek(1)) is not None and following.bare)
        ):
            cursor.take()

    def _finished(self) -> list[Request]:
        """All requests in order, with every place that has parts big enough for all that name it."""
        requests = self._requests
        needed: dict[tuple[str, ...], int] = {}
        for place in (r.place for r in requests if r.place is not None):
            needed[place.lemmas] = max(place.least_parts, needed.get(place.lemmas, 0))
        whole = [
            r if r.place is None else replace(r, place=replace(r.place, least_parts=needed[r.place.lemmas]))
            for r in requests
        ]
        return sorted(whole, key=lambda r: r.step)

    def _sentence_part(self) -> None:
        """One clause with the subordinate clauses that say what comes before or after it."""
        cursor = self._cursor
        begun = cursor.at
        if cursor.kind() == "again":
            cursor.take()
            self._same_again(begun)
            return
        if cursor.kind() == "ask":
            raise self._refusal(self._rest(), "it asks a question")
        if cursor.kind() == "instead":
            self._corrected_clause()
            return
        early = cursor.kind() in ("before", "after")
        if early:
            kind = cursor.take().kind
            self._order_of_two(kind, begun)
        else:
            self._clause()
        while self._subordinate_follows():
            cursor.skip("and")
            kind = cursor.take().kind
            if kind == "after" and self._happened():
                continue
            count, main = len(self._requests), self._step
            self._clause(subordinate=True)
            later = self._requests[count:]
            shift = 1 if kind == "before" else -1
            self._requests[count:] = [replace(r, step=main + shift) for r in later]
            self._step = main + 1
        self._require_boundary()

    def _same_again(self, begun: int) -> None:
        """'… and so does the bun': the last request with other things."""
        cursor = self._cursor
        done = [request for request in self._requests if request.asked != "leave"]
        if not done:
            raise self._refusal(self._rest(), "there is nothing yet to be done again")
        things = self._inherit(noun_phrases(cursor), self._things)
        operated = done[-1].asked in ("open", "close", "press", "turn")
        for thing in things if operated else things[:1]:
            told = replace(done[-1], place=thing) if operated else replace(done[-1], things=self._resolved(things))
            self._add(replace(told, sources=()), begun)
        if not things:
            raise self._refusal(self._rest(), "nothing is named there")
        self._require_boundary()

    def _subordinate_follows(self) -> bool:
        """Whether 'before …' or 'after …' comes next, and a clause that is complete came before it."""
        ahead = 0
        while self._cursor.kind(ahead) == "and":
            ahead += 1
        return self._cursor.kind(ahead) in ("before", "after")

    def _order_of_two(self, kind: str, begun: int) -> None:
        """'Before you close it, put the pen in': the clause that is named first, then the main one."""
        count, base = len(self._requests), self._step
        if kind == "after" and self._happened():
            self._step += 1
            self._skip_joints()
            self._clause()
            return
        self._cursor.commas_end = True
        self._clause(subordinate=True)
        self._cursor.commas_end = False
        subordinate = self._requests[count:]
        self._skip_joints()
        if self._cursor.peek() is None or self._cursor.kind() in ("stop", "query"):
            raise self._refusal(self._words(begun, self._cursor.at), "nothing follows it")
        self._clause()
        main = self._requests[count + len(subordinate) :]
        first, second = (main, subordinate) if kind == "before" else (subordinate, main)
        self._requests[count:] = [
            *(replace(r, step=base + 1) for r in first),
            *(replace(r, step=base + 2) for r in second),
        ]
        self._step = base + 2

    def _happened(self) -> bool:
        """'once it is running, …', 'when that has been done, …' asks for nothing new; whether that came next."""
        cursor = self._cursor
        at = cursor.at
        if noun_phrase(cursor) is not None or cursor.text() in ("that", "this"):
            cursor.skip("article")
            while cursor.kind() in ("be", "ought") or cursor.text() in ("has", "have", "had", "been"):
                cursor.take()
            said = cursor.at > at + 1 and cursor.kind() == "word" and cursor.kind(1) in _ENDS
            if said and (cursor.text() in _HAPPENED or self._is_known(cursor.text())):
                cursor.take()
                return True
        cursor.at = at
        return False

    def _is_known(self, word: str) -> bool:
        """Whether what a participle says was asked for before: 'once the timer has been set'."""
        done = _DONE.get(word, "")
        return any(request.asked == done for request in self._requests)

    def _corrected_clause(self) -> None:
        """'Put the apple on the plate. No, the banana.': what was said last, otherwise."""
        cursor = self._cursor
        while cursor.kind() in ("instead", "and"):
            cursor.take()
        if not self._requests:
            return
        last = self._requests[-1]
        self._requests = [r for r in self._requests if (r.start, r.end) != (last.start, last.end)]
        if cursor.kind() == "prep":
            place, preposition = self._place_after(cursor.take().value)
            self._add(replace(last, place=place, preposition=preposition), last.start)
        elif self._at_verb():
            self._clause()
        else:
            things = noun_phrases(cursor)
            if not things:
                raise self._refusal(self._rest(), "it corrects nothing")
            if cursor.kind() == "prep" or last.place is None or last.asked != "put":
                self._requests.append(last)
                self._clause_about(things, last)
                self._requests.remove(last)
            else:
                self._add(replace(last, things=self._inherit(things, last.things)), last.start)
        self._require_boundary()

    def _clause_about(self, things: tuple[Phrase, ...], last: Request) -> None:
        things = self._inherit(things, last.things)
        if self._cursor.kind() == "prep":
            self._places_of(things, self._cursor.at)
        else:
            place = things[0] if last.asked in ("open", "close", "press", "turn") else last.place
            self._add(replace(last, things=things, place=place), last.start)

    def _instead_follows(self) -> bool:
        """Whether what was said last is taken back next."""
        ahead = 0
        while self._cursor.kind(ahead) == "and":
            ahead += 1
        return self._cursor.kind(ahead) == "instead"

    def _require_boundary(self) -> None:
        cursor = self._cursor
        cursor.skip("also")
        if cursor.kind() not in (*_ENDS, "colon", "instead"):
            raise self._refusal(self._rest(), "they have no use there")

    # --- clauses ---------------------------------------------------------------------------------------

    def _clause(self, subordinate: bool = False) -> None:
        """A command, a wish, or what is not to be done."""
        cursor = self._cursor
        if subordinate:
            while cursor.text() in (
                "you",
                "you've",
                "youve",
                "have",
                "has",
                "had",
                "are",
                "you're",
                "finished",
                "done",
            ):
                cursor.take()
        begun = cursor.at
        self._begun = begun
        if cursor.kind() == "not":
            cursor.take()
            self._forbidden()
        elif cursor.kind() == "prep" or cursor.kind() == "toward":
            self._place_first()
        elif self._at_verb(subordinate):
            self._command()
        else:
            self._wish(subordinate)

    def _at_verb(self, any_form: bool = False) -> bool:
        """Whether a verb comes next that can begin a command."""
        token = self._cursor.peek()
        if token is None or token.kind != "word":
            return False
        if token.text in ("build", "make", "have", "leave", "let", "touch"):
            return True
        if token.verb is None:
            return False
        following = self._cursor.kind(1)
        gerund = token.text.endswith("ing")
        named = following in ("belong", "ought", "be", "and", "stop", "")
        return (token.bare or gerund or any_form) and not named

    def _command(self) -> None:
        cursor = self._cursor
        begun = cursor.at
        token = cursor.take()
        base, verb = token.base or token.text, token.verb
        if base in ("build", "make"):
            self._tower(begun)
        elif base == "leave" and self._left_alone(begun):
            return
        elif base == "touch":
            raise self._refusal(token.text, "nothing is asked for by it")
        elif verb == "fill" or (base in ("pack", "load", "stuff") and self._filled()):
            self._fill(begun)
        elif verb == "empty":
            self._empty(begun)
        elif verb == "open" or verb == "close":
            self._operate(verb, begun)
        elif verb == "put" and self._operated(base, begun):
            return
        elif verb == "press" or verb == "turn":
            self._actuate(verb, begun)
        elif verb == "scan" or verb == "weigh":
            self._measure(verb, begun)
        elif verb == "hand":
            self._hand(begun)
        elif verb == "stack":
            self._stack(begun)
        elif verb == "gather":
            self._gather(begun)
        elif base == "lift" and self._lifted(begun):
            return
        else:
            self._put(begun, takes=verb == "take", base=base)

    def _wish(self, subordinate: bool) -> None:
        """'The pen belongs in the cup', 'the laptop should be closed', 'apple in the bowl'."""
        cursor = self._cursor
        begun = cursor.at
        things = noun_phrases(cursor)
        if not things:
            raise self._refusal(self._rest(), "they say nothing that the robot can do")
        if self._instead_follows():
            cursor.skip("and", "instead")
            things = (*things[:-1], *self._inherit(noun_phrases(cursor), things))
        if cursor.text() == "," and cursor.kind(1) in ("prep", "toward", "belong", "ought", "be"):
            cursor.take()
        if cursor.text() == "," and cursor.kind(1) == "pronoun" and cursor.kind(2) in ("belong", "ought", "be", "prep"):
            cursor.at += 2  # 'the tape and the glue, they belong …'
        elif (
            cursor.text() == ","
            and cursor.text(1) in ("those", "these")
            and cursor.kind(2) in ("belong", "ought", "be")
        ):
            cursor.at += 2
        last = things[-1].text.split()[-1:] if things[-1].lemmas else []
        if last and last[0] in ("open", "closed", "shut") and cursor.kind() in _ENDS:  # 'both drawers open, please'
            self._done(_DONE[last[0]], (*things[:-1], _without_last(things[-1])), begun)
            return
        things = self._resolved(things)
        if cursor.kind() == "not":
            self._denied(things)
            return
        said = cursor.skip("ought", "be", "belong")
        if cursor.text() in ("to", "to be"):  # 'I would like the pen to be put …'
            cursor.take()
            cursor.skip("be")
            said = True
        if said and cursor.text() == "," and cursor.kind(1) in ("prep", "there", "toward"):
            cursor.take()
        if not said and cursor.kind() in _ENDS and self._repeats(things, begun):
            return
        quantity = cursor.kind() == "quantity" and cursor.kind(1) in ("be", "belong", "prep")
        if quantity:
            cursor.take()
            cursor.skip("be", "belong")
        token = cursor.peek()
        handed = token is not None and token.text.endswith("ed") and token.verb in ("put", "hand", "take", "stack")
        while cursor.text() in ("over", "across") or (handed and cursor.kind() == "word"):
            cursor.take()
        word = cursor.text()
        stays = self._tokens[cursor.at - 1].text.startswith(("stay", "remain"))
        if said and (cursor.kind() == "stay" or (stays and word == "put")):
            cursor.take()
            self._add(Request("leave", things), begun)
            return
        if word in _DONE and cursor.kind() == "word":
            cursor.take()
            self._done(_DONE[word], things, begun)
        elif said and word in _DOING:
            cursor.take()
            self._done(_DOING[word], things, begun)
        elif cursor.kind() == "word" and cursor.peek().verb in ("put", "take", "stack"):  # pyrefly: ignore
            cursor.take()
            self._places_of(things, begun)
        elif cursor.kind() in ("prep", "toward", "there", "back"):
            self._places_of(things, begun)
        elif cursor.kind() == "colon" or (not said and not subordinate and cursor.kind() in ("colon",)):
            self._waiting = things
        else:
            raise self._refusal(self._words(begun, self._end_of_clause()), "they say nothing that the robot can do")

    def _repeats(self, things: tuple[Phrase, ...], begun: int) -> bool:
        """'scan the milk, then the juice': the same with other things; or things that the next clause says more of."""
        cursor = self._cursor
        before = self._tokens[begun - 1].kind if begun else ""
        done = [request for request in self._requests if request.asked != "leave"]
        if before == "then" and done:
            last = done[-1]
            operated = last.asked in ("open", "close", "press", "turn")
            for thing in things if operated else things[:1]:
                told = replace(last, place=thing) if operated else replace(last, things=things)
                self._add(replace(told, sources=()), begun)
            if last.asked in ("scan", "weigh"):
                self._waiting = things
            return True
        if cursor.text() == "," or cursor.kind() in ("query", "colon"):  # 'that notepad? stick it in the tray'
            self._waiting = self._things = things
            self._pending |= dict.fromkeys(things, self._words(begun, cursor.at))
            return True
        return False

    def _denied(self, things: tuple[Phrase, ...]) -> None:
        """'The carrot doesn't go in the pot': what follows says where it goes."""
        cursor = self._cursor
        cursor.take()
        cursor.skip("belong", "ought", "be")
        if cursor.kind() != "prep":
            raise self._refusal(self._rest(), "they forbid nothing that is named")
        cursor.take()
        noun_phrase(cursor)
        self._waiting = self._things = things

    def _done(self, asked: str, things: tuple[Phrase, ...], begun: int) -> None:
        for thing in things if asked in ("open", "close", "press", "turn") else [None]:
            if thing is None:
                self._add(Request(asked, things), begun)  # pyrefly: ignore
            else:
                self._part = thing
                self._add(Request(asked, (), thing), begun)  # pyrefly: ignore

    def _forbidden(self) -> None:
        """'Don't touch the mug', 'not the red one'."""
        cursor = self._cursor
        begun = cursor.at
        verb = ""
        if self._at_verb(any_form=True) or cursor.text() in ("touch", "touching", "moving", "use", "using", "disturb"):
            verb = cursor.take().verb or ""
        things = noun_phrases(cursor)
        if not things:
            raise self._refusal(self._rest(), "they forbid nothing that is named")
        if cursor.kind() in ("prep", "there"):
            cursor.take()
            if noun_phrase(cursor) is None and cursor.kind() != "":
                raise self._refusal(self._rest(), "they forbid nothing that is named")
            raise self._refusal(self._words(begun, cursor.at), "what a thing shall not be put into is not understood")
        if verb in ("open", "close", "press", "turn", "scan", "weigh"):
            things = self._resolved(things) if not things[0].is_pronoun else ((self._part or self._place),)  # pyrefly: ignore
            self._add(Request("leave", tuple(t for t in things if t), preposition=verb), begun)
            return
        self._add(Request("leave", self._resolved(things)), begun)

    def _left_alone(self, begun: int) -> bool:
        """'Leave the mug alone', 'leave the mug where it is'."""
        cursor = self._cursor
        at = cursor.at
        things = noun_phrases(cursor)
        ended = cursor.kind() in _ENDS
        if things and (ended or cursor.kind() == "stay" or cursor.text() in ("out", "be")):
            if not ended:
                cursor.take()
            self._add(Request("leave", self._resolved(things)), begun)
            return True
        cursor.at = at
        self._put(begun, takes=False, base="leave")
        return True

    # --- verbs -----------------------------------------------------------------------------------------

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
        if base in ("set", "start", "wind") and cursor.kind() not in ("prep", "there", "toward", "back"):
            self._part = things[0]
            self._add(Request("turn", (), things[0]), begun)
            return
        self._places_of(things, begun, takes=takes)

    def _places_of(self, things: tuple[Phrase, ...], begun: int, takes: bool = False) -> None:
        """What follows things that are moved: where from, where to, and further things with their places."""
        cursor = self._cursor
        placed = False
        tools: tuple[Phrase, ...] = ()
        while True:
            while cursor.text() in ("down", "out", "over", "along", "across", "instead", "straight"):
                cursor.take()
            cursor.skip("also")
            if cursor.text() == "," and not placed and cursor.kind(1) in ("prep", "there", "toward", "back"):
                cursor.take()
            kind = cursor.kind()
            if self._instead_follows():
                things, placed = self._corrected(things, placed, begun)
                continue
            if kind == "back" and placed and self._requests and self._requests[-1].asked == "back":
                cursor.take()
                continue
            if kind == "back":
                cursor.take()
                self._require_things(things, begun)
                self._add(Request("back", things), begun)
                placed = True
            elif (
                kind == "there"
                and not placed
                and self._part is None
                and self._place is None
                and cursor.text() == "there"
            ):
                cursor.take()  # 'grab the sign there'
            elif kind == "there":
                token = cursor.take()
                word = "on" if token.text.startswith("on") else "in" if token.text.startswith("in") else self._how
                self._add(self._placed(things, self._known_place(begun), word), begun)
                placed = True
            elif kind == "toward":
                placed = self._handed(things, begun, takes) or placed
            elif kind == "prep" and cursor.peek().value == "from":  # pyrefly: ignore
                cursor.take()
                self._taken_out(things)
            elif kind == "prep" and cursor.peek().value == "with":  # pyrefly: ignore
                cursor.take()
                tools = noun_phrases(cursor)
                if tools and all(tool.is_pronoun for tool in tools):
                    continue  # 'the pens go in there with them'
                raise self._refusal(self._words(begun, cursor.at), "what is used for it is not understood")
            elif kind == "prep" and not placed:
                place, preposition = self._place_after(cursor.take().value, things)
                self._add(replace(self._placed(things, place, preposition), tools=tools), begun)
                placed = True
            elif placed and self._left_out():
                continue
            elif placed and self._more(begun):
                return
            else:
                break
        if not placed:
            self._waiting, self._things = things, things
            if not self._announces():
                self._pending |= dict.fromkeys(things, self._words(begun, cursor.at))

    def _left_out(self) -> bool:
        """'…, except the cereal box': an exception that comes last."""
        cursor = self._cursor
        ahead = 1 if cursor.kind() == "and" else 0
        ahead += cursor.kind(ahead) == "quantity" or cursor.text(ahead) in ("all of them", "them all", "all of it")
        if cursor.kind(ahead) != "except":
            return False
        cursor.at += ahead
        cursor.skip("except")
        denied = self._inherit(noun_phrases(cursor), self._things)
        last = self._requests.pop()
        things = tuple(replace(t, but=(*t.but, *denied)) for t in last.things)
        self._requests.append(replace(last, things=things))
        self._things = things
        return True

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

    def _corrected(self, things: tuple[Phrase, ...], placed: bool, begun: int) -> tuple[tuple[Phrase, ...], bool]:
        """'the apple, no, the banana': what was named last is taken back."""
        cursor = self._cursor
        while cursor.kind() in ("and", "instead"):
            cursor.take()
        if self._at_verb():
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
            if placed:
                self._drop_last(begun)
            return (*kept, *self._resolved(self._inherit(said, things))), False
        last = self._drop_last(begun)
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
        if source.lemmas and source.head not in _SURFACES:
            self._sources += [(thing, source) for thing in things]

    def _handed(self, things: tuple[Phrase, ...], begun: int, takes: bool = False) -> bool:
        """'to the customer', 'to the left arm'; whether that says where to."""
        value = self._cursor.take().value
        if value.startswith("from") or (value.startswith("in") and takes):
            return False
        value = value.removeprefix("in ")
        self._require_things(things, begun)
        if value == "customer":
            self._add(Request("present", things), begun)
        elif value == "scanner":
            self._add(Request("scan", things), begun)
            self._waiting = things
        else:
            self._add(Request("hand", things, preposition=value), begun)
        return True

    def _place_first(self) -> None:
        """'Into the box go the pens', 'with the scanner, scan the juice'."""
        cursor = self._cursor
        begun = cursor.at
        token = cursor.take()
        phrase = noun_phrase(cursor)
        cursor.skip("and")
        if phrase is None:
            raise self._refusal(self._rest(), "it names no place")
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
        if source is None or not source.lemmas or source.head in _SURFACES:
            raise self._refusal(self._words(begun, cursor.at), "it names nothing that is emptied")
        thing = Phrase("things", _WHATEVER, count=None, quantity="all", start=source.start)
        self._sources.append((thing, source))
        self._places_of((thing,), begun, takes=True)

    def _operate(self, verb: str, begun: int) -> None:
        """'Open the top drawer', 'shut it', 'open up the laptop'."""
        cursor = self._cursor
        parts = noun_phrases(cursor)
        if not parts:
            raise self._refusal(self._words(begun, cursor.at + 1), "it does not say what")
        shut = cursor.text() in _SHUT and cursor.kind() in ("word", "prep")
        if cursor.text() in (*_SHUT, *_OPEN) and cursor.kind(1) in _ENDS:
            cursor.take()
        elif parts[-1].lemmas[-1:] and parts[-1].text.split()[-1] in ("shut", "closed", "open"):
            shut = parts[-1].text.split()[-1] != "open"
            parts = (*parts[:-1], _without_last(parts[-1]))
        asked = "close" if verb == "close" or shut else "open"
        for part in self._corrected_parts(parts):
            self._operates(asked, part, begun)

    def _corrected_parts(self, parts: tuple[Phrase, ...]) -> tuple[Phrase, ...]:
        """'the top drawer, sorry, the bottom one'."""
        cursor = self._cursor
        while self._instead_follows():
            cursor.skip("and", "instead")
            if self._at_verb():
                return ()
            said = noun_phrases(cursor)
            if not said:
                raise self._refusal(self._rest(), "it corrects nothing")
            parts = (*parts[:-1], *self._inherit(said, parts))
        return parts

    def _operates(self, asked: str, part: Phrase, begun: int) -> None:
        if part.is_pronoun:
            known = self._part or self._place or (self._things[-1] if self._things else None)
            if part.plural:
                opened = [r.place for r in self._requests if r.asked == "open" and r.place is not None]
                for place in opened if len(opened) > 1 else []:
                    self._add(Request("close" if asked == "close" else "open", (), place), begun)
                if len(opened) > 1:
                    return
            if known is None:
                raise self._refusal(part.text, "it is not clear what that is")
            part = known
        self._part = part
        self._add(Request(asked, (), part), begun)  # pyrefly: ignore

    def _operated(self, base: str, begun: int) -> bool:
        """'Pull the drawer open', 'push it shut', 'push the button'; whether it is one of these."""
        cursor = self._cursor
        at = cursor.at
        how = (
            cursor.take().text if cursor.kind() == "word" and cursor.text() in ("open", "shut", "closed", "out") else ""
        )
        parts = noun_phrases(cursor)
        if (
            parts
            and not how
            and parts[-1].text.split()[-1:]
            and parts[-1].text.split()[-1] in ("open", "shut", "closed", "out")
        ):
            how = parts[-1].text.split()[-1]
            parts = (*parts[:-1], _without_last(parts[-1]))
        hows = (
            "shut",
            "closed",
            "open",
            *(("in", "out") if base in ("push", "shove", "slide", "pull", "yank") else ()),
        )
        if parts and not how and cursor.text() in hows and cursor.kind(1) in _ENDS:
            how = cursor.take().text
        ended = cursor.kind() in _ENDS
        if not parts or not ended:
            cursor.at = at
            return False
        if how:
            for part in parts:
                self._operates("open" if how in _OPEN else "close", part, begun)
            return True
        if parts[0].part in ("button",) or parts[0].lemmas[-1:] in (("button",), ("bell",)):
            for part in parts:
                self._add(Request("press", (), part), begun)
            return True
        if parts[0].part in ("drawer", "door", "lid") and base in ("pull", "yank"):
            for part in parts:
                self._operates("open", part, begun)
            return True
        cursor.at = at
        return False

    def _lifted(self, begun: int) -> bool:
        """'Lift the lid': open it."""
        cursor = self._cursor
        at = cursor.at
        part = noun_phrase(cursor)
        if part is not None and part.part in ("lid", "cover", "screen") and cursor.kind() in _ENDS:
            self._operates("open", part, begun)
            return True
        cursor.at = at
        return False

    def _actuate(self, verb: str, begun: int) -> None:
        """'Ring the bell', 'turn on the tap', 'turn the dial'."""
        cursor = self._cursor
        if cursor.text() in ("on", "up", "around", "round") and cursor.kind() == "prep":
            cursor.take()
        down = cursor.text() == "down"
        if down:
            cursor.take()
        things = noun_phrases(cursor)
        if things and things[0].text.split()[0] == "on" and verb == "turn":
            raise self._refusal(self._words(begun, cursor.at), "that is not understood")
        if cursor.text() in ("on", "around", "round", "down") and cursor.kind(1) in (
            "",
            "and",
            "then",
            "stop",
            "query",
            "instead",
        ):
            cursor.take()
        if not things or cursor.text() == "off":
            raise self._refusal(self._words(begun, cursor.at + 1), "it does not say what, or how")
        for thing in self._corrected_parts(things):
            part = self._part if thing.is_pronoun else thing
            if part is None and thing.is_pronoun and self._things:
                part = self._things[-1]
            if part is None:
                raise self._refusal(thing.text, "it is not clear what that is")
            self._part = part
            self._add(Request("press" if verb == "press" else "turn", (), part), begun)

    def _measure(self, verb: str, begun: int) -> None:
        """'Scan the juice with the scanner', 'weigh two tomatoes on the scale'."""
        cursor = self._cursor
        things = self._resolved(noun_phrases(cursor))
        while self._instead_follows():
            cursor.skip("and", "instead")
            things = (*things[:-1], *self._inherit(noun_phrases(cursor), things))
        self._require_things(things, begun)
        tools: tuple[Phrase, ...] = ()
        place = None
        allowed = ("with", "on", "to", "in") if verb == "weigh" else ("with", "to", "on")
        while cursor.kind() == "prep" and cursor.peek().value in allowed:  # pyrefly: ignore
            token = cursor.take()
            named = noun_phrase(cursor)
            if named is None:
                raise self._refusal(self._rest(), "it names nothing")
            if token.value == "with" or verb == "scan":
                tools = (named,)
            else:
                place = named
        self._add(Request(verb, things, place, "on", tools), begun)  # pyrefly: ignore
        self._waiting = things

    def _hand(self, begun: int) -> None:
        """'Hand the juice to the customer', 'give the customer the receipt', 'pass the pen to your left hand'."""
        cursor = self._cursor
        if cursor.text() in ("out", "over"):
            cursor.take()
        first = noun_phrases(cursor)
        if first and first[0].lemmas and first[0].head in ("customer", "shopper", "client", "buyer", "guest"):
            things = self._resolved(noun_phrases(cursor) or first[1:])
            self._require_things(things, begun)
            self._add(Request("present", things), begun)
            return
        things = self._resolved(first)
        self._require_things(things, begun)
        if cursor.kind() == "colon":
            self._waiting = things
            return
        if cursor.kind() == "article":
            at = cursor.at
            nouns = noun_phrase(cursor)
            asked = _IDIOMS.get(nouns.head if nouns is not None and nouns.lemmas else "")
            if asked is not None and cursor.kind() in _ENDS:
                for thing in things:
                    self._part = thing
                    self._add(Request(asked, (), thing), begun)
                return
            cursor.at = at
        base = self._tokens[begun].base
        if base in ("show", "present", "offer") and cursor.kind() in _ENDS:
            self._add(Request("present", things), begun)
            return
        while cursor.text() in ("over", "out", "across"):
            cursor.take()
        if cursor.kind() == "toward":
            while cursor.kind() == "toward":
                self._handed(things, begun)
            return
        if cursor.kind() == "prep":
            self._places_of(things, begun)
            return
        raise self._refusal(self._words(begun, cursor.at + 1), "it does not say to whom")

    def _stack(self, begun: int) -> None:
        """'Stack the red block on the blue one', 'stack the blocks'."""
        cursor = self._cursor
        things = self._resolved(noun_phrases(cursor))
        self._require_things(things, begun)
        if (
            cursor.kind() == "prep"
            and cursor.text(1) + cursor.text(2) in ("onetower", "atower", "apile", "astack", "onepile", "towerofblocks")
        ) or (cursor.kind() == "prep" and cursor.kind(1) == "article" and cursor.text(2) in ("tower", "pile", "stack")):
            cursor.at += 3
        elif cursor.kind() == "prep" and cursor.text(1) in ("each other", "one another", "each"):
            cursor.at += 2
            cursor.skip("quantity", "number")
            if cursor.text() == "other":
                cursor.take()
        elif cursor.kind() == "prep":
            self._places_of(things, begun)
            return
        self._add(Request("tower", things), begun)

    def _tower(self, begun: int) -> None:
        """'Build a tower from the blocks', 'make a tower of the red and the blue block'."""
        cursor = self._cursor
        cursor.skip("article")
        if cursor.text() not in ("tower", "stack", "pile"):
            raise self._refusal(self._words(begun, cursor.at + 1), "the robot can build nothing but a tower")
        cursor.take()
        if cursor.text() == "of" or cursor.kind() == "prep":
            cursor.take()
        things = self._resolved(noun_phrases(cursor))
        self._require_things(things, begun)
        self._add(Request("tower", things), begun)

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

    # --- what words stand for --------------------------------------------------------------------------

    def _announces(self) -> bool:
        """Whether a colon follows, or a clause that says more: 'take the pen and put it …'."""
        return self._cursor.kind() == "colon"

    def _resolved(self, phrases: Iterable[Phrase]) -> tuple[Phrase, ...]:
        """The phrases, with what pronouns among them stand for."""
        found: list[Phrase] = []
        for phrase in phrases:
            if not phrase.is_pronoun:
                found.append(self._with_head(phrase))
            elif phrase.quantity == "rest" or phrase.text == "the other":
                anything = phrase.text == "everything else"
                found.append(replace(phrase, lemmas=("thing",) if anything else ("one",), quantity="rest"))
                found[-1] = self._with_head(found[-1])
            else:
                known = self._meant(phrase)
                if not known:
                    raise self._refusal(phrase.text, "it is not clear what that is")
                found += known
        return tuple(dict.fromkeys(found))

    def _meant(self, pronoun: Phrase) -> tuple[Phrase, ...]:
        """What 'it' or 'them' stands for: what is waiting for a place, else what was named last."""
        if not pronoun.plural:
            last = (self._waiting or self._things)[-1:]
            part = self._part
            return (part,) if part is not None and (not last or part.start > last[0].start) else last
        return self._all_waiting() if self._waiting else self._things

    def _all_waiting(self) -> tuple[Phrase, ...]:
        """What was scanned, weighed or taken hold of since something was put somewhere."""
        found: list[Phrase] = []
        for request in reversed(self._requests):
            if request.asked not in ("scan", "weigh"):
                break
            found = [*request.things, *found]
        return tuple(dict.fromkeys((*found, *self._waiting)))

    def _with_head(self, phrase: Phrase) -> Phrase:
        """'the red one' is what was named before, in red."""
        if phrase.lemmas and phrase.lemmas[-1] == "one":
            return self._inherit((phrase,), self._things or self._waiting)[0]
        return phrase

    def _inherit(self, phrases: tuple[Phrase, ...], before: tuple[Phrase, ...]) -> tuple[Phrase, ...]:
        """Phrases such as 'the red one' or 'the other' with the noun of what was named before."""
        if not before:
            return phrases
        model = before[-1]
        found = []
        for phrase in phrases:
            if (
                len(phrase.lemmas) == 1
                and phrase.head in COLOURS
                and phrase.colour is None
                and model.head != phrase.head
            ):
                phrase = replace(phrase, lemmas=("one",), colour=colour_of(phrase.head))
            if phrase.is_pronoun and phrase.text == "the other":
                phrase = replace(phrase, lemmas=("one",), quantity="rest", count=1)
            if phrase.lemmas == ("one",) or (phrase.lemmas and phrase.lemmas[-1] == "one" and not phrase.part):
                from_part = model.part is not None
                which = tuple(word for word in phrase.lemmas[:-1])
                phrase = replace(
                    phrase,
                    lemmas=model.lemmas
                    if from_part
                    else (*phrase.lemmas[:-1], *model.lemmas[-1:])
                    if phrase.lemmas[:-1]
                    else model.lemmas,
                    part=model.part,
                    which=which if from_part else (),
                    least_parts=max(model.least_parts, 2) if from_part else 0,
                )
            found.append(phrase)
        return tuple(found)

    def _place_after(
        self, preposition: str, things: tuple[Phrase, ...] = (), before: Phrase | None = None
    ) -> tuple[Phrase | None, str]:
        """The place that follows a preposition.

        Args:
            things: that go there; 'the red one' is one of their like.
            before: the place that was named before it, if it is corrected.
        """
        cursor = self._cursor
        if preposition == "off limits":
            raise self._refusal(self._words(cursor.at - 1, cursor.at + 3), "the robot puts nothing there")
        at = cursor.at
        place = noun_phrase(cursor, exceptions=False)
        if place is None:
            known = self._part or self._place
            if preposition in ("in", "on") and known is not None:
                return known, preposition
            raise self._refusal(self._words(at - 1, cursor.at + 1), "it names no place")
        if place.is_pronoun:
            return self._known_place(at, things), preposition
        if place.head == "one":
            model = before or (self._place if self._place and self._place.head != "table" else None)
            place = self._inherit((place,), things[-1:] if model is None else (model,))[0]
        if len(place.lemmas) == 1 and place.head in _SURFACES and preposition in ("on", "to", "in"):
            return Phrase("table", ("table",), start=place.start), "on"
        if place.lemmas == ("drawer",) and "its" in self._words(at, cursor.at).split() and self._place is not None:
            place = replace(place, lemmas=self._place.lemmas)
        return replace(place, count=place.count if place.plural else 1), preposition

    def _known_place(self, at: int, things: tuple[Phrase, ...] = ()) -> Phrase:
        """The place that was named last; a thing that was, where no place was."""
        part, place = self._part, self._place
        known = part if place is None or (part is not None and part.start > place.start) else place
        others = [t for t in (*self._waiting, *self._things) if t not in things]
        if known is None and len(others) == 1:
            known = others[0]
        if known is None:
            raise self._refusal(self._words(at, at + 1), "it is not clear where that is")
        return known

    def _movable(self, phrases: tuple[Phrase, ...]) -> tuple[Phrase, ...]:
        """Without furniture that the task happens on: 'clear the desk' moves no desk."""
        return tuple(p for p in phrases if p.is_pronoun or p.head not in _SURFACES)

    def _placed(self, things: tuple[Phrase, ...], place: Phrase | None, preposition: str) -> Request:
        return Request("put", things, place, preposition)

    def _require_things(self, things: tuple[Phrase, ...], begun: int) -> None:
        if not things:
            raise self._refusal(self._words(begun, self._cursor.at + 1), "nothing is named there")

    # --- requests and words ----------------------------------------------------------------------------

    def _add(self, request: Request, begun: int) -> None:
        """Note a request; each clause is a step of its own, what one verb does to several things is one."""
        last = self._requests[-1] if self._requests else None
        if begun < len(self._tokens) and not (
            last is not None
            and last.start == self._offset(self._begun)
            and last.asked == request.asked
            and request.asked == "put"
        ):
            self._step += 1
        start = self._offset(self._begun)
        end = self._tokens[min(self._cursor.at, len(self._tokens)) - 1].end
        sources = tuple((thing, place) for thing, place in self._sources if thing in request.things)
        done = replace(request, step=self._step, start=start, end=end, sources=request.sources or sources)
        self._requests.append(done)
        if request.asked == "leave":
            return
        for phrase in (*request.things, *([request.place] if request.place is not None else [])):
            self._pending.pop(phrase, None)
        if request.things:
            self._things = request.things
            self._waiting = ()
        if request.asked == "put" and request.place is not None:
            self._place, self._how = request.place, request.preposition

    def _offset(self, at: int) -> int:
        return self._tokens[min(at, len(self._tokens) - 1)].start if self._tokens else 0

    def _words(self, begun: int, end: int) -> str:
        """The instruction's own words between two tokens."""
        row = self._tokens[max(begun, 0) : max(end, begun + 1)]
        return self._instruction[row[0].start : row[-1].end] if row else ""

    def _end_of_clause(self) -> int:
        end = self._cursor.at
        while end < len(self._tokens) and self._tokens[end].kind not in _ENDS:
            end += 1
        return end

    def _rest(self) -> str:
        """The words from here to the end of the sentence."""
        at = end = self._cursor.at
        while end < len(self._tokens) and self._tokens[end].kind not in ("stop", "query"):
            end += 1
        return self._words(at, end)

    def _refusal(self, words: str, why: str) -> UnreadInstruction:
        understood = [self._instruction[r.start : r.end] for r in self._requests]
        return UnreadInstruction.of(self._instruction, words, why, list(dict.fromkeys(understood)))


def _without_last(phrase: Phrase) -> Phrase:
    """A phrase without its last word: 'the drawer shut' → 'the drawer'."""
    text = " ".join(phrase.text.split()[:-1])
    words = tuple(lemma(word) for word in text.split())
    part = words[-1] if words and words[-1] in PARTS else None
    which = tuple(word for word in words[:-1] if word in ORDINALS) if part else ()
    return replace(phrase, text=text, lemmas=tuple(w for w in words if w not in which), part=part, which=which)
