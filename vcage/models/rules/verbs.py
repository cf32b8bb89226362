"""Reads commands: what each verb asks for, and of what."""

from __future__ import annotations

from dataclasses import replace

from vcage.models.rules.phrases import Phrase, noun_phrase, noun_phrases
from vcage.models.rules.placing import Placing
from vcage.models.rules.request import ENDS, Asked, Request
from vcage.models.rules.words import ORDINALS, PARTS, lemma

_SHUT, _OPEN = ("shut", "closed", "close", "in", "back in"), ("open", "out", "opened")
"""Words after a part that is pushed or pulled."""

_HOWS = ("open", "shut", "closed", "out")

_IDIOMS: dict[str, Asked] = {
    "ring": "press", "press": "press", "push": "press", "ding": "press", "hit": "press",
    "twist": "turn", "turn": "turn", "wind": "turn",
}  # fmt: skip
"""'give the bell a ring'."""


class Verbs(Placing):
    """Commands of every verb."""

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

    def _left_alone(self, begun: int) -> bool:
        """'Leave the mug alone', 'leave the mug where it is'."""
        cursor = self._cursor
        at = cursor.at
        things = noun_phrases(cursor)
        ended = cursor.kind() in ENDS
        if ended and things and things[-1].text.split()[-1:] in (["closed"], ["shut"]):
            things = (*things[:-1], without_last(things[-1]))
        if things and (ended or cursor.kind() == "stay" or cursor.text() in ("out", "be")):
            if not ended:
                cursor.take()
            self._add(Request("leave", self._resolved(things)), begun)
            return True
        cursor.at = at
        self._put(begun, takes=False, base="leave")
        return True

    def _operate(self, verb: str, begun: int) -> None:
        """'Open the top drawer', 'shut it', 'open up the laptop', 'flip open the lid'."""
        cursor = self._cursor
        if cursor.text() in ("open", "shut", "closed"):
            verb = "open" if cursor.take().text == "open" else "close"
        parts = noun_phrases(cursor)
        if not parts:
            raise self._refusal(self._words(begun, cursor.at + 1), "it does not say what")
        shut = cursor.text() in _SHUT and cursor.kind() in ("word", "prep")
        if cursor.text() in (*_SHUT, *_OPEN) and cursor.kind(1) in ENDS:
            cursor.take()
        elif parts[-1].lemmas[-1:] and parts[-1].text.split()[-1] in ("shut", "closed", "open"):
            shut = parts[-1].text.split()[-1] != "open"
            parts = (*parts[:-1], without_last(parts[-1]))
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
        if part.is_pronoun and part.text == "the other":
            if self._part is None:
                raise self._refusal(part.text, "it is not clear what that is")
            model = self._part
            part = replace(model, which=(), quantity="rest", colour=None, text=part.text, start=part.start)
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
        how = cursor.take().text if cursor.kind() == "word" and cursor.text() in _HOWS else ""
        parts = noun_phrases(cursor)
        if parts and not how and parts[-1].text.split()[-1:] in ([word] for word in _HOWS):
            how, parts = parts[-1].text.split()[-1], (*parts[:-1], without_last(parts[-1]))
        hows = (*_HOWS, "in", "back in") if base in ("push", "shove", "slide", "pull", "yank") else _HOWS[:3]
        if parts and not how and cursor.text() in hows and cursor.kind(1) in ENDS:
            how = cursor.take().text
        asked = ("open" if how in _OPEN else "close") if how else ""
        if parts and not how and {"button", "bell"} & {parts[0].part, *parts[0].lemmas[-1:]}:
            asked = "press"
        elif parts and not how and parts[0].part in ("drawer", "door", "lid") and base in ("pull", "yank"):
            asked = "open"
        if not parts or not asked or cursor.kind() not in ENDS:
            cursor.at = at
            return False
        for part in parts:
            self._operates(asked, part, begun)
        return True

    def _lifted(self, begun: int) -> bool:
        """'Lift the lid': open it."""
        cursor = self._cursor
        at = cursor.at
        part = noun_phrase(cursor)
        if (
            part is not None and cursor.text() in ("off", "off of") and cursor.kind(1) not in ENDS
        ):  # 'the lid off the box'
            cursor.take()
            owner = noun_phrase(cursor)
            part = part if owner is None else replace(owner, part=part.part, which=part.which)
        if part is not None and part.part in ("lid", "cover", "screen") and cursor.kind() in ENDS:
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
        if (
            cursor.kind() == "toward" and things and self._tokens[begun].base in ("turn", "rotate", "switch")
        ):  # 'turn the sign to the customer', 'switch it to your left hand'
            self._places_of(self._resolved(things), begun)
            return
        if cursor.text() in ("on", "around", "round", "down") and cursor.kind(1) in (*ENDS, "instead"):
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
        second = cursor.peek(1) if cursor.kind() == "and" else None
        also = second.verb if second is not None and second.bare else None
        if also in ("scan", "weigh"):  # 'scan and weigh the tomato'
            cursor.at += 2
        things = self._resolved(noun_phrases(cursor))
        while self._instead_follows():
            cursor.skip("and", "instead")
            things = (*things[:-1], *self._inherit(noun_phrases(cursor), things))
        self._require_things(things, begun)
        tools: tuple[Phrase, ...] = ()
        place = None
        allowed = ("with", "on", "to", "in") if "weigh" in (verb, also) else ("with", "to", "on")
        while cursor.kind() == "prep" and cursor.peek().value in allowed:  # pyrefly: ignore
            token = cursor.take()
            named = noun_phrase(cursor)
            if named is None:
                raise self._refusal(self._rest(), "it names nothing")
            if token.value == "with" or verb == "scan":
                tools = (named,)
            else:
                place = named
        if also in ("scan", "weigh"):
            self._add(Request(verb, things), begun)  # pyrefly: ignore
            verb = also
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
            if asked is not None and cursor.kind() in ENDS:
                for thing in things:
                    self._part = thing
                    self._add(Request(asked, (), thing), begun)
                return
            cursor.at = at
        base = self._tokens[begun].base
        if base in ("show", "present", "offer") and cursor.kind() in ENDS:
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
        if cursor.kind() == "prep" and cursor.text(1) in ("each other", "one another") and cursor.peek().value == "on":  # pyrefly: ignore
            cursor.at += 2
        elif cursor.kind() == "prep" and cursor.peek().value == "tower":  # pyrefly: ignore
            cursor.take()
        elif cursor.kind() == "prep":
            if len(things) > 1 or things[0].plural:
                raise self._refusal(self._words(begun, cursor.at), "what a stack stands on is not understood")
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


def without_last(phrase: Phrase) -> Phrase:
    """A phrase without its last word: 'the drawer shut' → 'the drawer'."""
    text = " ".join(phrase.text.split()[:-1])
    words = tuple(lemma(word) for word in text.split())
    part = words[-1] if words and words[-1] in PARTS else None
    which = tuple(word for word in words[:-1] if word in ORDINALS) if part else ()
    return replace(phrase, text=text, lemmas=tuple(w for w in words if w not in which), part=part, which=which)
