"""Reads commands: what each verb asks for, and of what."""

from __future__ import annotations

import re
from dataclasses import replace

from vcage.base.words import ORDINALS, PARTS, lemma
from vcage.models.rules.phrases import Phrase, noun_phrase, noun_phrases
from vcage.models.rules.placing import Placing
from vcage.models.rules.request import ENDS, Asked, Request

_SHUT, _OPEN = ("shut", "closed", "close", "in", "back in"), ("open", "out", "opened")
"""Words after a part that is pushed or pulled."""

_HOWS = ("open", "shut", "closed", "out")

_TOGETHER = re.compile(r"\b(together|combined|in one go)\b", re.IGNORECASE)
"""Words that mean nothing for most verbs."""

KEPT = {"open": "close", "opened": "close", "closed": "open", "shut": "open"}
"""States that something shall stay in → what is not to be done to it."""

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
        elif base in ("leave", "keep"):
            if not self._kept_so(begun) and not (base == "leave" and self._left_alone(begun)):
                self._stays(begun, base)
        elif base == "touch":
            raise self._refusal(token, "nothing is asked for by it")
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

    def _stays(self, begun: int, base: str) -> None:
        """'Leave it on the table': a place for it, if it was not put elsewhere before."""
        count = len(self._requests)
        self._put(begun, takes=False, base=base)
        for request in self._requests[count:]:
            named = {(thing.lemmas, thing.colour) for thing in request.things}
            moved = [r for r in self._requests[:count] if r.asked == "put" and r.place != request.place]
            if any((thing.lemmas, thing.colour) in named for r in moved for thing in r.things):
                raise self._refusal(self._words(begun, self._cursor.at), "it contradicts what was said before")

    def _kept_so(self, begun: int) -> bool:
        """'Leave it open', 'keep the door shut': the other shall not be done; whether it is one of these."""
        cursor = self._cursor
        at = cursor.at
        things = noun_phrases(cursor)
        how = things[-1].text.split()[-1] if things else ""
        if things and cursor.text() in KEPT and cursor.kind() == "word" and cursor.kind(1) in ENDS:
            how = cursor.take().text
        elif how in KEPT and cursor.kind() in ENDS:
            things = (*things[:-1], without_last(things[-1]))
        else:
            cursor.at = at
            return False
        self._keep(things, KEPT[how], begun)
        return True

    def _keep(self, things: tuple[Phrase, ...], denied: str, begun: int) -> None:
        """Note that something shall not be opened, or not be closed."""
        things = tuple(replace(t, quantity="all", count=None) if t.quantity == "a" else t for t in things)  # 'either'
        parts = [known for thing in things for known in (self._operable(thing) if thing.is_pronoun else (thing,))]
        self._part = parts[-1]
        self._add(Request("leave", tuple(dict.fromkeys(parts)), preposition=denied), begun)

    def _left_alone(self, begun: int) -> bool:
        """'Leave the mug alone', 'leave the mug where it is'."""
        cursor = self._cursor
        at = cursor.at
        things = noun_phrases(cursor)
        ended = cursor.kind() in ENDS
        if things and (ended or cursor.kind() == "stay" or cursor.text() in ("out", "be")):
            if not ended:
                cursor.take()
            self._add(Request("leave", self._resolved(things)), begun)
            return True
        cursor.at = at
        return False

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
        while self._instead_follows() and not self._adds():
            cursor.skip("and", "instead")
            if self._at_verb():
                return ()
            said = noun_phrases(cursor)
            if not said:
                raise self._refusal(self._rest(), "it corrects nothing")
            parts = (*parts[:-1], *self._inherit(said, parts))
        return parts

    def _operates(self, asked: str, part: Phrase, begun: int) -> None:
        if (part.quantity == "rest" and part.lemmas in ((), ("one",))) or (
            part.is_pronoun and part.text == "the other"
        ):
            model = self._part or self._place
            if model is None or model.part is None or part.text == "everything else":
                raise self._refusal(part, "it is not clear what that is")
            part = replace(
                model, which=(), quantity="rest", colour=None, text=part.text, start=part.start, count=part.count
            )
        if part.lemmas[-1:] == ("one",) and part.part is None:  # 'close the top one'
            named = [p for p in (self._part, self._place) if p is not None and p.part is not None]
            part = self._inherit((part,), tuple(sorted(named, key=lambda p: p.start)))[0]
        for known in self._operable(part) if part.is_pronoun else (part,):
            self._part = known
            self._add(Request(asked, (), known), begun)  # pyrefly: ignore

    def _operable(self, pronoun: Phrase) -> tuple[Phrase, ...]:
        """What 'it' or 'both' stand for where something is opened or closed."""
        part, place = self._part, self._place
        if pronoun.plural and part is not None and part.plural:
            if part.count is not None and pronoun.count not in (None, part.count):
                raise self._refusal(pronoun, "it is not clear what these are")
            return (part,)
        if pronoun.plural:
            found = self._standing_open()
            things = self._things[-1:] if self._things and self._things[-1].plural else ()
            if len(found) > 1 and pronoun.count in (None, len(found)):
                return tuple(found)
            if found or not things:
                raise self._refusal(pronoun, "it is not clear what these are")
            return things
        if part is not None and place is not None and place.start > part.start and self._opens(place):
            same = place.part == part.part and (place.which == part.which or not place.which)
            if not same or (place.part is None and place.head != part.head):
                raise self._refusal(pronoun, "it may be more than one thing")
        known = part or place or (self._things[-1] if self._things else None)
        if known is None:
            raise self._refusal(pronoun, "it is not clear what that is")
        return (known,)

    def _standing_open(self) -> list[Phrase]:
        """What was opened, or has a part that something was put in or taken out of, and was not closed since."""
        found: dict[tuple[object, ...], Phrase] = {}
        for request in self._requests:
            sources = [place for _, place in request.sources]
            for place in (*sources, *([request.place] if request.place is not None else [])):
                key = (place.lemmas, place.colour, place.part, place.which)
                if request.asked == "close":
                    found.pop(key, None)
                elif request.asked == "open" or (request.asked == "put" and place.part is not None):
                    found.setdefault(key, place)
        return list(found.values())

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
                raise self._refusal(thing, "it is not clear what that is")
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
        while self._instead_follows() and not self._adds():
            cursor.skip("and", "instead")
            things = (*things[:-1], *self._inherit(noun_phrases(cursor), things))
        self._require_things(things, begun)
        if "weigh" in (verb, also) and _TOGETHER.search(self._said(begun)):
            raise self._refusal(self._said(begun), "the robot weighs one thing at a time")
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
