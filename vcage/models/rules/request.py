"""What one clause of an instruction asks for, in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from vcage.models.rules.phrases import Phrase

Asked = Literal["put", "open", "close", "press", "turn", "scan", "weigh", "present", "hand", "tower", "back", "leave"]
"""What a request asks for. ``put`` says where by its preposition; ``leave``: not to be touched."""

ENDS = ("", "and", "then", "stop", "query", "also", "before", "after", "remark")
"""Kinds of tokens before which a clause may end."""


@dataclass(frozen=True)
class Request:
    """One thing that a clause asks for.

    Args:
        asked: what.
        things: what it is done to.
        place: where to, or beside what; None where no place is named.
        preposition: how the place is meant: ``in, on, to, beside, near, left_of, right_of, in_front_of, behind``; for
            ``hand`` the arm that gets it.
        tools: what it is done with ("scan it with the scanner").
        sources: (thing, place) of what is in or on a place at the start ("take the pen out of the cup").
        step: requests of an earlier step come first.
        start, end: the words that ask for it, in characters of the instruction.
    """

    asked: Asked
    things: tuple[Phrase, ...]
    place: Phrase | None = None
    preposition: str = ""
    tools: tuple[Phrase, ...] = ()
    sources: tuple[tuple[Phrase, Phrase], ...] = ()
    step: int = 0
    start: int = 0
    end: int = 0
