"""Actions of a robot in words, in the first person and past tense, from the commands of its sub-tasks."""

from __future__ import annotations

import re
from collections.abc import Sequence

from vcage.base.text import listed

PAST = {
    "put": "put", "set": "set", "shut": "shut", "let": "let", "hit": "hit", "read": "read", "cut": "cut",
    "bring": "brought", "hold": "held", "take": "took", "give": "gave", "get": "got", "go": "went", "make": "made",
    "find": "found", "see": "saw", "have": "had", "lay": "laid", "pick": "picked", "slide": "slid", "hang": "hung",
    "stand": "stood", "stick": "stuck", "sweep": "swept", "leave": "left", "shake": "shook", "spin": "spun",
    "throw": "threw",
    "draw": "drew", "swing": "swung", "wind": "wound", "bend": "bent", "transfer": "transferred", "drop": "dropped",
    "grab": "grabbed", "grip": "gripped", "plug": "plugged", "unplug": "unplugged", "tip": "tipped", "tap": "tapped",
    "dip": "dipped", "stop": "stopped", "wrap": "wrapped", "flip": "flipped", "pat": "patted", "pin": "pinned",
    "scan": "scanned", "plan": "planned",
}  # fmt: skip
"""Verb → its past tense, where adding "-ed" would be wrong."""


def memory_of(done: Sequence[str]) -> str:
    """Return one sentence about finished sub-tasks, in their order: ``I opened the drawer and put the pen into it.``

    Args:
        done: their texts, which begin with a verb in the imperative; at least one.
    """
    said = [in_past(text) for text in done]
    earlier = f"{listed(said[:-1], most=len(said))} and " if said[1:] else ""
    return f"I {earlier}{said[-1]}."


def in_past(text: str) -> str:
    """Return a command in the past tense, without a subject or a full stop: ``put the pen into the box``."""
    verb, space, rest = text.strip().rstrip(".!").partition(" ")
    rest = re.sub(r", which puts\b", ", which put", rest)
    return f"{past_of(verb.lower())}{space}{rest}"


def past_of(verb: str) -> str:
    """Return the past tense of a verb."""
    if verb in PAST:
        return PAST[verb]
    if verb.endswith("e"):
        return f"{verb}d"
    return f"{verb[:-1]}ied" if re.search(r"[^aeiou]y$", verb) else f"{verb}ed"
