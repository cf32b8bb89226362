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
    HIGHEST,
    LOWEST,
    NUMBERS,
    PARTS,
    lemma,
    same_word,
    tokens,
)
from vcage.models.plain_english import in_english, is_plain
from vcage.models.quantifiers import left_over
from vcage.objects.mentions import Noun, nouns
from vcage.objects.names import has_colour, look_texts
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import Description, Goal, Reading, goal_of

_MANY = frozenset(("each", "every", "all", "everything", "both", "another", "other", "others", "rest", "more", "any"))
"""Words by which "a mug" may be several."""

_END = r"(?= of\b| side\b| and\b| then\b|$)"
_SIDES: tuple[tuple[str, str, str], ...] = (
    (rf"\b(?:to|on|at) (?:the|its) (?:far |very )?left{_END}|\bleft of\b", "left_of", "right_of"),
    (rf"\b(?:to|on|at) (?:the|its) (?:far |very )?right{_END}|\bright of\b", "right_of", "left_of"),
    (r"\bin front of\b", "in_front_of", "behind"),
    (r"\bbehind\b", "behind", "in_front_of"),
)
"""Words for a side, the relation that they ask for, and the opposite one."""

_WHICH = re.compile(r"\bthe (left|right)(?:most|hand| hand)? (?!arm\b|hand\b|gripper\b|side\b|of\b|one\b)\w+")
_ARM = re.compile(r"\b(left|right) (?:arm|hand|gripper)\b")
_TO_ARM = re.compile(r"\bto (?:the |its |your )?(left|right)\b(?! of\b| side\b)")
_TOOLS = (("scan", "scanned"), ("weigh", "weighed"))
"""Verbs for which there is one goal."""
_ROW = re.compile(r"\bfrom (?:the )?(?:left|right) to (?:the )?(?:left|right)\b")
_WHICH_DRAWERS = frozenset(
    ("both", "all", "each", "every", "other", "others", "same", "any", "drawers", "them", *COUNTED, "next", "last")
)
"""Words by which another drawer may be meant than one that is called top, middle or bottom."""
_OPENING, _CLOSING = frozenset(("open", "opened", "opening")), frozenset(("close", "closed", "closing", "shut"))
_PULLING, _PUSHING = frozenset(("up", "out", "lift", "ajar", "pull")), frozenset(("in", "back", "down", "push"))
"""Words for opening and closing, and words that may mean it."""
_OPEN = frozenset((*ANYTHING, *_MANY, "anything", "something", "whatever", "them"))
"""Words by which objects are meant that no noun names."""
_DRAWER = re.compile(rf"(?<!second )\b({'|'.join((*HIGHEST, *LOWEST, 'middle'))}) (?:drawer|shelf|compartment|one)\b")


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
    idle = [name for name in moved if name not in spoken]
    found = (
        [f"{listed(idle)} {'is' if len(idle) == 1 else 'are'} to be moved, but no goal speaks of it"] if idle else []
    )
    first = min((asked.step for asked in reading.goals), default=1)
    starts = {
        goal_of([told.subject, told.relation, told.reference, told.part])
        for told in reading.descriptions
        if told.relation != "center"
    }
    begun = [str(asked.goal) for asked in reading.goals if asked.step == first and asked.goal in starts]
    found += [f"{goal} is a goal, but true at the start already" for goal in dict.fromkeys(begun)]
    if not in_english(instruction, things.values()):
        return found
    said = nouns(instruction, things.values())
    found += left_over(instruction, things, spoken) + _unnamed(instruction, said, things, reading)
    found += _wrong_parts(instruction, reading)
    if is_plain(instruction):
        found += _unanswered(instruction, things, reading, spoken) + _misnamed(said, things, spoken)
        found += _miscounted(instruction, said, things, reading, spoken) + _wrong_sides(instruction, reading)
        found += _wrong_doing(instruction, reading)
    return found


