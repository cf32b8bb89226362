"""Common requests that the robot cannot be given: each is refused with what to say in its place."""

from __future__ import annotations

import re
from dataclasses import dataclass

from vcage.base.errors import UnreadInstruction


@dataclass(frozen=True)
class Wish:
    """Words of a request that the robot cannot be given.

    Args:
        pattern: of the words.
        why: reason for which they are not understood.
        instead: what can be said in their place.
    """

    pattern: re.Pattern[str]
    why: str
    instead: str


WISHES = (
    Wish(
        re.compile(r"\b(?:(?:the )?(?:other|second|free|opposite)|another) (?:arm|hand|gripper)\b", re.IGNORECASE),
        "it does not say which arm that is",
        "say 'to the left arm' or 'to the right arm'",
    ),
    Wish(
        re.compile(r"\bby (?:their )?(?:colou?r|size|shape|kind|type|height|weight)s?\b", re.IGNORECASE),
        "the robot does not sort by itself",
        "say where each thing goes: 'Put the red block on the plate and the blue block in the bowl'",
    ),
    Wish(re.compile(r"\bupside[ -]down\b", re.IGNORECASE), "things are put down as they stand", "leave it out"),
)


def require_tellable(instruction: str) -> None:
    """Refuse an instruction that is not understood because it holds one of :data:`WISHES`.

    Raises:
        UnreadInstruction: it holds one of them; the hint says what to say in its place.
    """
    for wish in WISHES:
        found = wish.pattern.search(instruction)
        if found is not None:
            raise UnreadInstruction(
                f"{found[0]!r} in {instruction!r} is not understood: {wish.why}",
                hint=wish.instead,
                details={"unread": found[0], "understood": []},
            )
