"""Check goals against the verbs of an instruction, its pairs of object and place, and its order."""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from vcage.base.words import PART_WORDS, lemma, tokens
from vcage.models.checked_reading import CheckedReading
from vcage.models.directions import arms, heights, sides
from vcage.models.phrases import compiled, phrase
from vcage.models.which_one import coloured
from vcage.objects.mentions import Noun
from vcage.schema.goals import AskedGoal, Goal, Reading


@dataclass(frozen=True)
class Verb:
    """The verbs that ask for one goal.

    Args:
        words: any that may; a match of the whole word.
        only: phrases that ask for this goal and no other.
    """

    words: re.Pattern[str]
    only: re.Pattern[str] | None = None


def _verb(words: str, *only: str) -> Verb:
    return Verb(compiled(phrase(f"({words})")), compiled(*only) if only else None)


VERBS: Mapping[str, Verb] = {
    "scanned": _verb("scan*", phrase("scan")),
    "weighed": _verb("weigh*", phrase("weigh")),
    "pressed": _verb(
        "press*|push*|ring*|rung*|rang*|click*",
        phrase("ring", not_before="up"),
        phrase("press", not_before="it in / [in] the (drawer|peg) / [in] the _ (drawer|peg)"),
    ),
    "open": _verb("open|opened|opening|pull*", phrase("open (the|it|that|both)")),
    "closed": _verb("clos*|shut*|push*|press*", phrase("(shut|close) (the|it|that|both)")),
    "turned": _verb("turn*|switch*|start*|run*", phrase("(turn|switch) on")),
    "turned_back": _verb("turn*|switch*|stop*", phrase("(turn|switch) off")),
    "in_place_of": _verb("swap*|exchang*|where|place*|put*"),
    "back": _verb("back|return*"),
    "moved_away": _verb("away|aside|outwards"),
    "facing_robot": _verb("turn*|rotat*|fac*"),
    "upright": _verb(
        "stand*|stood|set*|put*|plac*|turn*|upright", phrase("upright"), phrase("stand (up|it up|them up)")
    ),
    "held_up": _verb("hold*|held|keep*"),
    "held_by_both": _verb("lift*|rais*|hold*|held|pick*|grab*|tak*", phrase("both (arms|hands)")),
    "lifted": _verb("lift*|rais*"),
    "shaken": _verb("shak*|shook"),
    "hit": _verb("hit*|beat*|tap|taps|tapp*|strik*|struck"),
    "wiped": _verb("wip*|clean*"),
    "poured": _verb("pour*|empt*|tip|tips|tipp*|dump*"),
    "hung_on": _verb("hang*|hung|hook|hooks|hooked"),
    "inserted_in": _verb("insert*|put*|push*|press*|slid*|stick*|stuck|plug*|plac*|shov*|slip*"),
    "presented": _verb("present*|show*|giv*|hand*|offer*"),
}
"""The verbs by the word of the goal."""


_REFERS_BACK = frozenset(
    ("there", "too", "also", "same", "likewise", "together", "respectively", "each", "other", "others", "rest")
)
"""Words by which a clause refers to another one, so that the nearest place may not be its own."""
_ONCE = "(once|when|as soon as)"
_IS_DONE = (
    "(that|this|it|which) [is|has been] [all] (done|finished|over)"
    " / (that's|this's|it's|which's) [all] (done|finished|over) / done"
)
_THEN = compiled(
    phrase("(then|afterwards|finally|lastly|after that|after this|after which)"),
    *(phrase(f"(once|when|as soon as|after) {done}") for done in _IS_DONE.split(" / ")),
)
_FIRST = compiled(phrase("(but first|before that|before this|before doing so)"))
_BEFORE = compiled(phrase("before", not_before="(that|this|doing so)"))
_AFTER = compiled(phrase("after", not_before="(that|this|which)"), phrase(_ONCE, not_before=_IS_DONE))
_CUES = frozenset(["then", "once", "after", "before", "when", "afterwards", "finally", "lastly"])
_JOINTS = frozenset((",", ".", ";", "and"))
_ENDS = re.compile(r" ?(?:[.;!]|$)")
_MAX_BEGINNING_WORDS = 3
"""Words that may stand before a subordinate clause which begins a sentence: "please, before"."""

Span = tuple[int, int]


