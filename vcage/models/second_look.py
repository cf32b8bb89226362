"""A second look at a reading by code: are all words of the instruction answered, by objects that they name?

It needs neither grammar nor model, and looks at what every reader says alike. Each complaint is a sentence that names
the words. What words mean is checked for English only; of a sentence in another language the rest is.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence

from vcage.base.text import listed
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
from vcage.models.english import FUNCTION_WORDS, HANDLING, VERBS
from vcage.models.mentions import Mention, has_colour, in_english, is_plain, mentions
from vcage.models.quantifiers import left_over
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import Reading

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
    """What is wrong with a reading, one sentence each; empty when nothing is seen.

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
    if not in_english(instruction, things.values()):
        return found
    said = mentions(instruction, things.values())
    found += left_over(instruction, things, spoken) + _unnamed(instruction, said, things, reading)
    found += _wrong_parts(instruction, reading)
    if is_plain(instruction):
        found += _unanswered(instruction, things, reading, spoken) + _misnamed(said, things, spoken)
        found += _miscounted(instruction, said, things, reading, spoken) + _wrong_sides(instruction, reading)
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
    said = mentions(instruction, catalogue)
    return [
        f"the task names {mention.words!r}, but nothing is chosen that is called so"
        for mention in dict.fromkeys(said)
        if mention.noun and not any(mention.names(entry) for entry in chosen)
    ]


def _spoken(things: Mapping[str, CatalogueEntry], reading: Reading) -> set[str]:
    """Ids of the objects that a reading speaks of, and of what they are scanned, weighed or presented with."""
    found = set(reading.untouched)
    for one in (*(asked.goal for asked in reading.goals), *reading.descriptions):
        found |= {name for name in (one.subject, one.reference) if name is not None and name in things}
    done = {asked.goal.relation for asked in reading.goals}
    for name, entry in things.items():
        reads = any(face.kind == "reader" for face in entry.faces)
        weighs = any(point.weighs for point in entry.functional_points)
        faces_customer = "customer" in entry.words.name
        if ("scanned" in done and reads) or ("weighed" in done and weighs) or ("presented" in done and faces_customer):
            found.add(name)
    return found


def _unanswered(
    instruction: str, things: Mapping[str, CatalogueEntry], reading: Reading, spoken: Collection[str]
) -> list[str]:
    """Content words in no ``words`` of a goal or description, which name nothing that the reading speaks of either."""
    answered = {word for one in (*reading.goals, *reading.descriptions) for word in tokens(one.words)}
    answered |= {word for name in spoken for word in _called(things[name])}
    if any(asked.arm or asked.goal.relation == "handed" for asked in reading.goals):
        answered |= {"left", "right", "arm", "hand", "gripper"}
    known = FUNCTION_WORDS | HANDLING | DETERMINERS
    said = [word for word in tokens(instruction) if "'" not in word]
    missed = [word for word in said if not {word, lemma(word)} & (answered | known)]
    missed = [word for word in missed if not any(same_word(word, other) for other in known)]
    if not missed:
        return []
    return [f"the words {listed(map(repr, dict.fromkeys(missed)))} are in no 'words' of a goal or description"]


def _called(entry: CatalogueEntry) -> set[str]:
    texts = [entry.words.name, entry.words.plural, *entry.words.synonyms, entry.words.category]
    looks = [text for variant in entry.variants for text in (variant.id, variant.colour, variant.description)]
    return {word for text in (*texts, *looks) for word in tokens(text)}


def _misnamed(said: Sequence[Mention], things: Mapping[str, CatalogueEntry], spoken: Collection[str]) -> list[str]:
    """Nouns and colours that no object answers to which the reading speaks of."""
    found = []
    for mention in dict.fromkeys(said):
        met = [things[name] for name in sorted(spoken) if mention.names(things[name])]
        if not met:
            found.append(f"the instruction names {mention.words!r}, but no goal speaks of such an object")
        else:
            missing = [colour for colour in mention.colours if not any(has_colour(entry, colour) for entry in met)]
            found += [f"{mention.words!r} asks for {c}, but no goal speaks of such an object" for c in missing]
    return found


def _unnamed(
    instruction: str, said: Sequence[Mention], things: Mapping[str, CatalogueEntry], reading: Reading
) -> list[str]:
    """Objects of goals that the instruction does not name, where it names others and every word of it is known."""
    words = tokens(instruction)
    named = {word for mention in said for word in tokens(mention.words)}
    known = FUNCTION_WORDS | VERBS | COLOURS | DETERMINERS | PARTS | NUMBERS.keys() | named | {"left", "right", "front"}
    if not said or _OPEN.intersection(words) or any(not {word, lemma(word)} & known for word in words):
        return []
    goals = [asked.goal for asked in reading.goals]
    told = [name for one in reading.descriptions for name in (one.subject, one.reference)]
    slots = [[goal.subject for goal in goals], [goal.reference for goal in goals]]
    found = []
    for mine, others in (slots, slots[::-1]):
        taken = [things[name] for name in (*others, *told) if name in things]
        if all(any(mention.names(entry) for entry in taken) for mention in said):
            continue  # "put the pens away" leaves open where to, "fill the box" with what
        for name, goal in zip(mine, goals, strict=True):
            by_part = goal.part is not None and goal.part.split("_")[0] in map(lemma, words)
            if name in things and not by_part and not any(mention.names(things[name]) for mention in said):
                found.append(f"{name} is in the goal {goal}, but the instruction names no such object")
    return list(dict.fromkeys(found))


