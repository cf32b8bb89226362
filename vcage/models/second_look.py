"""Check by code that a reading covers every word of the instruction, with the objects it names.

It needs neither grammar nor model, and treats all readers equally. Each complaint is a sentence that names the words.
In another language than English, words are not checked.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence

from vcage.base.text import listed
from vcage.base.words import (
    ANYTHING,
    COLOURS,
    DETERMINERS,
    FUNCTION_WORDS,
    HANDLING,
    NUMBERS,
    PARTS,
    lemma,
    same_word,
    tokens,
)
from vcage.base.words import VERBS as KNOWN_VERBS
from vcage.models.asides import asked_part
from vcage.models.checked_reading import CheckedReading, Instructed, in_english
from vcage.models.clauses import VERBS, order_complaints
from vcage.models.directions import wrong_arms, wrong_drawers, wrong_sides
from vcage.models.how_many import MANY, miscounted
from vcage.models.quantifiers import left_over
from vcage.models.which_one import coloured, meant, unclear
from vcage.objects.mentions import Noun, nouns
from vcage.objects.names import has_colour, look_texts
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import Goal, Reading, goal_of, named_by

_OPEN = frozenset((*ANYTHING, *MANY, "anything", "something", "whatever", "them"))
"""Words for objects that no noun names."""
_TO_READER = frozenset(
    ("ignore", "disregard", "override", "forget", "answer", "respond", "reply", "output", "print", "json", "prompt",
     "instruction", "instructions", "schema", "above", "previous", "prior", "system", "reveal", "repeat")
)  # fmt: skip
"""Words that speak to the reader of a text, and not of things."""


def second_look(asked: Instructed, reading: Reading) -> list[str]:
    """Complaints about a reading of an instruction, one sentence each; empty if no check has any."""
    read = CheckedReading(**vars(asked), reading=reading)
    checks = [*_IN_ANY_LANGUAGE, *(_IN_ENGLISH if read.english else ())]
    return list(dict.fromkeys(complaint for check in checks for complaint in check(read)))


def unmet_names(instruction: str, catalogue: Iterable[CatalogueEntry], chosen: Collection[CatalogueEntry]) -> list[str]:
    """Complaints about names of the catalogue's kinds in an instruction that no chosen object answers to.

    Args:
        instruction: in plain language.
        catalogue: kinds with the names.
        chosen: the chosen kinds, with no other look than the chosen one.
    """
    if not in_english(instruction, chosen):
        return []
    kinds = list(catalogue)
    said = nouns(asked_part(instruction, kinds).text, kinds)
    return [
        f"the task names {noun.words!r}, but nothing is chosen that is called so"
        for noun in dict.fromkeys(said)
        if noun.name and not any(noun.may_mean(entry) for entry in chosen)
    ]


# --- in any language ---------------------------------------------------------------------------------


def _idle(read: CheckedReading) -> Iterator[str]:
    """Objects to be moved that no goal speaks of."""
    idle = [name for name in read.moved if name not in read.spoken]
    if idle:
        yield f"{listed(idle)} {'is' if len(idle) == 1 else 'are'} to be moved, but no goal speaks of it"


def _done_already(read: CheckedReading) -> Iterator[str]:
    """Goals of the first step that are true at the start."""
    first = min((asked.step for asked in read.reading.goals), default=1)
    starts = {
        goal_of([told.subject, told.relation, told.reference, told.part])
        for told in read.reading.descriptions
        if told.relation != "center"
    }
    for goal in dict.fromkeys(asked.goal for asked in read.reading.goals if asked.step == first):
        if goal in starts:
            yield f"{goal} is a goal, but true at the start already"


def _unasked(read: CheckedReading) -> Iterator[str]:
    """Goals of a sentence that names no object of them and speaks to its reader instead."""
    words = _TO_READER.intersection(tokens(read.instruction))
    stated = named_by(read.reading.stated)
    if len(words) >= (1 if read.english else 2) and not any(
        meant(noun, read.things, stated) for noun in nouns(read.instruction, read.things.values())
    ):
        yield f"the instruction names no object of a goal, but says {listed(map(repr, sorted(words)))}"


# --- in English: are the words answered? -------------------------------------------------------------


def _unanswered(read: CheckedReading) -> Iterator[str]:
    """Content words in no ``words`` of a goal or description, and in no name of an object of the reading."""
    answered = _answered(read.reading).union(*(_called(read.things[name]) for name in read.spoken))
    words = [word for word in tokens(read.task.text) if "'" not in word and not {word, lemma(word)} & answered]
    missed = list(dict.fromkeys(word for word in words if not _carries_nothing(word)))
    if missed:
        yield f"the words {listed(map(repr, missed))} are in no 'words' of a goal or description"


def _answered(reading: Reading) -> set[str]:
    found = {word for one in (*reading.goals, *reading.descriptions) for word in tokens(one.words)}
    of_arms = any(asked.arm or asked.goal.relation == "handed" for asked in reading.goals)
    return found | {"left", "right", "arm", "hand", "gripper"} if of_arms else found


def _carries_nothing(word: str) -> bool:
    """Check if no goal has to answer a word; misspelled words count as the words they resemble."""
    known = FUNCTION_WORDS | HANDLING | DETERMINERS
    return lemma(word) in known or any(same_word(word, other) for other in known)


def _called(entry: CatalogueEntry) -> set[str]:
    texts = [entry.words.name, entry.words.plural, *entry.words.synonyms, entry.words.category]
    return {word for text in (*texts, *look_texts(entry)) for word in tokens(text)}


def _undone(read: CheckedReading) -> Iterator[str]:
    """Verbs without the goal that they ask for."""
    for goal, verb in VERBS.items():
        found = verb.only.search(read.task.text) if verb.only else None
        if found and goal not in read.relations:
            yield f"{found[0]!r} is said, but no goal says {goal!r}"


# --- in English: do the objects match the words? -----------------------------------------------------


def _misnamed(read: CheckedReading) -> Iterator[str]:
    """Nouns and colours that no object of the reading answers to."""
    for noun in dict.fromkeys(read.said):
        met = [read.things[name] for name in sorted(read.spoken) if noun.may_mean(read.things[name])]
        if not met:
            yield f"the instruction names {noun.words!r}, but no goal speaks of such an object"
        else:
            missing = [colour for colour in noun.colours if not any(has_colour(entry, colour) for entry in met)]
            yield from (f"{noun.words!r} asks for {c}, but no goal speaks of such an object" for c in missing)


def _unnamed(read: CheckedReading) -> Iterator[str]:
    """Objects of goals that the instruction does not name, if it names others and all of its words are known."""
    words, said = tokens(read.task.open_text), read.said_or_offered
    if not _all_known(words, said):
        return
    told = named_by(read.reading.descriptions)
    subjects, references = zip(*((goal.subject, goal.reference) for goal in read.goals), strict=True)
    for mine, others in ((subjects, references), (references, subjects)):
        if all(meant(noun, read.things, (*others, *told)) for noun in said):
            continue  # "put the pens away" leaves open where to, "fill the box" with what
        unnamed = read.things.keys() - set[str]().union(*(meant(noun, read.things, mine) for noun in said))
        for name, goal in zip(mine, read.goals, strict=True):
            unsaid = goal.relation in (_PLACE_UNSAID if mine is references else _THING_UNSAID)
            if name in unnamed and not unsaid and not _names_part(words, goal):
                yield f"{name} is in the goal {goal}, but the instruction names no such object"


_PLACE_UNSAID = ("hung_on", "inserted_in")
"""Goals whose place need not be named: "hang up the mug" and "insert the peg" leave open where."""

_THING_UNSAID = ("poured",)
"""Goals whose subject need not be named: "pour the balls into the bowl" leaves open what they are in."""


def _names_part(words: Iterable[str], goal: Goal) -> bool:
    """Check if words name the part of a goal, meaning its owner."""
    return (goal.part or "").split("_")[0] in map(lemma, words)


def _all_known(words: Collection[str], said: Sequence[Noun]) -> bool:
    """Check if objects are named, by nouns alone, and every other word is known to name none."""
    if not said or not _OPEN.isdisjoint(words):
        return False
    named = {word for noun in said for word in tokens(noun.words)}
    known = FUNCTION_WORDS | KNOWN_VERBS | COLOURS | DETERMINERS | PARTS | NUMBERS.keys() | named
    return all({word, lemma(word)} & (known | {"left", "right", "front"}) for word in words)


def _excluded(read: CheckedReading) -> Iterator[str]:
    """Objects of goals that the instruction names only to leave them out, or not to move them."""
    out = [(noun, read.reading.in_goals) for noun in read.task.excluded if not _is_named(noun, read)]
    out += [(noun, _moved_to(at, read)) for noun, at in read.task.kept if at or not _is_named(noun, read)]
    for noun, used in out:
        for name in coloured(noun, read.things):
            if name in used:
                yield f"{name} is in a goal, but the instruction leaves out {noun.words!r}"


def _moved_to(place: Noun | None, read: CheckedReading) -> set[str | None]:
    """Subjects of goals; of goals at a given place, if any."""
    places = None if place is None else coloured(place, read.things)
    return {goal.subject for goal in read.goals if places is None or goal.reference in places}


def _is_named(noun: Noun, read: CheckedReading) -> bool:
    named = read.said_or_offered
    return any(one.name in (noun.name, ()) and {*noun.colours} <= {*one.colours} for one in named)


_IN_ANY_LANGUAGE: tuple[Callable[[CheckedReading], Iterable[str]], ...] = (_idle, _done_already, _unasked)
_IN_ENGLISH: tuple[Callable[[CheckedReading], Iterable[str]], ...] = (
    left_over,
    _unnamed,
    _excluded,
    _unanswered,
    _misnamed,
    unclear,
    miscounted,
    wrong_sides,
    wrong_drawers,
    wrong_arms,
    _undone,
    order_complaints,
)
"""The checks; complaints reach a model in this order."""
