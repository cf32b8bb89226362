"""Review of a sentence for a task: it must be true of the scene, unambiguous in it, and ask for exactly the task."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from functools import cached_property
from itertools import pairwise, takewhile
from typing import TYPE_CHECKING

from vcage.base.text import listed
from vcage.base.words import COLOURS, NUMBERS, SIDES, WHICH_PART
from vcage.goals import KINDS
from vcage.models.quantifiers import quantified
from vcage.objects.mentions import find_names
from vcage.objects.scene_names import Mention, words_of
from vcage.schema.goals import AskedGoal, Description, Goal, in_steps, part_words
from vcage.schema.plan import TABLE


def says(goal: Goal) -> frozenset[str]:
    """The words for a goal: a sentence that asks for it must contain one of them."""
    return frozenset(goal.kind.says.split())


def claimed() -> frozenset[str]:
    """Words of goals and sides that may occur only in a request."""
    return frozenset(SIDES).union(*(kind.claims.split() for kind in KINDS.values()))


IN_ORDER = frozenset(("then", "afterwards", "afterward", "finally", "followed"))
FIRST = frozenset(("first", "last", "lastly"))
NOT = frozenset(("not", "don't", "never", "without", "except", "avoid", "leave", "no", "nothing", "but"))
VERB_TO_PART_WORDS = 6
"""Words from the verb that opens or presses a part to the word that says which."""

FROM = frozenset(("from", "out", "off"))
"""Words before what something is taken from."""

WITHIN = frozenset(("of", "the", "a", "inside", "within", *WHICH_PART))
"""Words that may stand between such a word and the name, with those of a drawer."""

LIES: Mapping[str, frozenset[str]] = {"inside": frozenset(("in", "inside", "within")), "on": frozenset(("on",))}
"""Words by which a name says where its object lies."""


def levels(text: str) -> frozenset[str]:
    """The levels that words name: top, middle, bottom."""
    return frozenset(WHICH_PART[word] for word in text.split() if word in WHICH_PART)


if TYPE_CHECKING:
    from vcage.models.wordings import TaskToWord


class Review:
    """The review of one sentence.

    Args:
        task: that it may say.
        sentence: in plain language.
    """

    def __init__(self, task: TaskToWord, sentence: str):
        self._task, self._sentence = task, sentence
        self._said = words_of(sentence)
        self._mentions = task.names.mentions(sentence)
        self._taken = {place for m in self._mentions for place in range(m.start, m.end)}
        self._loose = {word for n, word in enumerate(self._said) if n not in self._taken}

    def complaints(self) -> Iterator[str]:
        """Complaints where the sentence is untrue of the scene, ambiguous in it, or not an exact request."""
        for mention in self._mentions:
            yield from self._unclear(mention)
        for name in find_names(self._said, self._task.strangers, self._taken):
            yield f"there is no {name!r}"
        for asked in self._task.goals:
            yield from self._missing_requests(asked)
        yield from self._unsourced()
        yield from self._extra()
        yield from self._out_of_order()
        yield from self._other_range()
        yield from self._unspared()

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

    # --- requests of the task --------------------------------------------------------------------------

    def _missing_requests(self, asked: AskedGoal) -> Iterator[str]:
        goal, words = asked.goal, says(asked.goal)
        if not self._mentions_of(goal.subject):
            yield f"names no {self._task.phrases[goal.subject]}, of which {str(goal)!r} is asked"
        elif not any(words & {*span} for span in self._spans(goal)):
            yield f"does not say {str(goal)!r} in one of the words {listed(sorted(words))}"
        elif goal.kind.refers_to == "arm" and goal.reference not in self._loose:
            yield f"does not say that the {goal.reference} arm has it then"
        if goal.part is not None and not self._says_part(goal, part_words(goal.part)):
            yield f"does not say which part: the {part_words(goal.part)}"
        if asked.arm is not None and not self._says_arm(asked.arm):
            yield f"does not say that the {asked.arm} arm does it"

    def _mentions_of(self, name: str) -> list[Mention]:
        return [mention for mention in self._mentions if name in mention.ids]

    def _says_arm(self, arm: str) -> bool:
        return arm in self._loose and not self._loose.isdisjoint(("arm", "hand", "gripper"))

    def _unsourced(self) -> Iterator[str]:
        for told in self._task.sources.values():
            part = part_words(told.part).split() if told.part else []
            if not any(told.reference in ids and {*part} <= {*words} for ids, words in self._left_by(told)):
                thing, holder = self._task.phrases[told.subject], self._task.phrases[told.reference]
                holder = f"{' '.join(part)} of the {holder}" if part else holder
                yield f"does not say that the {thing} is taken from the {holder}"

    def _left_by(self, told: Description) -> Iterator[tuple[Collection[str], list[str]]]:
        """Ids of things that the sentence takes an object from, with the words before each name.

        It may say "from the top drawer of the cabinet", "out of the top drawer", or "in the pot" after the object.
        """
        for number, mention in enumerate(self._mentions):
            words = self._before(number)
            after = number and told.subject in self._mentions[number - 1].ids and told.reference not in self._references
            if {*words} & (FROM | LIES[told.relation] if after else FROM):
                yield mention.ids, words
        owners = [name for name, kind in self._task.things.items() if told.part in kind.parts]
        for number, word in enumerate(self._said):
            if word in FROM and len(owners) == 1:
                yield owners, [*takewhile(self._within.__contains__, self._said[number + 1 :])]

    def _before(self, number: int) -> list[str]:
        """The words that lead to a mention: articles, drawers, and the one before these."""
        begun = self._mentions[number - 1].end if number else 0
        words = self._said[begun : self._mentions[number].start]
        return words[max((n for n, word in enumerate(words) if word not in self._within), default=0) :]

    @cached_property
    def _within(self) -> frozenset[str]:
        """Words allowed before the name of an object's source."""
        parts = (part_words(told.part) for told in self._task.sources.values() if told.part)
        return WITHIN.union(*(part.split() for part in parts))

    def _says_part(self, goal: Goal, part: str) -> bool:
        """Check if the sentence identifies the part; with the goal itself where there are several."""
        parts = {asked.goal.part for asked in self._task.goals if asked.goal.part is not None}
        texts = map(" ".join, self._spans(goal)) if len(parts) > 1 else [" ".join(self._said)]
        return any(levels(text) >= levels(part) for text in texts)

    def _spans(self, goal: Goal) -> Iterator[list[str]]:
        """The words that can say a goal.

        They stand between a mention of its subject and the next place, where that is the goal's. Where no place
        follows, the last one before counts. A goal without a place is said from its verb on.
        """
        if goal.reference != TABLE and goal.reference not in self._task.things:
            yield from (self._said[n : n + VERB_TO_PART_WORDS] for n in self._verbs(goal))
            return
        for mention in self._mentions_of(goal.subject):
            end, ids = self._next_place(mention)
            if ids == {goal.reference}:
                yield self._said[mention.end : end]

    def _verbs(self, goal: Goal) -> list[int]:
        """Places of the words for a goal that are no part of a name."""
        return [n for n, word in enumerate(self._said) if word in says(goal) and n not in self._taken]

    def _next_place(self, mention: Mention) -> tuple[int, frozenset[str]]:
        """The start and ids of the place after a mention; of the last one before where none follows."""
        after = [place for place in self._places if place[0] >= mention.end and place[1] != mention.ids]
        if after:
            return after[0]
        before = [ids for start, ids in self._places if start < mention.start]
        return len(self._said), before[-1] if before else frozenset()

    @cached_property
    def _references(self) -> set[str]:
        return {name for asked in self._task.goals if (name := asked.goal.reference) is not None}

    @cached_property
    def _places(self) -> list[tuple[int, frozenset[str]]]:
        """Places of words that name the reference of a goal, except sources."""
        to = [m for n, m in enumerate(self._mentions) if not FROM & {*self._before(n)}]
        found = [(m.start, m.ids) for m in to if m.ids & self._references]
        if TABLE in self._references:
            found += [(n, frozenset((TABLE,))) for n, word in enumerate(self._said) if word == TABLE]
        return sorted(found, key=lambda place: place[0])

    # --- requests outside the task ---------------------------------------------------------------------

    def _extra(self) -> Iterator[str]:
        yield from self._loose_words()
        if NOT & self._loose and not self._task.untouched:
            yield "nothing is to be left alone"
        if {"arm", "arms", "gripper"} & self._loose and not self._armed():
            yield "no arm is asked for"

    def _loose_words(self) -> Iterator[str]:
        """Complaints about words outside names that no goal or description allows."""
        allowed, bound = self._allowed(), claimed()
        for word in sorted(self._loose):
            if word in allowed:
                continue
            if word in bound:
                yield f"{word!r} is not asked for"
            elif word in COLOURS or (word in NUMBERS and word not in ("a", "an")):
                yield f"{word!r} says nothing of an object that is named"
        for level in levels(" ".join(self._loose)) - levels(" ".join(allowed)) - {"middle"}:
            yield f"{level!r} is not asked for"

    def _armed(self) -> set[str]:
        """The arms that the task speaks of."""
        handed = {asked.goal.reference for asked in self._task.goals if asked.goal.kind.refers_to == "arm"}
        both = {"both" for asked in self._task.goals if asked.goal.kind.arms > 1}
        return both | {arm for arm in {asked.arm for asked in self._task.goals} | handed if arm is not None}

    def _allowed(self) -> set[str]:
        """Words of goals, sides and levels that ask for something or describe it."""
        goals = [asked.goal for asked in self._task.goals]
        found = {word for goal in goals for word in says(goal).union(goal.kind.may_say.split())} | self._armed()
        for goal in goals:
            found |= {*part_words(goal.part).split()} if goal.part else set()
        for told in self._task.descriptions:
            found |= {*told.relation.split("_")} | ({*part_words(told.part).split()} if told.part else set())
        told_sides = {SIDES[word] for word in found if word in SIDES}
        return found | {word for word, side in SIDES.items() if side in told_sides}

    # --- order and range -------------------------------------------------------------------------------

    def _out_of_order(self) -> Iterator[str]:
        steps = in_steps(self._task.goals)
        ordered = IN_ORDER & self._loose
        if len(steps) == 1 and (ordered or FIRST & self._loose):
            yield "asks for an order, but the goals may come in any"
        places = [[self._place(goal) for goal in step] for step in steps]
        if len(steps) > 1 and not (ordered and all(max(a) <= min(b) for a, b in pairwise(places))):
            yield f"does not say the {len(steps)} steps in their order, with 'then'"

    def _place(self, goal: Goal) -> int:
        """Place of the word by which the sentence asks for a goal: for a part, of the verb before its words."""
        if goal.kind.refers_to is not None:
            return min((mention.start for mention in self._mentions_of(goal.subject)), default=0)
        verbs, told = self._verbs(goal), levels(part_words(goal.part)) if goal.part else frozenset()
        of_part = [n for n in verbs if levels(" ".join(self._said[n : n + VERB_TO_PART_WORDS])) >= told]
        return min(of_part or verbs, default=0)

    def _other_range(self) -> Iterator[str]:
        ranging, subjects = self._task.ranges_over(self._sentence), {a.goal.subject for a in self._task.goals}
        nouns = all(quantifier.noun for quantifier in quantified(self._sentence))
        if self._task.quantified:
            if ranging != self._task.quantified:
                yield f"the instruction speaks of all of {listed(sorted(self._task.quantified))}, the sentence does not"
        elif not nouns or not ranging <= subjects:
            yield "speaks of all of something, the instruction does not"

    def _unspared(self) -> Iterator[str]:
        missing = {*self._task.untouched} - {name for mention in self._mentions for name in mention.ids}
        if missing or (self._task.untouched and not NOT & self._loose):
            yield f"does not say that {listed(sorted(missing or self._task.untouched))} is to be left alone"
