"""Vessels that a sentence asks to empty: which they are, and what lies in them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from vcage.base.text import listed
from vcage.models.rules.commands import Command
from vcage.models.rules.meanings import Meanings, Things
from vcage.models.rules.nouns import Doubt, Noun


@dataclass(frozen=True)
class Vessels:
    """The vessels of a scene.

    Args:
        things: catalogue's entries by object id.
        lying: object id → id of its container or support.
        meanings: of the sentence's nouns.
    """

    things: Things
    lying: Mapping[str, str]
    meanings: Meanings

    def emptied(self, command: Command, names: Sequence[str], held: Sequence[Command]) -> list[str]:
        """The vessels that a command empties; where it names what is poured, it lies in them at the start.

        Args:
            command: to pour.
            names: objects that it names.
            held: commands by which things were picked up before.

        Raises:
            Doubt: nothing says which vessel it is, or what is named does not roll.
        """
        balls = [name for name in names if self.things[name].loose]
        if not balls:
            if command.source is not None:
                raise Doubt(command.words, f"{names[0]} does not roll: only balls are poured")
            return [*names]
        if said := _said(command):
            return self.meanings.objects(said)
        if len(held) == 1:
            for name in balls:
                self.meanings.lies(name, "in", held[0].things[0])
            return self.meanings.objects(held[0].things[0])
        holders = list(dict.fromkeys(self.lying.get(name, "") for name in balls))
        if len(balls) < len(names) or len(holders) != 1 or not holders[0]:
            raise Doubt(command.words, "say what they are poured out of, as in: from the cup")
        for name in balls:
            self.meanings.describe(name, "inside", holders[0], command.things[0])
        return holders

    def require(self, command: Command, name: str) -> None:
        """Refuse to pour what is no vessel that a hand takes, or has nothing in it, or more than is said.

        Raises:
            Doubt: says which.
        """
        if not self._is_vessel(name):
            raise Doubt(command.words, f"{name} is no vessel that a hand takes and tips")
        said = {d.subject for d in self.meanings.descriptions.values() if d.reference == name}
        there = said | {thing for thing, holder in self.lying.items() if holder == name}
        if not there:
            raise Doubt(command.words, f"nothing is said to lie in {name}; say what is poured out of it")
        if said and there > said:
            others = listed(sorted(there - said))
            raise Doubt(command.words, f"all that lies in {name} is poured out of it, {others} too")

    def require_none(self, command: Command, names: Sequence[str]) -> None:
        """Refuse to put things somewhere that are to be dumped there, if one is a vessel.

        Raises:
            Doubt: it is emptied.
        """
        if any(map(self._is_vessel, names)):
            raise Doubt(command.words, "it is emptied")

    def _is_vessel(self, name: str) -> bool:
        entry = self.things[name]
        return entry.holds_loose and entry.can_be_carried


def is_dumped(command: Command) -> bool:
    """True where things are dumped into others: a vessel is emptied so, anything else is put there."""
    return command.how == "in" and "dump" in command.words.lower().split()


def _said(command: Command) -> Noun | None:
    """The noun of a command for what things are poured out of."""
    relations = [other for noun in command.things for how, other in noun.relations if how == "in"]
    return next(iter(relations), command.source)