def _miscounted(
    instruction: str,
    said: Sequence[Mention],
    things: Mapping[str, CatalogueEntry],
    reading: Reading,
    spoken: Collection[str],
) -> list[str]:
    """Number words that do not match how many objects of that name the reading speaks of."""
    subjects = {asked.goal.subject for asked in reading.goals}
    found = []
    for mention in said:
        if mention.number is None or not mention.noun or mention.noun[-1] in COUNTED:
            continue
        there = len([name for name in spoken if mention.names(things[name])])
        moved = len([name for name in subjects if mention.names(things[name])])
        alone = [other.noun for other in said].count(mention.noun) == 1 and not _MANY.intersection(tokens(instruction))
        if there < mention.number:
            found.append(f"{mention.words!r} asks for {mention.number}, but the goals speak of {there}")
        elif alone and moved > mention.number > 0:
            found.append(f"{mention.words!r} asks for {mention.number}, but goals are given for {moved}")
    return found


def _wrong_sides(instruction: str, reading: Reading) -> list[str]:
    """Sides in the instruction that the reading does not say, or the other way round."""
    text = " ".join(tokens(instruction))
    if _ARM.search(text) and any(asked.goal.relation == "handed" for asked in reading.goals):
        return []  # "from the left hand to the right one"
    stated = [asked.goal for asked in reading.goals] + list(reading.descriptions)
    relations = {one.relation for one in stated}
    arms = {asked.arm for asked in reading.goals} | {
        a.goal.reference for a in reading.goals if a.goal.relation == "handed"
    }
    parts = {word for one in stated for word in (one.part or "").split("_")}
    found = []
    for pattern, word, opposite in _SIDES if "scanned" not in relations else ():  # in front of the scanner
        if (said := re.search(pattern, text)) and word not in relations and not _ROW.search(text):
            other = f", but {opposite!r}" if opposite in relations else ""
            found.append(f"{said[0]!r} is asked, but no goal or description says {word!r}{other}")
    for side in _WHICH.findall(text):
        if side not in parts and not _on_side(side, reading):
            found.append(f"'the {side} …' is said, but no description has an object of a goal '{side}_of' another")
    if _ROW.search(text) and not relations & {"left_of", "right_of"}:
        found.append("a row from one side to the other is asked, but no goal says 'left_of' or 'right_of'")
    found += [f"'{side} arm' is said, but no goal names that arm" for side in _ARM.findall(text) if side not in arms]
    return found


def _on_side(side: str, reading: Reading) -> bool:
    """Check if some object of a goal is said to stand on that side at the start."""
    other = {"left": "right_of", "right": "left_of"}[side]
    there = {told.subject for told in reading.descriptions if told.relation == f"{side}_of"}
    there |= {told.reference for told in reading.descriptions if told.relation == other}
    return any({asked.goal.subject, asked.goal.reference} & there for asked in reading.goals)


def _wrong_parts(instruction: str, reading: Reading) -> list[str]:
    """Drawers that the instruction names and the reading does not, or the reverse; opening for closing."""
    words, text = set(tokens(instruction)), " ".join(tokens(instruction))
    stated = [asked.goal for asked in reading.goals] + list(reading.descriptions)
    parts = {one.part.partition("_")[2] for one in stated if one.part}
    meant = {_height(which): which for which in _DRAWER.findall(text)}
    found = [
        f"the {which} drawer is named, but no goal or description names a part '..._{height}'"
        for height, which in meant.items()
        if height not in parts and is_plain(instruction)
    ]
    if meant and not words & _WHICH_DRAWERS:
        wrong = sorted(part for part in parts - meant.keys() if part in ("top", "middle", "bottom"))
        found += [f"a goal or description names the {part} drawer, which the instruction does not" for part in wrong]
    done = {asked.goal.relation for asked in reading.goals} if is_plain(instruction) else set()
    pairs = (("open", _OPENING | _PULLING, _CLOSING), ("closed", _CLOSING | _PUSHING, _OPENING))
    for relation, one, other in pairs:
        if relation in done and words & other and not words & one:
            found.append(f"a goal says {relation!r}, but the instruction says {' and '.join(sorted(words & other))!r}")
    return found


def _height(which: str) -> str:
    return "top" if which in HIGHEST else "bottom" if which in LOWEST else which
