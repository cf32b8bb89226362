"""Check a reading against the sides, arms and drawers that an instruction names, by the place of their words."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence

from vcage.base.words import COUNTED, HIGHEST, LOWEST, WHICH_PART
from vcage.models.checked_reading import CheckedReading
from vcage.models.phrases import compiled, phrase
from vcage.objects.mentions import Noun
from vcage.plans.descriptions import HOLDING
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import Description, Goal, Reading


def _to_side(side: str) -> tuple[str, str]:
    return (
        phrase(f"(to|on|at) (the|its) [far|very] {side} [hand]", before="(of|side|and|then|#)", or_end=True),
        phrase(f"{side} [hand] [side] of"),
    )


SIDES: tuple[tuple[re.Pattern[str], str, str], ...] = (
    (compiled(*_to_side("left")), "left_of", "right_of"),
    (compiled(*_to_side("right")), "right_of", "left_of"),
    (
        compiled(phrase("in front of", not_before="[the|a|our|your] (customer|client|robot|me|us|you)")),
        "in_front_of",
        "behind",
    ),
    (compiled(phrase("behind")), "behind", "in_front_of"),
)
"""Words for a side, the relation that they ask for, and the opposite one."""
_ARM = compiled(
    phrase("<left|right> [robot|robotic] (arm|arms|hand|hands|gripper|grippers)", not_before="side*"),
    phrase("(with|use|using) (the|your|its) <left|right> [one]", before="(to|and|then|,|.|;)", or_end=True),
)
ROW = compiled(phrase("from [the] (left|right) to [the] (left|right)"), phrase("in [a|the] (row|line)"))
"""A row of things, in which no single side is meant."""
DRAWER = "drawer|shelf|compartment|layer|one"
"""Words for a drawer."""
_HEIGHTS = "|".join((*HIGHEST, *LOWEST))
_NTH = "|".join(COUNTED[:3])
_WHICH_HEIGHT = compiled(
    phrase(f"<nth={_NTH}> [{DRAWER}] [from the|to the|from] <end={_HEIGHTS}>"),
    phrase(f"<step={_NTH}> ({DRAWER}) <way=down|up>"),
    phrase(f"<height={_HEIGHTS}|middle> ({DRAWER})"),
    phrase(f"({DRAWER}) (at|in|on) the <at={_HEIGHTS}|middle>"),
    phrase("<most=highest|uppermost|topmost|lowest|bottommost|middle> [one] of the [_] drawers"),
)
"""One of several drawers: "the second drawer from the top", "the top drawer"."""
_WAYS = {"down": "top", "up": "bottom"}


def sides(text: str) -> dict[int, str]:
    """Relations that a text of words and marks asks for, by the place of their words."""
    if ROW.search(text):
        return {}
    return {place(text, found): word for pattern, word, _ in SIDES for found in pattern.finditer(text)}


def arms(text: str) -> dict[int, str]:
    """Arms that a text of words and marks names, by the place of their words."""
    return {place(text, found): found[1] or found[2] for found in _ARM.finditer(text)}


def heights(text: str, parts: Collection[str]) -> dict[int, str]:
    """Ends of the names of drawers that a text of words and marks asks for, by the place of their words.

    Args:
        parts: names of the parts.
    """
    ends = {part.rpartition("_")[2] for part in parts}
    order = [height for height in ("top", "middle", "bottom") if height in ends]
    found = {}
    for said in _WHICH_HEIGHT.finditer(text):
        number = COUNTED.index(said["nth"] or said["step"] or COUNTED[0])
        height = {**WHICH_PART, **_WAYS}[next(filter(None, said.group("end", "height", "at", "most", "way")))]
        counted = [*dict.fromkeys((height, *order[:: -1 if height == "bottom" else 1]))]
        found |= {place(text, said): height for height in counted[number : number + 1]}
    return found


def place(text: str, found: re.Match[str]) -> int:
    """The number of words before a match."""
    return text.count(" ", 0, found.start())


_WHICH = compiled(r"\bthe (left|right)(?:most|hand| hand)? (?!arm\b|hand\b|gripper\b|side\b|way\b|of\b|one\b)\w+")
"""One of several things: "the leftmost mug"."""
_BOTH_ARMS = compiled(
    phrase("(arms|hands|grippers)"), phrase("(other|each|one|either|opposite) (arm|hand|gripper|one)")
)
_TO_ARM = compiled(phrase("to [the|its|your] <left|right>", not_before="(of|side)"))
_FROM = compiled(phrase("(from|out of) [inside|within|in] [the|my|your]", or_end=True))
_ANY_DRAWER = compiled(
    phrase("(both|all|each|every|other|others|same|any|drawers|them)"),
    phrase(f"({'|'.join(COUNTED)}|next|last) ({DRAWER})", not_before="(from|to)"),
)
"""Words for a drawer that may be another one than the top, middle or bottom drawer."""


def wrong_sides(read: CheckedReading) -> list[str]:
    """Complaints about sides that the instruction names and the reading does not, or names of something else."""
    text, relations = read.task.text, {one.relation for one in read.reading.stated}
    if "handed" in relations:  # "from the left hand to the right one"
        return []
    if ROW.search(text):
        row = {"row_left_of", "left_of", "right_of"}.intersection(relations)
        return [] if row else ["a row from one side to the other is asked, but no goal says 'row_left_of'"]
    found = [
        f"'the {side} …' is said, but no description has an object of a goal '{side}_of' another"
        for side in _WHICH.findall(text)
        if not _on_side(side, read.reading)
    ]
    if "scanned" not in relations:  # in front of the scanner
        found += _side_complaints(text, relations, read.relations)
        found += _of_another(read)
    return found


def _side_complaints(text: str, relations: Collection[str], goals: Collection[str]) -> list[str]:
    """Words for a side without a relation, and goals for the opposite of the only side in the text."""
    found, asked = list[str](), sides(text).values()
    for pattern, word, opposite in SIDES:
        match = pattern.search(text)
        if match and word not in relations:
            other = f", but {opposite!r}" if opposite in relations else ""
            found.append(f"{match[0]!r} is asked, but no goal or description says {word!r}{other}")
        elif match and opposite in goals and opposite not in asked:
            found.append(f"a goal says {opposite!r}, but the instruction asks for {word!r} alone")
    return found


def _of_another(read: CheckedReading) -> list[str]:
    """Words for a side of something that the reading says of other things alone."""
    text, stated = read.task.text, read.reading.stated
    return [
        f"'{match[0]} {noun.words}' is asked, but no goal or description says that of it"
        for pattern, word, opposite in SIDES
        for match in pattern.finditer(text)
        if any(one.relation == word for one in stated)
        and (noun := _side_of(text.count(" ", 0, match.end()), text, read.said))
        and not any(_is_relation_of(one, word, opposite, noun, read.things) for one in stated)
    ]


def _side_of(at: int, text: str, said: Sequence[Noun]) -> Noun | None:
    """The noun right after the words of a side that end at a place: "left of" the "plate"."""
    words = text.split(" ")
    after = next(
        place for place in range(at + 1, len(words) + 1) if words[place : place + 1] not in (["hand"], ["side"])
    )
    if words[after : after + 1] == ["of"]:
        after += 1
    elif words[at] not in ("of", "behind"):
        return None
    near = [noun for noun in said if after <= noun.at <= after + 1 and noun.name]
    return near[0] if near else None


def _is_relation_of(
    one: Goal | Description, word: str, opposite: str, noun: Noun, things: Mapping[str, CatalogueEntry]
) -> bool:
    """Check if a relation puts a noun's object on a side, in either direction."""
    name = {word: one.reference, opposite: one.subject}.get(one.relation)
    return name in things and noun.may_mean(things[name])


