"""A second look at a reading by code: are all words of the instruction answered, by objects that they name?

It needs neither grammar nor model, and looks at what every reader says alike. Each complaint is a sentence that names
the words. What words mean is checked for English only; of a sentence in another language the rest is.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence

from vcage.base.text import listed
from vcage.base.word_classes import FUNCTION_WORDS, HANDLING, VERBS
from vcage.base.words import (
    ANYTHING,
    COLOURS,
    COUNTED,
    DETERMINERS,
    NO_PLURAL,
    NUMBERS,
    PARTS,
    lemma,
    same_word,
    tokens,
)
from vcage.models.asides import AskedPart, asked_part
from vcage.models.clauses import Clauses
from vcage.models.directions import plain_sides, wrong_arms, wrong_drawers, wrong_sides
from vcage.models.plain_english import in_english
from vcage.models.quantifiers import left_over
from vcage.models.which_one import coloured, meant, unclear
from vcage.objects.mentions import Noun, exact_count, nouns
from vcage.objects.names import has_colour, look_texts
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import Goal, Reading, goal_of, named_by

_MANY = frozenset(("each", "every", "all", "everything", "both", "another", "other", "others", "rest", "more", "any"))
"""Words by which "a mug" may be several."""

_ACTS = (
    (r"scan\b", "scanned"),
    (r"weigh\b", "weighed"),
    (r"(?:ring(?! up)|press)\b", "pressed"),
    (r"open (?:the|it|that|both)\b", "open"),
    (r"(?:shut|close) (?:the|it|that|both)\b", "closed"),
    (r"(?:turn|switch) on\b", "turned"),
)
"""Verbs for which there is one goal."""
_OPEN = frozenset((*ANYTHING, *_MANY, "anything", "something", "whatever", "them"))
"""Words by which objects are meant that no noun names."""
_ORDINALS = frozenset(((), *((word,) for word in COUNTED)))
"""Ends of names that are not counted: "the second"."""
_ALONE = re.compile(
    r"(?<!of )(?<!of the )\b(both|two|three|four|five)"
    r"(?= (?:of (?:them|these|those)|in|into|on|onto|to|go|together|[,.;:!?])|$)"
)
"""Numbers that stand without a noun."""
_TO_READER = frozenset(
    ("ignore", "disregard", "override", "forget", "answer", "respond", "reply", "output", "print", "json", "prompt",
     "instruction", "instructions", "schema", "above", "previous", "prior", "system", "reveal", "repeat")
)  # fmt: skip
"""Words by which a text speaks to whoever reads it, and not of things."""


def second_look(
    instruction: str, things: Mapping[str, CatalogueEntry], reading: Reading, moved: Collection[str] = ()
) -> list[str]:
    """Complaints about a reading, one sentence each; empty when nothing is seen.

    Args:
        instruction: in plain language.
        things: what there is, by object id: the catalogue's entries with no other look than the object's.
        reading: what a reader takes from it.
        moved: ids of the objects that were chosen to be moved.
    """
    spoken = _spoken(things, reading)
    found = _idle(spoken, moved) + _done_already(reading)
    english = in_english(instruction, things.values())
    found += _unasked(instruction, reading, things, least=1 if english else 2)
    if not english:
        return found
    task = asked_part(plain_sides(instruction), things.values())
    said, named = nouns(task.text, things.values()), nouns(task.open_text, things.values())
    found += left_over(instruction, things, spoken) + _unnamed(task.open_text, named, things, reading)
    found += _excluded(task, named, things, reading)
    found += _unanswered(task.text, things, reading, spoken) + _misnamed(said, things, spoken)
    found += unclear(task.whole, said, things, reading)
    found += _miscounted(task.text, said, things, reading, spoken) + wrong_sides(task.text, said, things, reading)
    found += wrong_drawers(task, things, reading) + wrong_arms(task.text, reading.goals)
    found += _undone(task.text, reading) + Clauses(task.text, said, things, reading).complaints()
    return list(dict.fromkeys(found))


def _idle(spoken: Collection[str], moved: Iterable[str]) -> list[str]:
    idle = [name for name in moved if name not in spoken]
    are = "is" if len(idle) == 1 else "are"
    return [f"{listed(idle)} {are} to be moved, but no goal speaks of it"] if idle else []


def _done_already(reading: Reading) -> list[str]:
    """Goals of the first step that are true at the start."""
    first = min((asked.step for asked in reading.goals), default=1)
    starts = {
        goal_of([told.subject, told.relation, told.reference, told.part])
        for told in reading.descriptions
        if told.relation != "center"
    }
    begun = dict.fromkeys(asked.goal for asked in reading.goals if asked.step == first and asked.goal in starts)
    return [f"{goal} is a goal, but true at the start already" for goal in begun]


def unmet_names(instruction: str, catalogue: Iterable[CatalogueEntry], chosen: Collection[CatalogueEntry]) -> list[str]:
    """Complaints about names of the catalogue's kinds in an instruction that no chosen object answers to.

    Args:
        instruction: in plain language.
        catalogue: whose names are looked for.
        chosen: the kinds that were chosen, with no other look than the chosen one.
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


