"""Wordings of a sub-task: one sentence for the critic and the log, and others that say the same, for training."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple

from vcage.schema.goals import Goal, part_words

_MOVES = ("Put", "Place", "Set", "Move", "Bring", "Transfer")
_PUSHES = ("Push", "Slide", "Shove", "Shift")


def wordings(goal: Goal, phrases: Mapping[str, str]) -> list[str]:
    """Sentences that ask for a goal, ten and more, the plainest first.

    Args:
        goal: of the closed vocabulary.
        phrases: what to call each object, by id.
    """
    return worded(goal, *_named(goal, phrases))


def push_wordings(goal: Goal, phrases: Mapping[str, str]) -> list[str]:
    """Sentences that ask for a relation to be brought about by a push, ten and more, the plainest first.

    Args:
        goal, phrases: see :func:`wordings`.
    """
    return worded(goal, *_named(goal, phrases), pushed=True)


class Source(NamedTuple):
    """The thing that something is taken out of or off, by its name with an article."""

    out: Literal["out of", "off"]
    holder: str


def worded(
    goal: Goal, thing: str, place: str, *, several: bool = False, pushed: bool = False, source: Source | None = None
) -> list[str]:
    """Sentences that ask for a goal of something, the plainest first.

    Args:
        goal: of the closed vocabulary.
        thing, place: what to call its subject and its reference, with their articles.
        several: the subject is more than one object.
        pushed: it is brought about by a push.
        source: what the subject is taken from, where that is to be said.
    """
    whole = thing if source is None else f"{thing} from {source.holder}"
    preps = goal.kind.prepositions
    if not preps:
        return _commands(goal, _part(goal.part, whole))
    place = _part(goal.part, place)
    if pushed:
        return _pushed(whole, preps, place)
    them, go = ("them", "go") if several else ("it", "goes")
    then = f"and put {them} {preps[0]} {place}"
    taken = [] if source is None else [f"Take {thing} {source.out} {source.holder} {then}."]
    first, *others = preps
    return [
        f"{_MOVES[0]} {whole} {first} {place}.",
        *taken,
        *(f"{move} {whole} {first} {place}." for move in _MOVES[1:]),
        *(f"{move} {whole} {prep} {place}." for prep in others for move in _MOVES[:3]),
        f"Pick up {whole} {then}.",
        f"T{whole[1:]} {go} {preps[1]} {place}.",
        f"Could you put {whole} {preps[1]} {place}?",
    ]


def _commands(goal: Goal, thing: str) -> list[str]:
    capital = thing[0].upper() + thing[1:]
    return [pattern.format(thing, capital, goal.reference) for pattern in goal.kind.commands.split("|")]


def _pushed(thing: str, preps: Sequence[str], place: str) -> list[str]:
    commands = [f"{move} {thing} {prep} {place}." for prep in preps for move in _PUSHES]
    return [*commands, f"Could you push {thing} {preps[0]} {place}?", f"Please slide {thing} {preps[0]} {place}."]


def _named(goal: Goal, phrases: Mapping[str, str]) -> tuple[str, str]:
    return f"the {phrases[goal.subject]}", f"the {phrases.get(goal.reference or '', str(goal.reference))}"


def _part(part: str | None, owner: str) -> str:
    return owner if part is None else f"the {part_words(part)} of {owner}"


def in_other_words(text: str, phrases: Mapping[str, str]) -> str:
    """A text with other names for things, all exchanged at once: red for blue, and blue for red.

    Args:
        text: a sentence.
        phrases: what something is called there → what it is called instead.
    """
    longest_first = sorted(phrases, key=len, reverse=True)
    pattern = rf"\b(?:{'|'.join(map(re.escape, longest_first))})\b"
    return re.sub(pattern, lambda found: phrases[found[0]], text) if phrases else text


def in_one_sentence(steps: Sequence[Sequence[Sequence[str]]]) -> list[str]:
    """Sentences that say a whole task, the plainest first: "then" between its steps, "and" within one.

    Args:
        steps: of each step in order the wordings of each of its parts, which may come in any order.
    """
    parts = [part for step in steps for part in step]
    if len(parts) == 1:
        return list(parts[0])
    found = []
    for number in range(max(map(len, parts))):
        told = [[_command(part, number) for part in step] for step in steps]
        text = ", then ".join(" and ".join(step) for step in told)
        found.append(f"{text[0].upper()}{text[1:]}.")
    return list(dict.fromkeys(found))


def by_arm(texts: Sequence[str], arm: str) -> list[str]:
    """Commands with the arm that must do them."""
    told = [(text.rstrip("."), text[0].lower() + text[1:]) for text in texts if _is_command(text)]
    return [said for text, end in told for said in (f"{text} with the {arm} arm.", f"Use the {arm} arm to {end}")]


def _command(texts: Sequence[str], number: int) -> str:
    """One of the commands among some wordings, to stand within a sentence."""
    commands = [text for text in texts if _is_command(text) and not text.startswith("Pick up")] or [texts[0]]
    text = commands[number % len(commands)].rstrip(".")
    return text[0].lower() + text[1:]


def _is_command(text: str) -> bool:
    """True for a plain command, which others can follow in one sentence."""
    return text.endswith(".") and text.split()[0] not in ("Please", "The", "Make")