def order_complaints(read: CheckedReading) -> list[str]:
    """Complaints about goals whose arm, side, drawer or place is said of another thing, or whose order is not said."""
    return _Clauses(read).complaints()


class _Clauses:
    """The words of an instruction and where they name objects of a reading."""

    def __init__(self, read: CheckedReading) -> None:
        text, said, reading = read.task.text, read.said, read.reading
        self._text, self._words, self._goals = text, text.split(" "), reading.goals
        self._things = {name: entry for name, entry in read.things.items() if name in reading.in_goals}
        self._meant = {noun.at: names for noun in said if (names := self._names(noun, said, reading))}
        self._vague = any(len(self._meant.get(noun.at, ())) > 1 and not noun.is_several for noun in said)

    def _names(self, noun: Noun, said: Sequence[Noun], reading: Reading) -> frozenset[str]:
        """The objects of goals that a noun may mean, by its colours and its side."""
        found = {*coloured(noun, self._things)}
        if not noun.name:  # "the blue one"
            before = (other for other in reversed(said) if other.at < noun.at and other.name)
            alike = ({n for n in found if other.may_mean(self._things[n])} for other in before)
            found = next((several for several in alike if several), found)
        side = next((word for word in ("left", "right") if word in tokens(noun.words)), None)
        there = {described.subject for described in reading.descriptions if described.relation == f"{side}_of"}
        return frozenset(found & there if side else found)

    def complaints(self) -> list[str]:
        parts = {part for entry in self._things.values() for part in entry.parts}
        places = {at: next(iter(names)) for at, names in self._of("reference").items() if len(names) == 1}
        handed = any(asked.goal.relation == "handed" for asked in self._goals)
        found = self._mispaired({} if handed else arms(self._text), lambda asked: asked.arm or "no")
        found += self._mispaired(sides(self._text), lambda asked: asked.goal.relation)
        found += self._mispaired(heights(self._text, parts), lambda asked: (asked.goal.part or "").rpartition("_")[2])
        return found + self._mispaired(places, lambda asked: asked.goal.reference) + self._disordered()

    def _of(self, end: str) -> dict[int, frozenset[str]]:
        """Places of nouns that mean subjects of goals alone, or references alone; none where one may mean both."""
        mine = {getattr(asked.goal, end) for asked in self._goals}
        return {at: names for at, names in self._meant.items() if names <= mine}

    def _mispaired(self, others: Mapping[int, str], of: Callable[[AskedGoal], str | None]) -> list[str]:
        if len({*others.values()}) < 2 or not self._clear():
            return []
        said = dict[str, str]()
        for begin, end in self._sentences():
            mine = {at: names for at, names in self._of("subject").items() if begin <= at < end}
            said |= paired(mine, {at: other for at, other in others.items() if begin <= at < end})
        count = Counter(asked.goal.subject for asked in self._goals)
        alone = [asked for asked in self._goals if count[asked.goal.subject] == 1 and asked.goal.subject in said]
        return [
            f"the goal {asked.goal}, arm {asked.arm}, is not what the instruction says, which names "
            f"{said[asked.goal.subject]!r} with {asked.goal.subject}"
            for asked in alone
            if of(asked) not in (None, "", said[asked.goal.subject])
        ]

    def _clear(self) -> bool:
        """Check if each noun means a subject or a reference, and no clause refers to another."""
        one_way = len(self._of("subject")) + len(self._of("reference")) == len(self._meant)
        return one_way and not self._vague and _REFERS_BACK.isdisjoint(self._words)

    def _sentences(self) -> Iterable[Span]:
        ends = [at for at, word in enumerate(self._words) if word in ".;!"]
        return itertools.pairwise([0, *ends, len(self._words)])

    def _disordered(self) -> list[str]:
        """Complaints about goals with steps against the order of the words, or against the needs of their drawer."""
        count = Counter(asked.goal for asked in self._goals)
        places = {asked.goal: self._place(asked) for asked in self._goals if count[asked.goal] == 1}
        at = {goal: place for goal, place in places.items() if place is not None}
        steps = {asked.goal: asked.step for asked in self._goals}
        spans = list(ordered(self._words))
        return [
            f"{goal} comes before {other} in the instruction, but not in the steps of the goals"
            for goal, other in itertools.permutations(at, 2)
            if steps[goal] >= steps[other] and _precedes(goal, other, at, spans)
        ]

    def _place(self, asked: AskedGoal) -> int | None:
        """Place of the last word that a goal needs, each thing or part of it where it is named first."""
        goal = asked.goal
        named = [self._first(name, goal.part) for name in (goal.subject, goal.reference) if name in self._things]
        if goal.relation in VERBS:
            verbs = [at for at, word in enumerate(self._words) if VERBS[goal.relation].words.fullmatch(word)]
            alone = [asked.goal.subject for asked in self._goals].count(goal.subject) == 1
            if len(verbs) > 1 or not (verbs or alone):
                return None
            named += verbs
        return None if None in named else max((at for at in named if at is not None), default=None)

    def _first(self, name: str, part: str | None) -> int | None:
        """Place where an object is named first, or else the part of it."""
        named, parts = [at for at, names in self._meant.items() if name in names], self._things[name].parts
        if not named and part is not None and part in parts:
            kind, _, which = part.partition("_")
            said = {at: PART_WORDS.get(lemma(word)) for at, word in enumerate(self._words)}
            found = heights(self._text, parts) if which else said
            named = [at for at, word in found.items() if word == (which or kind)]
        return min(named, default=None)