def _on_side(side: str, reading: Reading) -> bool:
    """Check if an object of a goal, or its holder, is described to start on that side, or a part is named after it."""
    if any(side in (one.part or "").split("_") for one in reading.stated):
        return True
    other = {"left": "right_of", "right": "left_of"}[side]
    there = {described.subject for described in reading.descriptions if described.relation == f"{side}_of"}
    there |= {described.reference for described in reading.descriptions if described.relation == other}
    lying = [described for described in reading.descriptions if described.relation in HOLDING]
    return any({one.subject, one.reference} & there for one in (*(asked.goal for asked in reading.goals), *lying))


def _swaps_side(side: str, reading: Reading) -> bool:
    """True where a side may tell a thing that is swapped: "the left mug with the right one"."""
    return any(asked.goal.relation == "in_place_of" for asked in reading.goals) and _on_side(side, reading)


def wrong_arms(read: CheckedReading) -> list[str]:
    """Complaints about arms that the instruction names and no goal, or the reverse, and about the wrong giving hand."""
    text, goals = read.task.text, read.reading.goals
    handed = [str(asked.goal.reference) for asked in goals if asked.goal.relation == "handed"]
    if handed:
        to = _TO_ARM.findall(text)
        wrong = {*handed}.difference(to) if to else ()
        return [f"it is handed {arm!r}, but the instruction says 'to the {to[0]}'" for arm in sorted(wrong)]
    said, used = {*arms(text).values()}, {str(asked.arm) for asked in goals} - {"None"}
    missing = sorted(arm for arm in said - used if not _swaps_side(arm, read.reading))
    found = [f"'{arm} arm' is said, but no goal names that arm" for arm in missing]
    allowed = used if said and _BOTH_ARMS.search(text) else said
    return found + [f"a goal names the {arm} arm, but the instruction does not" for arm in sorted(used - allowed)]


def wrong_drawers(read: CheckedReading) -> list[str]:
    """Complaints about drawers that the instruction names and the reading does not, or the reverse."""
    task, stated = read.task, read.reading.stated
    owners = [one.reference or one.subject for one in stated if one.part]
    there = [part for name in owners if name in read.things for part in read.things[name].moving_parts]
    meant, named = {*heights(task.text, there).values()}, {*heights(task.open_text, there).values()}
    parts = {one.part.partition("_")[2] for one in stated if one.part}
    found = [
        f"the {height} drawer is named, but no goal or description names a part '..._{height}'"
        for height in sorted(meant - parts)
    ]
    found += _wrong_sources(read, there)
    other = named and not _ANY_DRAWER.search(task.open_text)
    wrong = sorted((parts - named) & {"top", "middle", "bottom"}) if other else ()
    return found + [f"a goal or description names the {part} drawer, which the instruction does not" for part in wrong]


def _wrong_sources(read: CheckedReading, parts: Collection[str]) -> list[str]:
    """Complaints about drawers after "from the" or "out of the" that no description names."""
    text, words = read.task.text, read.task.text.split(" ")
    starts = {(described.part or "").rpartition("_")[2] for described in read.reading.descriptions}
    taken = {height for at, height in heights(text, parts).items() if _FROM.search(" ".join(words[:at]))}
    return [
        f"something is taken from the {height} drawer, but no description names a part '..._{height}'"
        for height in sorted(taken - starts)
    ]
