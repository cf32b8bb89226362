"""From a sentence to goals in a scene: every reading of it is grounded, and all that can be must agree."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from vcage.base.errors import NoAssetFits
from vcage.models.rules.commands import Command
from vcage.models.rules.goals import Goals
from vcage.models.rules.grammar import not_read
from vcage.models.rules.meanings import Things
from vcage.models.rules.nouns import Conflict, Doubt
from vcage.models.rules.pronouns import resolved
from vcage.models.rules.sentence import parse
from vcage.models.rules.too_little import require_plain
from vcage.schema.goals import Reading


def read_goals(instruction: str, things: Things, lying: Mapping[str, str] | None = None) -> Reading:
    """The goals of an instruction in a scene.

    Args:
        instruction: a sentence of one of the forms of docs/instructions.md.
        things: catalogue's entries by object id, each with the object's own look only.
        lying: object id → id of its container or support.

    Raises:
        UnreadInstruction: the sentence is of no form that is read, or its readings differ in this scene.
    """
    return agreed(instruction, lambda commands: Goals(things, lying or {}, commands).read(), in_words)


def agreed(instruction: str, ground: Callable[[tuple[Command, ...]], Any], as_text: Callable[[Any], str]) -> Any:
    """Ground every reading of a sentence; all that can be grounded must agree.

    Args:
        instruction: the sentence.
        ground: turns the commands of one reading into goals; a :class:`Doubt` drops the reading.
        as_text: the goals in plain words, which differ where the readings do.

    Raises:
        UnreadInstruction: the readings differ, or there is none.
    """
    found: dict[str, Any] = {}
    doubts: list[Doubt | NoAssetFits] = []
    for commands in (way for parsed in parse(instruction) for way in resolved(parsed)):
        try:
            require_plain(commands)
            result = ground(commands)
            found.setdefault(as_text(result), result)
        except (Doubt, NoAssetFits) as doubt:
            doubts.append(doubt)
    conflicts = [doubt for doubt in doubts if isinstance(doubt, Conflict)]
    if len(found) > 1:
        conflicts.append(Conflict("", _two_meanings(instruction, [*found][:2])))
    if not conflicts and found:
        return next(iter(found.values()))
    doubt = [*conflicts, *doubts, Doubt("", "what 'it' or 'them' means is open")][0]
    raise not_read(instruction, *doubt.args) if isinstance(doubt, Doubt) else doubt


def _two_meanings(instruction: str, meanings: Sequence[str]) -> str:
    told = f"it can mean two things: {'; or '.join(meanings)}"
    dumped = "dump" in instruction.lower().split() and len({" poured " in one for one in meanings}) > 1
    return f"{told}; say pour, or put, in place of dump" if dumped else told


def in_words(reading: Reading) -> str:
    """A reading in plain words."""
    goals = sorted((asked.step, str(asked.goal), asked.arm or "") for asked in reading.goals)
    texts = [f"{goal}{f' by the {arm} arm' if arm else ''}" for _, goal, arm in goals]
    texts += [f"{one} at the start" for one in sorted(map(str, reading.descriptions))]
    return ", ".join([*texts, *(f"{name} left alone" for name in sorted(reading.untouched))])
