"""What a sub-task is called: one sentence for the critic and the log, and others that say the same, for training."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple

from vcage.schema.goals import Goal, part_words

_PREPOSITIONS: Mapping[str, Sequence[str]] = {
    "inside": ("into", "in", "inside"),
    "on": ("onto", "on", "on top of"),
    "left_of": ("to the left of", "left of", "on the left side of"),
    "right_of": ("to the right of", "right of", "on the right side of"),
    "in_front_of": ("in front of", "just in front of"),
    "behind": ("behind", "just behind"),
    "beside": ("beside", "next to", "by the side of"),
    "near": ("near", "close to", "not far from"),
}
_MOVES = ("Put", "Place", "Set", "Move", "Bring", "Transfer")
_PUSHES = ("Push", "Slide", "Shove", "Shift")
_PATTERNS: Mapping[str, str] = {
    "open": "Open {0}.|Open up {0}.|Pull {0} open.|Get {0} open.|Please open {0}.|{1} should be open."
    "|Make sure {0} is open.|Could you open {0}?|Could you get {0} open?|Have {0} opened.",
    "closed": "Close {0}.|Shut {0}.|Push {0} shut.|Get {0} closed.|Please close {0}.|{1} should be closed."
    "|Make sure {0} is closed.|Could you shut {0}?|Could you close {0}?|Have {0} closed.",
    "pressed": "Press {0}.|Push {0}.|Push down {0}.|Press {0} down.|Press down on {0}.|Please press {0}."
    "|Give {0} a press.|Could you press {0}?|Hit {0}.|Have {0} pressed.",
    "weighed": "Weigh {0}.|Weigh {0} on the scale.|Put {0} on the scale and weigh it.|Find out how heavy {0} is."
    "|Check the weight of {0}.|Please weigh {0}.|Could you weigh {0}?|Have {0} weighed.|Get {0} weighed."
    "|See what {0} weighs.|{1} must be weighed.",
    "scanned": "Scan {0}.|Scan the bar code of {0}.|Read the bar code of {0}.|Scan {0} with the scanner."
    "|Hold the scanner to the code of {0}.|Please scan {0}.|Could you scan {0}?|Have {0} scanned.|Get {0} scanned."
    "|Use the scanner on {0}.|{1} must be scanned.",
    "presented": "Show {0} to the customer.|Present {0} to the customer.|Show the customer {0}."
    "|Turn {0} towards the customer.|Hand {0} to the customer.|Put {0} before the customer.|Pass {0} to the customer."
    "|Please show {0} to the customer.|Let the customer see {0}.|Bring {0} to the customer's side."
    "|Give the customer {0}.",
    "back": "Put {0} back.|Put {0} back where it was.|Return {0} to its place.|Bring {0} back.|Set {0} back."
    "|Move {0} back to where it stood.|Place {0} where it stood before.|Please put {0} back."
    "|Could you put {0} back?|{1} goes back to its place.",
    "handed": "Hand {0} to the {2} arm, which puts it down.|Hand {0} over to the {2} arm.|Pass {0} to the {2} arm."
    "|Give {0} to the {2} arm.|Hand {0} from one arm to the other.|Pass {0} from hand to hand."
    "|Let the {2} arm take {0} over from the other arm.|Please hand {0} to the {2} arm."
    "|Could you pass {0} to the {2} arm?|Move {0} over into the {2} arm's gripper.|Transfer {0} to the {2} arm."
    "|{1} is handed over to the {2} arm.",
    "turned": "Turn {0}.|Turn {0} on.|Rotate {0}.|Twist {0}.|Give {0} a turn.|Please turn {0}."
    "|Turn {0} as far as it goes.|Could you turn {0}?|Could you give {0} a turn?|Have {0} turned.",
}


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
        several: whether the subject is more than one object.
        pushed: whether it is brought about by a push.
        source: what the subject is taken from, where that is to be said.
    """
    whole = thing if source is None else f"{thing} from {source.holder}"
    if goal.relation not in _PREPOSITIONS:
        return _patterned(goal, _part(goal.part, whole))
    place = _part(goal.part, place)
    preps = _PREPOSITIONS[goal.relation]
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


def _patterned(goal: Goal, thing: str) -> list[str]:
    capital = thing[0].upper() + thing[1:]
    return [pattern.format(thing, capital, goal.reference) for pattern in _PATTERNS[goal.relation].split("|")]


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
    """Whether a sentence tells what to do straight away, so that others can follow it in one."""
    return text.endswith(".") and text.split()[0] not in ("Please", "The", "Make")
