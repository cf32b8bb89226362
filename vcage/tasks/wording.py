"""Wordings of a sub-task or a whole task: one sentence for the critic and the log, and others for training."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import groupby, zip_longest
from typing import Literal, NamedTuple

from vcage.base.text import listed
from vcage.models.wordings import TaskToWord
from vcage.schema.goals import AskedGoal, Description, Goal, part_words
from vcage.schema.plan import TABLE

_MOVES = ("Put", "Place", "Set", "Move", "Bring", "Transfer")
_PUSHES = ("Push", "Slide", "Shove", "Shift")
A_TOOL = "a tool"
"""Stands for a tool that has no clear name."""


def wordings(goal: Goal, phrases: Mapping[str, str], pushed: bool = False, tool: str | None = None) -> list[str]:
    """Sentences that ask for a goal, ten and more, the plainest first.

    Args:
        goal: of the closed vocabulary.
        phrases: what to call each object, by id.
        pushed: True if a push achieves it.
        tool: id of the tool that it is done with.
    """
    called = A_TOOL if tool is None else f"the {phrases[tool]}"
    return worded(goal, *_named(goal, phrases), pushed=pushed, tool=called)


class Source(NamedTuple):
    """The thing that something is taken out of or off, by its name with an article."""

    out: Literal["out of", "off"]
    holder: str


def worded(
    goal: Goal,
    thing: str,
    place: str,
    *,
    several: bool = False,
    pushed: bool = False,
    source: Source | None = None,
    tool: str = A_TOOL,
) -> list[str]:
    """Sentences that ask for a goal of something, the plainest first.

    Args:
        goal: of the closed vocabulary.
        thing, place: what to call its subject and its reference, with their articles.
        several: the subject is more than one object.
        pushed: True if a push achieves it.
        source: the subject's source, if it is to be named.
        tool: what to call the tool that it is done with, with its article.
    """
    whole = thing if source is None else f"{thing} from {source.holder}"
    preps = goal.kind.prepositions
    if not preps:
        return _commands(goal, _part(goal.part, whole), place, tool)
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


def _commands(goal: Goal, thing: str, place: str, tool: str) -> list[str]:
    capital = thing[0].upper() + thing[1:]
    other = place if goal.kind.refers_to == "object" else goal.reference
    return [pattern.format(thing, capital, other, tool=tool) for pattern in goal.kind.commands.split("|")]


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
        phrases: name in the text → replacement.
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
        commands = [[_command(part, number) for part in step] for step in steps]
        text = ", then ".join(" and ".join(step) for step in commands)
        found.append(f"{text[0].upper()}{text[1:]}.")
    return list(dict.fromkeys(found))


def by_arm(texts: Sequence[str], arm: str) -> list[str]:
    """Commands with the arm that must do them."""
    sentences = [(text.rstrip("."), text[0].lower() + text[1:]) for text in texts if _is_command(text)]
    return [said for text, end in sentences for said in (f"{text} with the {arm} arm.", f"Use the {arm} arm to {end}")]


def _command(texts: Sequence[str], number: int) -> str:
    """One of the commands among some wordings, to stand within a sentence."""
    commands = [text for text in texts if _is_command(text) and not text.startswith("Pick up")] or [texts[0]]
    text = commands[number % len(commands)].rstrip(".")
    return text[0].lower() + text[1:]


def _is_command(text: str) -> bool:
    """True for a plain command, which others can follow in one sentence."""
    return text.endswith(".") and text.split()[0] not in ("Please", "The", "Make")


def template_wordings(task: TaskToWord, pushed: Collection[Goal] = ()) -> list[str]:
    """Sentences that ask for exactly the goals of a task, the plainest first; none where an object
    to name has no clear name.

    Args:
        task: the request, in its scene.
        pushed: goals achieved by a push.
    """
    steps = [[*group] for _, group in groupby(sorted(task.goals, key=lambda a: a.step), key=lambda a: a.step)]
    found = list[Sequence[str]]()
    for short in (False, True):
        parts = [[_part_wordings(task, part, short, pushed) for part in _together(task, step)] for step in steps]
        if all(texts for step in parts for texts in step):
            found.append(in_one_sentence(parts))
    return task.reviewed([text for pair in zip_longest(*found) for text in pair if text is not None])


def _together(task: TaskToWord, step: Sequence[AskedGoal]) -> Iterator[list[AskedGoal]]:
    """Goals of one command: several objects that go from one place to one place."""
    places: dict[object, list[AskedGoal]] = {}
    for number, asked in enumerate(step):
        goal, start = asked.goal, task.sources.get(asked.goal)
        alone = number if goal.kind.refers_to != "object" else None
        source = start and (start.relation, start.reference, start.part)
        places.setdefault((goal.relation, goal.reference, goal.part, asked.arm, source, alone), []).append(asked)
    yield from places.values()


def _part_wordings(task: TaskToWord, part: Sequence[AskedGoal], short: bool, pushed: Collection[Goal]) -> list[str]:
    """Wordings of goals that one command asks for; none where their objects have no clear name."""
    goal, arm = part[0].goal, part[0].arm
    thing = _thing(task, [asked.goal.subject for asked in part], short)
    place = _place(task, goal, short)
    start = task.sources.get(goal)
    holder = _holder(task, start, short) if start else ""
    if thing is None or place is None or holder is None:
        return []
    by_push = all(asked.goal in pushed for asked in part)
    source = Source("out of" if start.relation == "inside" else "off", holder) if start else None
    tool, several = _tool(task, goal, short), len(part) > 1
    texts = worded(goal, thing, place, several=several, pushed=by_push, source=source, tool=tool)
    return by_arm(texts, arm) if arm is not None else texts


def _tool(task: TaskToWord, goal: Goal, short: bool) -> str:
    """Name the tool that a goal takes; :data:`A_TOOL` where that is not clear."""
    kind = goal.kind.tool
    used = dict.fromkeys(name for name in task.tools if name in task.things)
    tools = [name for name in used if kind is not None and getattr(task.things[name], kind)]
    return (_thing(task, tools, short) if len(tools) == 1 else None) or A_TOOL


def _thing(task: TaskToWord, ids: Sequence[str], short: bool) -> str | None:
    """Name one or several objects, with articles; None where one has no clear name."""
    names = [*_names(task, ids, short)]
    if None in names:
        return None
    named = [name for name in names if name is not None]
    return named[0] if len(named) == 1 else f"{listed(named[:-1], most=len(named))} and {named[-1]}"


def _names(task: TaskToWord, ids: Sequence[str], short: bool) -> Iterator[str | None]:
    """Names of objects, those of one kind (or in full: of one phrase) together where a name means exactly them."""
    alike: dict[str, list[str]] = {}
    by_kind = short or bool(task.quantified)
    for name in ids:
        alike.setdefault(task.things[name].name if by_kind else task.phrases[name], []).append(name)
    for group in alike.values():
        names = task.names.calls(group, every=bool(task.quantified))
        if names:
            yield min(names, key=len) if short else names[0]
        elif short and len(group) > 1:
            yield from _names(task, group, short=False)
        else:
            yield None


def _holder(task: TaskToWord, start: Description, short: bool) -> str | None:
    """Name an object's source; None where it has no clear name."""
    name = _thing(task, [start.reference], short)
    return name if name is None or start.part is None else f"the {part_words(start.part)} of {name}"


def _place(task: TaskToWord, goal: Goal, short: bool) -> str | None:
    if goal.reference is None or goal.reference not in task.things:
        return f"the {TABLE}" if goal.reference == TABLE else str(goal.reference)
    return _thing(task, [goal.reference], short)
