"""Sides, arms and drawers that an instruction names, by the place of their words."""

from __future__ import annotations

import re
from collections.abc import Collection

from vcage.base.words import COUNTED, HIGHEST, LOWEST, WHICH_PART
from vcage.models.phrases import compiled, phrase


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
_OWNED = re.compile(
    r"\b(the|my|a) ((?:\w+ ){0,2}\w+)(?:'s|s') (left|right)\b(?: hand)?(?: side)?(?! (?:arm|hand|gripper)\b)"
)
"""A side of a thing: "the plate's left"."""
_ARM = compiled(
    phrase("<left|right> [robot|robotic] (arm|arms|hand|hands|gripper|grippers)", not_before="side*"),
    phrase("(with|use|using) (the|your|its) <left|right> [one]", before="(to|and|then|,|.|;)", or_end=True),
)
ROW = compiled(phrase("from [the] (left|right) to [the] (left|right)"))
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


def plain_sides(text: str) -> str:
    """A text in which "the plate's left" is "the left of the plate"."""
    return _OWNED.sub(r"\1 \3 of \1 \2", text)


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
        parts: names of the parts that there are.
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
