"""Reads an instruction: what it asks for, clause by clause, of which things, and in which order.

Every word must be of use: what is neither a thing, nor a place, nor a word that holds a command together, is named and
the instruction refused. A sentence is refused rather than misread.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace

from vcage.base.errors import UnreadInstruction
from vcage.models.rules.lexicon import BASES, FORMS
from vcage.models.rules.phrases import MARKS, Phrase, noun_phrase, noun_phrases
from vcage.models.rules.request import ENDS, Asked, Request
from vcage.models.rules.verbs import KEPT, Verbs, without_last
from vcage.models.rules.wishes import require_tellable

_DONE: dict[str, Asked] = {
    "open": "open", "opened": "open", "closed": "close", "shut": "close", "scanned": "scan", "weighed": "weigh",
    "pressed": "press", "rung": "press", "turned": "turn", "set": "turn", "wound": "turn", "scanning": "scan",
    "weighing": "weigh", "opening": "open", "closing": "close", "ringing": "press", "running": "turn",
}  # fmt: skip
"""'The laptop should be closed', 'it needs weighing': what is wished for, as a command."""

_STATES = ("is", "are", "was", "were", "has been", "have been")
"""'The pen is in the box' is no command."""

_HAPPENED = ("done", "finished", "running", "over", "rung", "ready", "complete")
"""'once it is done': what was asked for before."""


def parse_instruction(
    instruction: str,
    names: Collection[str] = (),
    is_place: Callable[[Phrase], bool] = lambda _: True,
    opens: Callable[[Phrase], bool] = lambda phrase: phrase.part is not None,
) -> list[Request]:
    """What an instruction asks for, in the order in which it is to be done; pronouns are resolved.

    Args:
        names: words that things are called by, so that a slip of the pen in one is forgiven.
        is_place: whether a phrase may name a place: what 'in the bowl, no, the pan' corrects.
        opens: whether a phrase may name what opens and closes: what 'close it' may mean.

    Raises:
        UnreadInstruction: some of its words are of no use, or it asks for nothing; names the words.
    """
    try:
        return _Reader(instruction, names, is_place, opens).read()
    except UnreadInstruction:
        require_tellable(instruction)
        raise


class _Reader(Verbs):
    """Reads one clause after another."""

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
        if self._arms:
            raise self._refusal(self._arms[0][1], "which arm does it is not the instruction's to say")
        if self._pending:
            raise self._refusal(next(iter(self._pending.values())), "it does not say where that goes")
        named = {thing.head for request in self._requests for thing in request.things}
        for phrase, words in self._announced.items():
            if phrase.head not in named:
                raise self._refusal(words, "nothing is asked for with it")
        found = self._finished()
        if not any(request.asked != "leave" for request in found):
            raise self._refusal("nothing", "it asks for nothing that the robot can do")
        return found

    def _skip_joints(self) -> None:
        """What stands between clauses; 'to' before a verb, too: 'please to put'."""
        cursor = self._cursor
        while cursor.at == 0 and self._is_address():
            cursor.at += 2
        while (
            cursor.kind() in ("and", "then", "stop", "query", "also", "colon")
            or cursor.text() in ("you can", "we can")
            or (cursor.text() == "to" and (following := cursor.peek(1)) is not None and following.bare)
        ):
            token = cursor.take()
            self._sentence = token.end if token.kind in ("stop", "query") else self._sentence

    def _is_address(self) -> bool:
        """'Sweetheart, put …': a word of no use before a command."""
        token, command = self._cursor.peek(), self._cursor.peek(2)
        comma = self._cursor.text(1) == "," and command is not None and command.bare
        return comma and token is not None and token.kind == "word" and not token.verb and token.text not in self._names

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
        if cursor.kind() in ("ask", "remark", "which"):
            self._remark()
            return
        if cursor.kind() == "instead":
            self._corrected_clause()
            return
        early = cursor.kind() in ("before", "after")
        if early:
            kind = cursor.take().kind
            self._order_of_two(kind, begun)
        else:
            count = len(self._requests)
            self._clause()
            if any(token.first for token in self._tokens[begun + 1 : cursor.at - 1]):
                raise self._refusal(self._words(begun, cursor.at), "what comes first is not clear")
            if any(token.first for token in self._tokens[begun : cursor.at]):
                self._come_first(count)
        while self._subordinate_follows():
            cursor.skip("and")
            kind = cursor.take().kind
            if kind == "after" and self._happened():
                continue
            count, main = len(self._requests), self._step
            self._clause(subordinate=True)
            later = self._requests[count:]
            shift = 1 if kind == "before" else -1
            self._requests[count:] = [replace(r, step=max(main + shift, 0)) for r in later]
            self._step = main + 1
        self._require_boundary()

    def _remark(self) -> None:
        """'How heavy is it? Weigh it', 'since I like fruit, …', '… so that people see it': passed by."""
        cursor = self._cursor
        asks, early = cursor.kind() != "remark", not self._requests
        named = []
        words = self._rest()
        ends = ("", "stop", "query") if asks else ("", "stop", "query", "then")
        while cursor.kind() not in ends and (asks or cursor.text() not in MARKS):
            phrase = noun_phrase(cursor) if cursor.kind() in ("article", "quantity", "number") else None
            if phrase is None and cursor.take().text.endswith(" the"):  # 'is the …'
                phrase = noun_phrase(cursor)
            if phrase is not None:
                named.append(without_last(phrase) if phrase.text.split()[-1] in (*BASES, *_DONE) else phrase)
        if asks and (cursor.kind() != "query" or cursor.kind(1) == ""):
            raise self._refusal(words, "it asks a question")
        if early or asks:
            self._things = tuple(named) if len(named) == 1 else ()
            self._waiting = ()
            self._skip_joints()
            if cursor.peek() is not None and named and cursor.kind() != "pronoun" and not self._at_verb():
                raise self._refusal(words, "it asks for nothing")

    def _come_first(self, count: int) -> None:
        """'…, but scan it first': what was asked for last comes before the rest of its sentence."""
        start = next((at for at, r in enumerate(self._requests[:count]) if r.start >= self._sentence), 0)
        earlier, last = self._requests[start:count], self._requests[count:]
        if earlier and last:
            base = min(request.step for request in earlier)
            self._requests[start:count] = [replace(r, step=r.step + 1) for r in earlier]
            self._requests[count:] = [replace(r, step=base) for r in last]
            self._step += 1

    def _same_again(self, begun: int, things: tuple[Phrase, ...] = ()) -> None:
        """'… and so does the bun': the last request with other things."""
        cursor = self._cursor
        loose = self._tokens[begun].text.startswith(("so", "as"))
        again = self._done_last(strict=not loose)
        if not again:
            raise self._refusal(self._rest(), "there is nothing yet to be done again")
        things = things or self._inherit(noun_phrases(cursor), self._things)
        if not things:
            raise self._refusal(self._rest(), "nothing is named there")
        self._do_with(again, things, begun)
        self._require_boundary()

    def _done_last(self, strict: bool) -> list[Request]:
        """All that was asked for last of the same things, or of the same part.

        Args:
            strict: refuse where the last sentence asks for more than that.
        """
        done = [request for request in self._requests if request.asked != "leave"]
        of = [(r.things, None if r.things else r.place) for r in done]
        first = next((at + 1 for at in reversed(range(len(done))) if of[at] != of[-1]), 0)
        stops = [t.end for t in self._tokens if done and t.kind in ("stop", "query") and t.end <= done[-1].start]
        if strict and any(r.start >= max(stops, default=0) for r in done[:first]):
            raise self._refusal(self._rest(), "it is not clear what is done again")
        return done[first:]

    def _do_with(self, requests: Sequence[Request], things: tuple[Phrase, ...], begun: int) -> None:
        """The same with other things."""
        for request in requests:
            if request.things:
                self._add(replace(request, things=self._resolved(things), sources=()), begun)
            elif request.asked in ("open", "close"):
                for thing in things:
                    self._operates(request.asked, thing, begun)
            else:
                for thing in things:
                    self._add(replace(request, place=thing, sources=()), begun)

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
        phrase = noun_phrase(cursor)
        if phrase is not None or cursor.text() in ("that", "this"):
            cursor.skip("article")
            while cursor.kind() in ("be", "ought") or cursor.text() in ("has", "have", "had", "been"):
                cursor.take()
            if cursor.at > at + 1 and cursor.kind() == "there" and self._is_placed(phrase):  # 'once they are in there'
                cursor.take()
                return True
            said = cursor.at > at + 1 and cursor.kind() == "word" and cursor.kind(1) in ENDS
            if said and (cursor.text() in _HAPPENED or self._is_known(cursor.text())):
                cursor.take()
                return True
        cursor.at = at
        return False

    def _is_placed(self, phrase: Phrase | None) -> bool:
        """Whether what is named was to be put somewhere before."""
        placed = [thing for request in self._requests if request.asked == "put" for thing in request.things]
        if phrase is None or phrase.is_pronoun:
            return bool(placed) and set(self._things) <= set(placed)
        return any((thing.head, thing.colour) == (phrase.head, phrase.colour) for thing in placed)

    def _is_known(self, word: str) -> bool:
        """Whether what a participle says was asked for before: 'once the timer has been set'."""
        done = _DONE.get(word, "")
        return any(request.asked == done for request in self._requests)

    def _corrected_clause(self) -> None:
        """'Put the apple on the plate. No, the banana.': what was said last, otherwise."""
        cursor = self._cursor
        begun = cursor.at
        adds = self._adds()
        cursor.skip("and", "instead", *(("also",) if adds else ()))
        if not self._requests or (adds and self._at_verb()):
            return
        if adds:
            self._besides(begun)
            return
        last = self._requests[-1]
        if len(last.things) > 1 or any(thing.plural for thing in last.things):
            raise self._refusal(self._rest(), "it is not clear what it corrects")
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

    def _besides(self, begun: int) -> None:
        """'Actually, the orange too': the same with it, or what is said of it."""
        cursor = self._cursor
        last = self._requests[-1]
        things = self._inherit(noun_phrases(cursor), last.things or ((last.place,) if last.place else ()))
        if things and cursor.kind() in ("prep", "toward", "there", "back"):
            self._places_of(self._resolved(things), begun)
        else:
            self._same_again(begun, things)
        self._require_boundary()

    def _clause_about(self, things: tuple[Phrase, ...], last: Request) -> None:
        things = self._inherit(things, last.things)
        if self._cursor.kind() == "prep":
            self._places_of(things, self._cursor.at)
        else:
            place = things[0] if last.asked in ("open", "close", "press", "turn") else last.place
            self._add(replace(last, things=things, place=place), last.start)

    def _require_boundary(self) -> None:
        cursor = self._cursor
        cursor.skip("also")
        following = cursor.peek(1)
        aside = cursor.kind() == "not" and following is not None and following.verb in ("open", "close")
        if cursor.kind() not in (*ENDS, "colon", "instead") and not aside:
            raise self._refusal(self._rest(), "they have no use there")

    def _clause(self, subordinate: bool = False) -> None:
        """A command, a wish, or what is not to be done."""
        cursor = self._cursor
        if subordinate:
            while cursor.text() in ("you", "have", "has", "had", "are", "finished", "done"):
                cursor.take()
        begun = cursor.at
        self._begun = begun
        self._subordinate, self._could = subordinate, False
        passive, self._passive = self._passive, ()
        if cursor.text() in ("could", "can") and cursor.kind(1) in ("article", "quantity", "number", "pronoun"):
            cursor.take()  # 'could the sponge go in the bowl?'
            self._could = True
        if cursor.text() == "there" and cursor.kind(1) in ("ought", "be"):  # 'there should be a towel in the drawer'
            cursor.take()
            cursor.skip("ought", "be")
        if cursor.kind() == "not":
            cursor.take()
            self._forbidden(neither=self._tokens[begun].text.startswith("neither"))
        elif cursor.kind() == "prep" or cursor.kind() == "toward":
            self._place_first()
        elif cursor.kind() == "back" and self._requests and self._requests[-1].asked in ("put", "scan", "weigh"):
            self._places_of(self._things, begun)  # '… and then back where it was'
        elif passive and cursor.text() in FORMS and cursor.kind(1) in ("prep", "toward", "there", "back", *ENDS):
            self._wished(passive, begun)  # '… and then put in the basket'
        elif self._at_verb(subordinate) and not self._gets_done():
            self._command()
        else:
            self._wish()

    def _gets_done(self) -> bool:
        """'Get the door open', 'get the tap running': a wish."""
        cursor = self._cursor
        at = cursor.at
        things = noun_phrases(cursor) if cursor.take().text == "get" else ()
        last = things[-1].text.split()[-1] if things else ""
        done = last in _DONE if cursor.kind() in ENDS else cursor.text() in (*_DONE, "on")
        cursor.at = at + 1 if things and done else at
        return bool(things) and done

    def _wish(self) -> None:
        """'The pen belongs in the cup', 'the laptop should be closed', 'apple in the bowl'."""
        cursor = self._cursor
        begun = cursor.at
        things = noun_phrases(cursor)
        if things and self._instead_follows():
            kept = things if self._adds() else things[:-1]
            cursor.skip("and", "instead", "also")
            things = (*kept, *self._inherit(noun_phrases(cursor), things))
            cursor.skip("also")
        if not things:
            raise self._refusal(self._rest(), "they say nothing that the robot can do")
        if cursor.text() == "," and cursor.kind(1) in ("prep", "toward", "belong", "ought", "be"):
            cursor.take()
        pointed = cursor.kind(1) == "pronoun" or cursor.text(1) in ("those", "these")
        if cursor.text() == "," and pointed and cursor.kind(2) in ("belong", "ought", "be", "prep"):
            cursor.at += 2  # 'the tape and the glue, they belong …'
        if cursor.text() in ("does", "do", "should") and cursor.kind(1) == "also":
            cursor.at += 2  # '… and the bun does too'
            self._same_again(begun, self._inherit(things, self._things))
            return
        last = things[-1].text.split()[-1:] if things[-1].lemmas else []
        if last and last[0] in _DONE and cursor.kind() in ENDS:  # 'both drawers open, please'
            self._done(_DONE[last[0]], (*things[:-1], without_last(things[-1])), begun)
            return
        if not self._stay_so(things, begun):
            self._wished(self._resolved(things), begun)

    def _stay_so(self, things: tuple[Phrase, ...], begun: int) -> bool:
        """'It should stay open': the other is not to be done; whether it is that."""
        cursor = self._cursor
        at = cursor.at
        cursor.skip("ought", "be")
        if self._tokens[cursor.at - 1].text.startswith(("stay", "remain")) and cursor.text() in KEPT:
            self._keep(things, KEPT[cursor.take().text], begun)
            return True
        cursor.at = at
        return False

    def _wished(self, things: tuple[Phrase, ...], begun: int) -> None:
        """What shall be true of things."""
        cursor = self._cursor
        self._passive = things
        if cursor.kind() == "not":
            self._denied(things)
            return
        states = cursor.text() in _STATES or (self._could and cursor.text() == "be" and cursor.kind(1) == "prep")
        said = cursor.skip("ought", "be", "belong")
        if states and not self._subordinate and not self._is_wished(begun):
            raise self._refusal(self._words(begun, self._end_of_clause()), "it says what is, and asks for nothing")
        if cursor.text() in ("to", "to be"):  # 'I would like the pen to be put …'
            cursor.take()
            cursor.skip("be")
            said = True
        if said and cursor.text() == "," and cursor.kind(1) in ("prep", "there", "toward"):
            cursor.take()
        if not said and cursor.kind() in ENDS and self._repeats(things, begun):
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
            if word == "turned" and cursor.text() == "on" and cursor.kind(1) in ENDS:
                cursor.take()
            self._done(_DONE[word], things, begun)
        elif word == "on" and cursor.kind(1) in ENDS:  # 'make sure that the tap is on'
            cursor.take()
            self._done("turn", things, begun)
        elif (verb := cursor.peek()) is not None and verb.kind == "word" and verb.verb in ("put", "take", "stack"):
            cursor.take()
            self._places_of(things, begun)
        elif cursor.kind() in ("prep", "toward", "there", "back"):
            self._places_of(things, begun)
        elif cursor.kind() == "colon":
            self._waiting = things
            self._announced |= dict.fromkeys(things, self._words(begun, cursor.at))
        else:
            raise self._refusal(self._words(begun, self._end_of_clause()), "they say nothing that the robot can do")

    def _is_wished(self, begun: int) -> bool:
        """Whether 'make sure that' or the like begins the sentence."""
        return any(token.wished for token in self._tokens[: begun + 1] if token.start >= self._sentence)

    def _verb_follows(self) -> bool:
        """Whether a verb stands after the 'and' that comes next."""
        at = self._cursor.at
        self._cursor.skip("and")
        found = self._at_verb()
        self._cursor.at = at
        return found

    def _repeats(self, things: tuple[Phrase, ...], begun: int) -> bool:
        """'scan the milk, then the juice': the same with other things; or things that the next clause says more of."""
        cursor = self._cursor
        before = self._tokens[begun - 1].kind if begun else ""
        done = self._done_last(strict=False)
        if before == "then" and done:
            self._do_with(done, things, begun)
            if done[-1].asked in ("scan", "weigh"):
                self._waiting = things
            return True
        if cursor.text() in MARKS or cursor.kind() in ("query", "colon"):  # 'that notepad? stick it in the tray'
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

    def _done(self, asked: Asked, things: tuple[Phrase, ...], begun: int) -> None:
        for thing in things if asked in ("open", "close", "press", "turn") else [None]:
            if thing is None:
                self._add(Request(asked, things), begun)
            else:
                self._part = thing
                self._add(Request(asked, (), thing), begun)

    def _forbidden(self, neither: bool = False) -> None:
        """'Don't touch the mug', 'not the red one'."""
        cursor = self._cursor
        begun = cursor.at
        verb = ""
        if self._at_verb(any_form=True) or cursor.text() in ("touch", "touching", "moving", "use", "using", "disturb"):
            verb = cursor.take().verb or ""
        cursor.commas_end = not verb and not neither
        things = noun_phrases(cursor)
        cursor.commas_end = False
        if neither:
            things = tuple(replace(thing, count=None) for thing in things)
        if cursor.skip("ought", "be") and cursor.text() in ("moved", "touched"):  # 'neither duck should be moved'
            cursor.take()
        if verb and cursor.text() in ("and", "&") and self._verb_follows():
            raise self._refusal(self._rest(), "whether that is forbidden too is not clear")
        if not things:
            raise self._refusal(self._rest(), "they forbid nothing that is named")
        if cursor.kind() in ("prep", "there"):
            cursor.take()
            if noun_phrase(cursor) is None and cursor.kind() != "":
                raise self._refusal(self._rest(), "they forbid nothing that is named")
            raise self._refusal(self._words(begun, cursor.at), "what a thing shall not be put into is not understood")
        if verb in ("open", "close"):
            self._keep(things, verb, begun)
            return
        if verb in ("press", "turn", "scan", "weigh"):
            self._place = self._place if things[-1].is_pronoun else things[-1]
            things = self._resolved(things) if not things[0].is_pronoun else ((self._part or self._place),)
            self._add(Request("leave", tuple(t for t in things if t), preposition=verb), begun)
            return
        self._add(Request("leave", self._resolved(things)), begun)
