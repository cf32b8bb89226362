"""A task that is to be said in other words, and the review of each sentence that may say it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

from vcage.base.text import listed, one_line
from vcage.base.words import COLOURS, NUMBERS, SIDES
from vcage.models.quantifiers import quantified
from vcage.objects.mentions import full_names, names_in
from vcage.objects.scene_names import Mention, SceneNames, words_of
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import OF_TWO, AskedGoal, Description, Goal, part_words
from vcage.schema.plan import TABLE

LONGEST = 300
"""Characters of a sentence at most."""

_SAYS: Mapping[str, frozenset[str]] = {
    word: frozenset(said.split())
    for word, said in {
        "inside": "in into inside within",
        "on": "on onto upon top",
        "left_of": "left",
        "right_of": "right",
        "in_front_of": "front before",
        "behind": "behind back rear",
        "beside": "beside next side alongside",
        "near": "near nearby close far",
        "open": "open opened",
        "closed": "close closed shut back",
        "pressed": "press pressed push hit",
        "turned": "turn turned rotate rotated twist swing",
        "weighed": "weigh weighs weighed weight heavy",
        "scanned": "scan scanned scanner code",
        "presented": "customer show present turn front before hand",
        "back": "back return returned stood before",
        "handed": "hand handed pass give transfer arm hands",
    }.items()
}
"""The words that say a goal: one of them must stand in a sentence that asks for it."""

_ASKS_MORE = frozenset(
    word
    for said in (
        "left right front behind back rear open opened close closed shut press pressed turn turned rotate rotated",
        "twist weigh weighs weighed scan scanned customer show return returned",
    )
    for word in said.split()
)
"""Words of goals and sides that may stand only where something that is asked for is said so."""

_SIDES = frozenset(("left", "right", "front", "back", "rear", "behind", "middle", "centre", "center"))
_LEVELS = {"top": "top", "upper": "top", "bottom": "bottom", "lower": "bottom", "middle": "middle"}
_IN_ORDER = frozenset(("then", "afterwards", "afterward", "finally", "followed"))
_FIRST = frozenset(("first", "last", "lastly"))
_NOT = frozenset(("not", "don't", "never", "without", "except", "avoid", "leave", "no", "nothing", "but"))
_VERB_TO_PART = 6
"""Words from the verb that opens or presses a part to the word that says which."""


class TaskWordings(NamedTuple):
    """Sentences that say a task.

    Args:
        sentences: that hold against the review.
        dropped: how many others were proposed that do not.
    """

    sentences: list[str]
    dropped: int = 0


@dataclass(frozen=True)
class TaskToWord:
    """Things that a sentence must ask for to say a task, and things that it may name.

    Args:
        instruction: in plain language.
        goals: what the instruction asks for, by step.
        untouched: ids of objects that it wants left alone.
        descriptions: what it says of where things are at the start.
        things: by object id the catalogue's entries, each with the object's own look only.
        phrases: what the scene calls each object.
        lying: object id → id of what it lies in or on.
        tools: ids of objects that the task is done with.
        catalogue: all kinds: their names must not stand for what is not there.
    """

    instruction: str
    goals: Sequence[AskedGoal]
    untouched: Sequence[str]
    descriptions: Sequence[Description]
    things: Mapping[str, CatalogueEntry]
    phrases: Mapping[str, str]
    lying: Mapping[str, str]
    tools: Sequence[str]
    catalogue: Sequence[CatalogueEntry]

    @cached_property
    def names(self) -> SceneNames:
        """Names of the objects."""
        return SceneNames(self.things, self.phrases, self.descriptions, self.lying)

    @cached_property
    def strangers(self) -> frozenset[tuple[str, ...]]:
        """Names of kinds that no object has."""
        here = {entry.name for entry in self.things.values()}
        absent = full_names(entry for entry in self.catalogue if entry.name not in here)
        return absent - full_names(self.things.values())

    @cached_property
    def quantified(self) -> frozenset[str]:
        """Ids of the objects that fall under a quantifier of the instruction."""
        return self.ranges_over(self.instruction)

    def ranges_over(self, sentence: str) -> frozenset[str]:
        """Ids of the objects that fall under the quantifiers of a sentence."""
        ranging = quantified(sentence)
        return frozenset(name for name, kind in self.things.items() if any(q.covers(kind) for q in ranging))

    @cached_property
    def spoken(self) -> frozenset[str]:
        """Ids of the objects that a sentence may name."""
        of_goals = [name for asked in self.goals for name in (asked.goal.subject, asked.goal.reference)]
        of_descriptions = [name for told in self.descriptions for name in (told.subject, told.reference)]
        named = {*of_goals, *of_descriptions, *self.tools, *self.untouched}
        return frozenset(name for name in self.things if name in named)

    def reviewed(self, sentences: Sequence[str]) -> list[str]:
        """The sentences that have no complaint, each once."""
        return [text for text in dict.fromkeys(sentences) if not self.complaints(text)]

    def complaints(self, sentence: str) -> list[str]:
        """Complaints that keep a sentence from being true of the scene, clear in it, and exactly what is asked for."""
        if not 0 < len(sentence) <= LONGEST or one_line(sentence) != sentence or not sentence.isprintable():
            return [f"a sentence has 1 to {LONGEST} characters, on one line"]
        return [*_Review(self, sentence).complaints()]


class _Review:
    """The review of one sentence."""

    def __init__(self, task: TaskToWord, sentence: str):
        self._task, self._sentence = task, sentence
        self._said = words_of(sentence)
        self._mentions = task.names.mentions(sentence)
        self._taken = {place for m in self._mentions for place in range(m.start, m.end)}
        self._loose = {word for n, word in enumerate(self._said) if n not in self._taken}

    def complaints(self) -> Iterator[str]:
        for mention in self._mentions:
            yield from self._unclear(mention)
        for name in names_in(self._said, self._task.strangers, self._taken):
            yield f"there is no {name!r}"
        for asked in self._task.goals:
            yield from self._unsaid(asked)
        yield from self._extra()
        yield from self._out_of_order()
        yield from self._other_range()

    def _unclear(self, mention: Mention) -> Iterator[str]:
        subjects = {asked.goal.subject for asked in self._task.goals}
        if not mention.ids:
            yield f"{mention.words!r}: there is none"
        elif len(mention.ids) > 1 and not (mention.plural and mention.ids <= subjects):
            yield f"{mention.words!r} may mean {listed(sorted(mention.ids))}"
        elif not mention.ids <= self._task.spoken:
            yield f"{mention.words!r} is nothing that the task is about"
        elif mention.count not in (None, len(mention.ids)) or (mention.plural and len(mention.ids) == 1):
            yield f"{mention.words!r}: there are {len(mention.ids)}"

    # --- what is asked for -----------------------------------------------------------------------------

    def _unsaid(self, asked: AskedGoal) -> Iterator[str]:
        goal, says = asked.goal, _SAYS[asked.goal.relation]
        if not any(goal.subject in mention.ids for mention in self._mentions):
            yield f"names no {self._task.phrases[goal.subject]}, of which {str(goal)!r} is asked"
        elif not any(says & {*span} for span in self._spans(goal)):
            yield f"does not say {str(goal)!r} in one of the words {listed(sorted(says))}"
        elif goal.relation == "handed" and goal.reference not in self._loose:
            yield f"does not say that the {goal.reference} arm has it then"
        if goal.part is not None and not self._says_part(goal, part_words(goal.part)):
            yield f"does not say which part: the {part_words(goal.part)}"
        if asked.arm is not None and not (asked.arm in self._loose and {"arm", "hand", "gripper"} & self._loose):
            yield f"does not say that the {asked.arm} arm does it"

    def _says_part(self, goal: Goal, part: str) -> bool:
        """Check if the sentence says which part is meant; with the goal itself where there are several."""
        parts = {asked.goal.part for asked in self._task.goals if asked.goal.part is not None}
        texts = map(" ".join, self._spans(goal)) if len(parts) > 1 else [" ".join(self._said)]
        return any(_levels(text) >= _levels(part) for text in texts)

    def _spans(self, goal: Goal) -> Iterator[list[str]]:
        """The words that can say a goal: between a mention of its subject and the place that is named next, if that is
        the goal's (where none follows, after the place that was named last); without a place, all from its verb on."""
        if goal.reference != TABLE and goal.reference not in self._task.things:
            verbs = [n for n, word in enumerate(self._said) if word in _SAYS[goal.relation] and n not in self._taken]
            yield from (self._said[n : n + _VERB_TO_PART] for n in verbs)
            return
        for mention in self._mentions:
            if goal.subject in mention.ids:
                after = [place for place in self._places if place[0] >= mention.end and place[1] != mention.ids]
                before = [place for place in self._places if place[0] < mention.start]
                end, ids = after[0] if after else (len(self._said), before[-1][1] if before else frozenset())
                if ids == {goal.reference}:
                    yield self._said[mention.end : end]

    @cached_property
    def _places(self) -> list[tuple[int, frozenset[str]]]:
        """Where the sentence names a reference of a goal."""
        references = {asked.goal.reference for asked in self._task.goals} - {None}
        found = [(m.start, m.ids) for m in self._mentions if m.ids & references]
        if TABLE in references:
            found += [(n, frozenset((TABLE,))) for n, word in enumerate(self._said) if word == TABLE]
        return sorted(found, key=lambda place: place[0])

    # --- what is not asked for -------------------------------------------------------------------------

    def _extra(self) -> Iterator[str]:
        allowed = self._allowed()
        for word in sorted(self._loose):
            if word in _ASKS_MORE | _SIDES and word not in allowed:
                yield f"{word!r} is not asked for"
            elif word in COLOURS or (word in NUMBERS and word not in ("a", "an")):
                yield f"{word!r} says nothing of an object that is named"
        for level in _levels(" ".join(self._loose)) - _levels(" ".join(allowed)) - {"middle"}:
            yield f"{level!r} is not asked for"
        if _NOT & self._loose and not self._task.untouched:
            yield "nothing is to be left alone"
        if {"arm", "arms", "gripper"} & self._loose and not self._armed():
            yield "no arm is asked for"

    def _armed(self) -> set[str]:
        """The arms that the task speaks of."""
        handed = {asked.goal.reference for asked in self._task.goals if asked.goal.relation == "handed"}
        return {arm for arm in {asked.arm for asked in self._task.goals} | handed if arm is not None}

    def _allowed(self) -> set[str]:
        """Words of goals, sides and levels that something is asked for in, or described by."""
        goals = [asked.goal for asked in self._task.goals]
        found = {word for goal in goals for word in _SAYS[goal.relation]} | self._armed()
        for goal in goals:
            found |= {*part_words(goal.part).split()} if goal.part else set()
        for told in self._task.descriptions:
            found |= {*told.relation.split("_")} | ({*part_words(told.part).split()} if told.part else set())
        told_sides = {SIDES[word] for word in found if word in SIDES}
        return found | {word for word, side in SIDES.items() if side in told_sides}

    # --- order and range -------------------------------------------------------------------------------

    def _out_of_order(self) -> Iterator[str]:
        steps = sorted({asked.step for asked in self._task.goals})
        ordered = _IN_ORDER & self._loose
        if len(steps) == 1 and (ordered or _FIRST & self._loose):
            yield "asks for an order, but the goals may come in any"
        elif len(steps) > 1:
            places = [[self._place(asked.goal) for asked in self._task.goals if asked.step == step] for step in steps]
            if not ordered or any(max(a) > min(b) for a, b in pairwise(places)):
                yield f"does not say the {len(steps)} steps in their order, with 'then'"

    def _place(self, goal: Goal) -> int:
        """Where the sentence asks for a goal."""
        own = [m.start for m in self._mentions if goal.subject in m.ids]
        said = [n for n, word in enumerate(self._said) if word in _SAYS[goal.relation] and n not in self._taken]
        return min(own if goal.relation in OF_TWO else said, default=0)

    def _other_range(self) -> Iterator[str]:
        ranging, subjects = self._task.ranges_over(self._sentence), {a.goal.subject for a in self._task.goals}
        nouns = all(quantifier.noun for quantifier in quantified(self._sentence))
        if self._task.quantified:
            if ranging != self._task.quantified:
                yield f"the instruction speaks of all of {listed(sorted(self._task.quantified))}, the sentence does not"
        elif not nouns or not ranging <= subjects:
            yield "speaks of all of something, the instruction does not"
        missing = {*self._task.untouched} - {name for mention in self._mentions for name in mention.ids}
        if missing or (self._task.untouched and not _NOT & self._loose):
            yield f"does not say that {listed(sorted(missing or self._task.untouched))} is to be left alone"


def _levels(text: str) -> frozenset[str]:
    return frozenset(_LEVELS[word] for word in text.split() if word in _LEVELS)