def unmet_names(instruction: str, catalogue: Iterable[CatalogueEntry], chosen: Collection[CatalogueEntry]) -> list[str]:
    """Complaints about names of the catalogue's kinds in an instruction that no chosen object answers to.

    Args:
        instruction: in plain language.
        catalogue: whose names are looked for.
        chosen: the kinds that were chosen, with no other look than the chosen one.
    """
    if not in_english(instruction, chosen) or not is_plain(instruction):
        return []
    said = nouns(instruction, catalogue)
    return [
        f"the task names {noun.words!r}, but nothing is chosen that is called so"
        for noun in dict.fromkeys(said)
        if noun.name and not any(noun.may_mean(entry) for entry in chosen)
    ]


def _spoken(things: Mapping[str, CatalogueEntry], reading: Reading) -> set[str]:
    """Ids of the objects that a reading speaks of, and of what they are scanned, weighed or presented with."""
    named = {*_named(_stated(reading))}
    done = {asked.goal.relation for asked in reading.goals}
    tools = {name for name, entry in things.items() if done & _done_with(entry)}
    return {*reading.untouched, *tools, *(name for name in things if name in named)}


def _done_with(entry: CatalogueEntry) -> set[str]:
    """Events that a thing is the tool of."""
    able = {"scanned": entry.reads_codes, "weighed": entry.weighs, "presented": "customer" in entry.words.name}
    return {event for event, is_tool in able.items() if is_tool}


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
    goals, parts = [asked.goal for asked in reading.goals], {*map(lemma, words)}
    told = _named(reading.descriptions)
    subjects, references = [goal.subject for goal in goals], [goal.reference for goal in goals]
    found = list[str]()
    for mine, others in ((subjects, references), (references, subjects)):
        if all(_meant(noun, things, (*others, *told)) for noun in said):
            continue  # "put the pens away" leaves open where to, "fill the box" with what
        named = {name for noun in said for name in _meant(noun, things, mine)}
        found += _not_named([pair for pair in zip(mine, goals, strict=True) if pair[0] in things.keys() - named], parts)
    return list(dict.fromkeys(found))


def _not_named(strange: Iterable[tuple[str | None, Goal]], parts: Collection[str]) -> list[str]:
    """Complaints about objects and their goals, but for what is meant by a part of it that is named."""
    return [
        f"{name} is in the goal {goal}, but the instruction names no such object"
        for name, goal in strange
        if (goal.part or "").split("_")[0] not in parts
    ]


def _meant(noun: Noun, things: Mapping[str, CatalogueEntry], names: Iterable[str | None]) -> list[str]:
    """Those of some names that are of objects which a noun may mean."""
    return [name for name in names if name in things and noun.may_mean(things[name])]


def _all_known(words: Collection[str], said: Sequence[Noun]) -> bool:
    """Check if objects are named, by nouns alone, and there is no word that may name more."""
    if not said or not _OPEN.isdisjoint(words):
        return False
    named = {word for noun in said for word in tokens(noun.words)}
    known = FUNCTION_WORDS | VERBS | COLOURS | DETERMINERS | PARTS | NUMBERS.keys() | named | {"left", "right", "front"}
    return all({word, lemma(word)} & known for word in words)


def _miscounted(
    instruction: str,
    said: Sequence[Noun],
    things: Mapping[str, CatalogueEntry],
    reading: Reading,
    spoken: Collection[str],
) -> list[str]:
    """Number words that do not match how many objects of that name the reading speaks of."""
    subjects = {asked.goal.subject for asked in reading.goals}
    times = Counter(noun.name for noun in said if _MANY.isdisjoint(tokens(instruction)))
    found = list[str]()
    counted = [noun for noun in said if noun.name and noun.name[-1] not in COUNTED]
    for noun, number in ((noun, noun.number) for noun in counted if noun.number is not None):
        there, moved = len(_meant(noun, things, spoken)), len(_meant(noun, things, subjects))
        if there < number:
            found.append(f"{noun.words!r} asks for {number}, but the goals speak of {there}")
        elif times[noun.name] == 1 and moved > number > 0:
            found.append(f"{noun.words!r} asks for {number}, but goals are given for {moved}")
    return found