def _spoken(things: Mapping[str, CatalogueEntry], reading: Reading) -> set[str]:
    """Ids of the objects that a reading speaks of, and of what they are scanned, weighed or presented with."""
    named = {*named_by(reading.stated)}
    done = {asked.goal.relation for asked in reading.goals}
    tools = {name for name, entry in things.items() if done & _done_with(entry)}
    return {*reading.untouched, *tools, *(name for name in things if name in named)}


def _done_with(entry: CatalogueEntry) -> set[str]:
    """Goal words that a thing is the tool for, or the addressee of."""
    return {*entry.tool_for, *(["presented"] if "customer" in entry.words.name else [])}


def _unanswered(
    instruction: str, things: Mapping[str, CatalogueEntry], reading: Reading, spoken: Collection[str]
) -> list[str]:
    """Content words in no ``words`` of a goal or description, which name nothing that the reading speaks of either."""
    answered = _answered(reading).union(*(_called(things[name]) for name in spoken))
    missed = [word for word in tokens(instruction) if "'" not in word and not {word, lemma(word)} & answered]
    missed = list(dict.fromkeys(word for word in missed if not _carries_nothing(word)))
    return [f"the words {listed(map(repr, missed))} are in no 'words' of a goal or description"] if missed else []


def _answered(reading: Reading) -> set[str]:
    found = {word for one in (*reading.goals, *reading.descriptions) for word in tokens(one.words)}
    of_arms = any(asked.arm or asked.goal.relation == "handed" for asked in reading.goals)
    return found | {"left", "right", "arm", "hand", "gripper"} if of_arms else found


def _carries_nothing(word: str) -> bool:
    """Check if no goal has to answer a word, slips of the pen included."""
    known = FUNCTION_WORDS | HANDLING | DETERMINERS
    return lemma(word) in known or any(same_word(word, other) for other in known)


def _called(entry: CatalogueEntry) -> set[str]:
    texts = [entry.words.name, entry.words.plural, *entry.words.synonyms, entry.words.category]
    return {word for text in (*texts, *look_texts(entry)) for word in tokens(text)}


def _misnamed(said: Sequence[Noun], things: Mapping[str, CatalogueEntry], spoken: Collection[str]) -> list[str]:
    """Nouns and colours that no object answers to which the reading speaks of."""
    found = []
    for noun in dict.fromkeys(said):
        met = [things[name] for name in sorted(spoken) if noun.may_mean(things[name])]
        if not met:
            found.append(f"the instruction names {noun.words!r}, but no goal speaks of such an object")
        else:
            missing = [colour for colour in noun.colours if not any(has_colour(entry, colour) for entry in met)]
            found += [f"{noun.words!r} asks for {c}, but no goal speaks of such an object" for c in missing]
    return found


def _unnamed(
    instruction: str, said: Sequence[Noun], things: Mapping[str, CatalogueEntry], reading: Reading
) -> list[str]:
    """Objects of goals that the instruction does not name, where it names others and every word of it is known."""
    words = tokens(instruction)
    if not _all_known(words, said):
        return []
    goals, told = [asked.goal for asked in reading.goals], named_by(reading.descriptions)
    subjects, references = zip(*((goal.subject, goal.reference) for goal in goals), strict=True)
    found = list[str]()
    for mine, others in ((subjects, references), (references, subjects)):
        if all(meant(noun, things, (*others, *told)) for noun in said):
            continue  # "put the pens away" leaves open where to, "fill the box" with what
        unnamed = things.keys() - set[str]().union(*(meant(noun, things, mine) for noun in said))
        found += [
            f"{name} is in the goal {goal}, but the instruction names no such object"
            for name, goal in zip(mine, goals, strict=True)
            if name in unnamed and not _names_part(words, goal)
        ]
    return list(dict.fromkeys(found))