def _precedes(goal: Goal, other: Goal, at: Mapping[Goal, int], spans: Sequence[tuple[Span, Span]]) -> bool:
    """Check if words put a goal before another; without such words, what opens or closes a drawer is in their order."""
    if spans:
        return any(first[0] <= at[goal] < first[1] and then[0] <= at[other] < then[1] for first, then in spans)
    part, held = (goal, other) if goal.relation == "open" else (other, goal)
    drawer = held.relation == "inside" and (held.reference, held.part) == (part.subject, part.part)
    return drawer and at[goal] < at[other] and part.relation == ("open" if part is goal else "closed")


def paired(subjects: Mapping[int, Iterable[str]], others: Mapping[int, str]) -> dict[str, str]:
    """Pair each subject with the other that follows its run, or that precedes it; nothing unless each run has one.

    Args:
        subjects: place → ids.
        others: place → what may be said of a subject.
    """
    runs = [list(run) for _, run in itertools.groupby(sorted({*subjects, *others}), key=lambda at: at in others)]
    if len(runs) % 2 or any(len(run) > 1 and run[0] in others for run in runs):
        return {}
    found = dict[str, set[str]]()
    for pair in zip(runs[::2], runs[1::2], strict=True):
        mine, (other,) = sorted(pair, key=lambda run: run[0] in others)
        for name in itertools.chain.from_iterable(subjects[at] for at in mine):
            found.setdefault(name, set()).add(others[other])
    return {name: said.pop() for name, said in found.items() if len(said) == 1}


def ordered(words: Sequence[str]) -> Iterator[tuple[Span, Span]]:
    """Spans of places in a text of words and marks: the content of the first must come before that of the other.

    A leading clause with "before", "after" or "once" ends with a comma.
    """
    text = " ".join(words)
    for pattern, turned in ((_THEN, False), (_FIRST, True), (_BEFORE, True), (_AFTER, False)):
        for found in pattern.finditer(text):
            at = text.count(" ", 0, found.start())
            if pattern is _THEN and _ENDS.match(text[found.end() :]):
                begin = max((place for place in range(at) if words[place] in _JOINTS), default=0)
                spans = (0, begin), (begin, at)
            elif pattern in (_THEN, _FIRST):
                spans = (0, at), (at, len(words))
            elif (split := _subordinate(words, at)) is None:
                continue
            else:
                spans = split
            yield spans[::-1] if turned else spans


def _subordinate(words: Sequence[str], at: int) -> tuple[Span, Span] | None:
    """The spans of a clause that begins at a place, and of its main clause; None where that is unclear."""
    ends = [-1, *(place for place, word in enumerate(words) if word in ".;:!"), len(words)]
    begin, end = next((one + 1, two) for one, two in itertools.pairwise(ends) if two > at)
    comma = next((place for place in range(at, end) if words[place] == ","), end)
    before = ("and", "then", ",") if comma < end else ("and", "then")
    if at - begin >= _MAX_BEGINNING_WORDS and words[at - 1] not in before:
        return (at, comma), (begin, at)
    if comma == end:
        return None
    return (at, comma), (comma, next((place for place in range(comma, end) if words[place] in _CUES), end))
