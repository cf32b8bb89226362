"""Which arm does what a sentence asks for: "one arm" may be any, and "the other arm" follows from what came before."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from vcage.models.rules.commands import ONE_ARM, OTHER_ARM, Command
from vcage.models.rules.nouns import Conflict

_OTHER = {"left": "right", "right": "left", ONE_ARM: "right"}
"""The other arm; of an arm that is left open, the right one."""


def with_arms(commands: Sequence[Command]) -> list[Command]:
    """Commands with an arm only where it must be that one: "the other arm" is named by what came before.

    While one arm holds something up, the other is the only one that can do what comes then.

    Raises:
        Conflict: nothing before it named an arm.
    """
    last: str | None = None
    holds, later = False, 0.0
    found = []
    for command in commands:
        if command.arm == OTHER_ARM and last == ONE_ARM and holds:
            command, later = replace(command, arm=ONE_ARM), 0.5  # after its own group, before the next
        command, holds = replace(command, group=command.group + later), holds or command.verb == "hold"
        command = _with_other_arm(command, last)
        last = command.arm or last
        found.append(replace(command, arm=None) if command.arm == ONE_ARM else command)
    return found


def _with_other_arm(command: Command, last: str | None) -> Command:
    """A command with the arm that "the other arm" means after the arm that was named last.

    Raises:
        Conflict: no arm was named.
    """
    if OTHER_ARM not in (command.arm, command.how):
        return command
    before = last if command.arm == OTHER_ARM else command.arm or last
    if before is None or (before == ONE_ARM and command.how != OTHER_ARM):
        raise Conflict(command.words, "say which arm it is: left or right")
    other = _OTHER[before]
    return replace(command, arm=other) if command.arm == OTHER_ARM else replace(command, how=other)