def _names_part(words: Iterable[str], goal: Goal) -> bool:
    """Check if words name the part of a goal, by which its owner is meant."""
    return (goal.part or "").split("_")[0] in map(lemma, words)


def _all_known(words: Collection[str], said: Sequence[Noun]) -> bool:
    """Check if objects are named, by nouns alone, and there is no word that may name more."""
    if not said or not _OPEN.isdisjoint(words):
        return False
    named = {word for noun in said for word in tokens(noun.words)}
    known = FUNCTION_WORDS | VERBS | COLOURS | DETERMINERS | PARTS | NUMBERS.keys() | named | {"left", "right", "front"}
    return all({word, lemma(word)} & known for word in words)


def _miscounted(
    text: str, said: Sequence[Noun], things: Mapping[str, CatalogueEntry], reading: Reading, spoken: Collection[str]
) -> list[str]:
    """Number words that do not match how many objects of that name the reading speaks of."""
    subjects, words = {asked.goal.subject for asked in reading.goals}, text.split(" ")
    times = Counter(noun.name for noun in said if _MANY.isdisjoint(words))
    counted = [noun for noun in said if noun.name[-1:] not in _ORDINALS]
    found = _too_few(text, [asked.goal for asked in reading.goals])
    for noun in counted:
        number = _number(words, noun)
        there, moved = len(meant(noun, things, spoken)), len(meant(noun, things, subjects))
        if there < number:
            found.append(f"{noun.words!r} asks for {number}, but the goals speak of {there}")
        elif moved > number > 0 and times[noun.name] == 1:
            found.append(f"{noun.words!r} asks for {number}, but goals are given for {moved}")
    return found


def _too_few(text: str, goals: Sequence[Goal]) -> list[str]:
    """Numbers without a noun that are larger than the number of things or places of the goals."""
    most = max(len({(g.subject, g.part) for g in goals}), len({(g.reference, g.part) for g in goals}))
    alone = [word for word in _ALONE.findall(text) if most < (exact_count(word) or 0)]
    return [f"{word!r} is said, but the goals are about {most}" for word in alone]


def _number(words: Sequence[str], noun: Noun) -> int:
    """How many a noun asks for, 0 where that is not said: 2 of "a pair of mugs", but not of "a pair of scissors"."""
    before = [word for word in words[max(noun.at - 3, 0) : noun.at] if word not in ("of", "the")]
    pair = before[-1:] in (["pair"], ["couple"]) and noun.name[-1] not in NO_PLURAL
    return noun.number or (2 if pair else 0)


def _excluded(
    task: AskedPart, named: Sequence[Noun], things: Mapping[str, CatalogueEntry], reading: Reading
) -> list[str]:
    """Objects of goals that the instruction names only to leave them out, or not to move them."""
    goals = [asked.goal for asked in reading.goals]
    out = [(noun, reading.in_goals) for noun in task.excluded if not _is_named(noun, named)]
    out += [(noun, _moved_to(goals, at, things)) for noun, at in task.kept if at or not _is_named(noun, named)]
    return [
        f"{name} is in a goal, but the instruction leaves out {noun.words!r}"
        for noun, used in out
        for name in coloured(noun, things)
        if name in used
    ]


def _moved_to(goals: Sequence[Goal], place: Noun | None, things: Mapping[str, CatalogueEntry]) -> set[str | None]:
    """Subjects of goals, of those about a place if one is said."""
    places = None if place is None else coloured(place, things)
    return {goal.subject for goal in goals if places is None or goal.reference in places}


def _is_named(noun: Noun, named: Iterable[Noun]) -> bool:
    return any(one.name in (noun.name, ()) and {*noun.colours} <= {*one.colours} for one in named)


def _unasked(instruction: str, reading: Reading, things: Mapping[str, CatalogueEntry], least: int) -> list[str]:
    """Goals of a sentence that names no object of them and speaks to its reader instead, by so many words at least."""
    words = _TO_READER.intersection(tokens(instruction))
    spoken = named_by(reading.stated)
    if len(words) < least or any(meant(noun, things, spoken) for noun in nouns(instruction, things.values())):
        return []
    return [f"the instruction names no object of a goal, but says {listed(map(repr, sorted(words)))}"]


def _undone(text: str, reading: Reading) -> list[str]:
    """Verbs without the goal that they ask for."""
    done = {asked.goal.relation for asked in reading.goals}
    said = [(match[0], goal) for verb, goal in _ACTS if (match := re.search(rf"\b{verb}", text))]
    return [f"{verb!r} is said, but no goal says {goal!r}" for verb, goal in said if goal not in done]