def _wrong_sides(instruction: str, reading: Reading) -> list[str]:
    """Sides in the instruction that the reading does not say, or the other way round."""
    text = " ".join(tokens(instruction))
    handed = {asked.goal.reference for asked in reading.goals if asked.goal.relation == "handed"}
    if handed and _ARM.search(text):
        return []  # "from the left hand to the right one"
    arms = {asked.arm for asked in reading.goals} | handed
    wrong = [side for side in _WHICH.findall(text) if not _on_side(side, reading)]
    return [
        *_unsaid_sides(text, {one.relation for one in _stated(reading)}),
        *(f"'the {side} …' is said, but no description has an object of a goal '{side}_of' another" for side in wrong),
        *(f"'{arm} arm' is said, but no goal names that arm" for arm in _ARM.findall(text) if arm not in arms),
    ]


def _unsaid_sides(text: str, relations: Collection[str]) -> list[str]:
    """Words for a side that no relation of the reading says."""
    if _ROW.search(text):
        said = {"left_of", "right_of"}.intersection(relations)
        return [] if said else ["a row from one side to the other is asked, but no goal says 'left_of' or 'right_of'"]
    found = []
    for pattern, word, opposite in _SIDES if "scanned" not in relations else ():  # in front of the scanner
        if (said := re.search(pattern, text)) and word not in relations:
            other = f", but {opposite!r}" if opposite in relations else ""
            found.append(f"{said[0]!r} is asked, but no goal or description says {word!r}{other}")
    return found


def _stated(reading: Reading) -> list[Goal | Description]:
    return [*(asked.goal for asked in reading.goals), *reading.descriptions]


def _wrong_doing(instruction: str, reading: Reading) -> list[str]:
    """Verbs without the goal that they ask for, and things that are handed the wrong way."""
    words, goals = tokens(instruction), [asked.goal for asked in reading.goals]
    relations = {goal.relation for goal in goals}
    found = [f"{v!r} is said, but no goal says {g!r}" for v, g in _TOOLS if v in words and g not in relations]
    to = _TO_ARM.findall(" ".join(words))
    handed = [goal.reference for goal in goals if goal.relation == "handed"]
    return found + [
        f"it is handed {arm!r}, but the instruction says 'to the {to[0]}'" for arm in handed if to and arm not in to
    ]


def _on_side(side: str, reading: Reading) -> bool:
    """Check if some object of a goal is said to stand on that side at the start, or a part is called after it."""
    if any(side in (one.part or "").split("_") for one in _stated(reading)):
        return True
    other = {"left": "right_of", "right": "left_of"}[side]
    there = {told.subject for told in reading.descriptions if told.relation == f"{side}_of"}
    there |= {told.reference for told in reading.descriptions if told.relation == other}
    return any({asked.goal.subject, asked.goal.reference} & there for asked in reading.goals)


def _named(stated: Iterable[Goal | Description]) -> list[str | None]:
    return [name for one in stated for name in (one.subject, one.reference)]


def _wrong_parts(instruction: str, reading: Reading) -> list[str]:
    """Drawers that the instruction names and the reading does not, or the reverse; opening for closing."""
    words, plain = set(tokens(instruction)), is_plain(instruction)
    parts = {one.part.partition("_")[2] for one in _stated(reading) if one.part}
    meant = {_height(which): which for which in _DRAWER.findall(" ".join(tokens(instruction)))}
    found = [
        f"the {meant[height]} drawer is named, but no goal or description names a part '..._{height}'"
        for height in (meant if plain else ())
        if height not in parts
    ]
    if meant and not words & _WHICH_DRAWERS:
        wrong = sorted((parts - meant.keys()) & {"top", "middle", "bottom"})
        found += [f"a goal or description names the {part} drawer, which the instruction does not" for part in wrong]
    return found + (_opened_for_closed(words, reading) if plain else [])


def _opened_for_closed(words: Collection[str], reading: Reading) -> list[str]:
    done = {asked.goal.relation for asked in reading.goals}
    pairs = (("open", _OPENING | _PULLING, _CLOSING), ("closed", _CLOSING | _PUSHING, _OPENING))
    return [
        f"a goal says {relation!r}, but the instruction says {' and '.join(sorted(other.intersection(words)))!r}"
        for relation, one, other in pairs
        if relation in done and not other.isdisjoint(words) and one.isdisjoint(words)
    ]


def _height(which: str) -> str:
    return "top" if which in HIGHEST else "bottom" if which in LOWEST else which
