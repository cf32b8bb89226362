"""What 'it', 'them', 'there', 'the other' and 'the red one' stand for, and which words are of no use."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable
from dataclasses import replace

from vcage.base.errors import UnreadInstruction
from vcage.base.words import COLOURS, colour_of
from vcage.models.rules.phrases import MARKS, Cursor, Phrase, noun_phrase
from vcage.models.rules.request import ENDS, Request
from vcage.models.rules.tokens import Token, tokens

BESIDE = ("beside", "near", "left_of", "right_of", "in_front_of", "behind")

SURFACES = frozenset(("table", "desk", "desktop", "tabletop", "worktop", "counter", "countertop"))
"""What a task happens on."""


class References(ABC):
    """The instruction, how far it is read, what was asked for so far, and what was named last."""

    def __init__(
        self,
        instruction: str,
        names: Collection[str],
        is_place: Callable[[Phrase], bool],
        opens: Callable[[Phrase], bool],
    ):
        self._is_place = is_place
        self._opens = opens
        self._names = names
        self._instruction = instruction
        self._tokens = tokens(instruction, names)
        self._cursor = Cursor(self._tokens)
        self._requests: list[Request] = []
        self._step = 0
        self._begun = 0
        self._subordinate = False
        self._could = False
        """Whether the clause asks whether something could be so."""
        self._sentence = 0
        """Where the present sentence begins, in characters."""
        self._things: tuple[Phrase, ...] = ()
        """What was named last as a thing."""
        self._waiting: tuple[Phrase, ...] = ()
        """What was taken hold of, scanned or announced, and has no place yet."""
        self._place: Phrase | None = None
        self._how = "to"
        """How things were put to that place."""
        self._part: Phrase | None = None
        """What was opened last."""
        self._left: tuple[Phrase, ...] = ()
        """What was last said to be left alone."""
        self._passive: tuple[Phrase, ...] = ()
        """Of what it was said last what shall be done with it: 'the juice should be scanned and put …'."""
        self._sources: list[tuple[Phrase, Phrase]] = []
        self._arms: list[tuple[str, str, tuple[Phrase, ...]]] = []
        """(arm, words that say so, things) that it takes, of use only if they are then given to the other arm."""
        self._pending: dict[Phrase, str] = {}
        """What was taken hold of and must yet be of use, and the words for that."""
        self._announced: dict[Phrase, str] = {}
        """What stands before a colon, of use if something of its like is asked for, and the words for that."""

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
                    raise self._refusal(phrase, "it is not clear what that is")
                found += known
        return tuple(dict.fromkeys(found))

    def _meant(self, pronoun: Phrase) -> tuple[Phrase, ...]:
        """What 'it' or 'them' stands for: what is waiting for a place, else what was named last."""
        if not pronoun.plural:
            named = self._waiting or self._things
            part = self._part
            if part is not None and (not named or part.start > named[-1].start):
                return (part,)
            if len(named) > 1:
                raise self._refusal(pronoun, "it may be more than one thing")
            return named
        found = self._all_waiting() if self._waiting else self._things
        counts = [phrase.count or 0 for phrase in found]
        if pronoun.count is not None and all(counts) and pronoun.count not in (len(counts), sum(counts)):
            raise self._refusal(pronoun, "it is not clear what these are")
        return found

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
            return self._inherit((phrase,), self._things or self._waiting or self._left)[0]
        return phrase

    def _inherit(self, phrases: tuple[Phrase, ...], before: tuple[Phrase, ...]) -> tuple[Phrase, ...]:
        """Phrases such as 'the red one' or 'the other' with the noun of what was named before."""
        if not before or before[-1].is_pronoun:
            return phrases
        model = before[-1]
        found = []
        for phrase in phrases:
            if (
                len(phrase.lemmas) == 1
                and phrase.head in COLOURS
                and phrase.colour is None
                and model.head != phrase.head
                and (phrase.head != "orange" or model.colour)  # the fruit
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
            if preposition in ("in", "on", "left_of", "right_of") and known is not None:
                return known, preposition
            raise self._refusal(self._words(at - 1, cursor.at + 1), "it names no place")
        if place.is_pronoun and place.text == "each other" and preposition in (*BESIDE, "on") and things:
            return things[-1], preposition
        if (place.quantity in ("all", "both") and not self._is_each(at)) or (
            place.is_pronoun and place.plural and place.text != "the other"
        ):
            raise self._refusal(self._words(at, cursor.at), "a thing goes to one place")
        if place.is_pronoun and place.text == "the other":
            place = replace(place, lemmas=("one",), quantity="rest", count=1)
        if place.is_pronoun:
            self._require_clear(at)
            return self._known_place(at, things), preposition
        if place.head == "one":
            sources = (place for _, place in self._sources[-1:])
            known = [p for p in (self._place, self._part, *sources) if p is not None and p.head != "table"]
            model = before or max(known, key=lambda p: p.start, default=None)
            place = self._inherit((place,), things[-1:] if model is None else (model,))[0]
        if len(place.lemmas) == 1 and place.head in SURFACES and preposition in ("on", "to", "in"):
            return Phrase("table", ("table",), start=place.start), "on"
        if place.lemmas == ("drawer",) and "its" in self._words(at, cursor.at).split() and self._place is not None:
            place = replace(place, lemmas=self._place.lemmas)
        return replace(place, count=place.count if place.plural else 1), preposition

    def _is_each(self, at: int) -> bool:
        return self._tokens[at].text in ("each", "each of", "every")

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

    def _require_clear(self, at: int) -> None:
        """That 'in it', after a bowl was put on a tray, is not the bowl as well as the tray."""
        for last in self._requests[-1:] if self._part is None else ():
            put = last.asked == "put" and last.place is not None
            if put and len(last.things) == 1 and self._is_place(last.things[0]):
                raise self._refusal(self._words(at, at + 1), "it may be more than one thing")

    def _movable(self, phrases: tuple[Phrase, ...]) -> tuple[Phrase, ...]:
        """Without furniture that the task happens on: 'clear the desk' moves no desk."""
        return tuple(p for p in phrases if p.is_pronoun or p.head not in SURFACES)

    def _placed(self, things: tuple[Phrase, ...], place: Phrase | None, preposition: str) -> Request:
        return Request("put", things, place, preposition)

    def _require_things(self, things: tuple[Phrase, ...], begun: int) -> None:
        if not things:
            raise self._refusal(self._words(begun, self._cursor.at + 1), "nothing is named there")

    def _announces(self) -> bool:
        """Whether a colon follows, or a clause that says more: 'take the pen and put it …'."""
        return self._cursor.kind() == "colon"

    def _at_verb(self, any_form: bool = False) -> bool:
        """Whether a verb comes next that can begin a command."""
        token = self._cursor.peek()
        if token is None or token.kind != "word":
            return False
        if token.text in ("build", "make", "have", "leave", "let", "touch"):
            return True
        if token.verb is None:
            return False
        following, second = self._cursor.kind(1), self._cursor.peek(2)
        if following == "and" and token.verb in ("scan", "weigh") and second is not None and second.verb:
            return self._cursor.kind(3) != ""  # 'scan and weigh the tomato'
        gerund = token.text.endswith("ing")
        named = following in ("belong", "ought", "be", "and", "stop", "")
        return (token.bare or gerund or any_form) and not named

    def _instead_follows(self) -> bool:
        """Whether what was said last is taken back next."""
        ahead = 0
        while self._cursor.kind(ahead) == "and":
            ahead += 1
        return self._cursor.kind(ahead) == "instead"

    def _adds(self) -> bool:
        """Whether what stands after 'sorry' or 'actually' is meant besides: 'sorry, and the pen', 'the pen too'."""
        ahead, led, joined = 0, False, False
        while self._cursor.kind(ahead) in ("and", "instead"):
            said = self._cursor.kind(ahead) == "and" and self._cursor.text(ahead) not in (*MARKS, "but")
            joined = joined or (led and said)
            led = led or self._cursor.kind(ahead) == "instead"
            ahead += 1
        ends = ("", "stop", "query", "then", "before", "after", "instead")
        also = listed = False
        if not joined and self._requests and self._names_again(ahead):
            return False
        while self._cursor.kind(ahead) not in ends and not also:
            following = self._cursor.peek(ahead + 1)
            if self._cursor.kind(ahead) == "and" and following is not None and following.bare:
                break  # '…, no, the pen, and ring the bell too'
            listed = listed or self._cursor.kind(ahead) == "and"
            also = self._cursor.kind(ahead) == "also"
            ahead += 1
        if led and also and listed and not joined:  # '…, no, the pen and the ruler too'
            raise self._refusal(self._rest(), "what is done besides is not clear")
        return led and (joined or also)

    def _names_again(self, ahead: int) -> bool:
        """Whether what was named last is named there once more: 'pen in the box, no, pen in the cup as well'."""
        at = self._cursor.at
        self._cursor.at += ahead
        phrase = noun_phrase(self._cursor)
        self._cursor.at = at
        last = self._requests[-1].things
        return phrase is not None and any((phrase.lemmas, phrase.colour) == (t.lemmas, t.colour) for t in last)

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
            self._left = request.things
            return
        if request.asked == "hand":
            self._arms = [arm for arm in self._arms if arm[0] == request.preposition or arm[2] != request.things]
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

    def _said(self, begun: int) -> str:
        """The instruction's own words from a token to here, with those that are left out."""
        at = self._cursor.at
        end = self._tokens[at].start if at < len(self._tokens) else len(self._instruction)
        return self._instruction[self._tokens[begun].start : end].strip()

    def _end_of_clause(self) -> int:
        end = self._cursor.at
        while end < len(self._tokens) and self._tokens[end].kind not in ENDS:
            end += 1
        return end

    def _rest(self) -> str:
        """The words from here to the end of the sentence."""
        at = end = self._cursor.at
        while end < len(self._tokens) and self._tokens[end].kind not in ("stop", "query"):
            end += 1
        return self._words(at, end)

    def _refusal(self, words: str | Token | Phrase, why: str) -> UnreadInstruction:
        if isinstance(words, Token):
            words = self._instruction[words.start : words.end]
        elif isinstance(words, Phrase):
            words = words.as_typed(self._instruction)
        understood = [self._instruction[r.start : r.end] for r in self._requests]
        return UnreadInstruction.of(self._instruction, words, why, list(dict.fromkeys(understood)))

    @abstractmethod
    def _keep(self, things: tuple[Phrase, ...], denied: str, begun: int) -> None:
        """Note that something shall not be opened, or not be closed."""

    @abstractmethod
    def _clause(self, subordinate: bool = False) -> None:
        """A command, a wish, or what is not to be done."""
