"""Tools of a sentence: the tests of what a command can be done with, and the one tool that it means."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from vcage.base.text import listed
from vcage.models.rules.commands import Command
from vcage.models.rules.meanings import Meanings, Things
from vcage.models.rules.nouns import Doubt, Noun
from vcage.schema.asset import CatalogueEntry

TOOLS: dict[str, Callable[[CatalogueEntry], bool]] = {
    "scan": lambda e: e.reads_codes,
    "weigh": lambda e: e.weighs,
    "hit": lambda e: e.hits,
    "wipe": lambda e: e.wipes,
}
"""Commands → the test of a tool for them."""


class ToolWords(NamedTuple):
    """The words of a command that takes a tool: past participle, verb, an example of a tool, a refusal of others."""

    done: str
    verb: str
    example: str
    unable: str


_WORDS = {
    "hit": ToolWords("hit", "hit", "hammer", "has no head to hit with"),
    "wipe": ToolWords("wiped", "wipe", "sponge", "is nothing to wipe with"),
}
"""Commands → their words."""


@dataclass(frozen=True)
class Tools:
    """The tools of a scene.

    Args:
        things: catalogue's entries by object id.
        meanings: of the sentence's nouns.
    """

    things: Things
    meanings: Meanings

    def of(self, command: Command, held: Sequence[str]) -> str:
        """The tool that a command uses: the one that it names, or that was picked up for it.

        Args:
            command: to hit or to wipe.
            held: things that were picked up before.

        Raises:
            Doubt: it is not one tool, or it is no tool for that; or a part of a thing is hit or wiped.
        """
        words = _WORDS[command.verb]
        if part := next((noun for noun in command.things if noun.of_part(self.things.values())), None):
            raise Doubt(part.text, f"no goal says that a part of a thing is {words.done}; name the thing")
        tools = held if command.place is None else self.meanings.objects(command.place)
        if len(tools) != 1:
            raise Doubt(command.words, f"say what to {words.verb} it with, one tool such as the {words.example}")
        if not TOOLS[command.verb](self.things[tools[0]]):
            raise Doubt(command.words, f"{tools[0]} {words.unable}")
        return tools[0]

    def require_one(self, command: Command, named: Noun, subjects: Collection[str], held: Collection[str]) -> None:
        """Refuse a tool that is one of several, unless any of these may be taken, and things that are held up.

        Args:
            command: to hit or to wipe.
            named: what it names as its tool.
            subjects: ids of the things that are hit or wiped; these are no tools.
            held: ids of things that are held up.

        Raises:
            Doubt: names them.
        """
        able, done = TOOLS[command.verb], _WORDS[command.verb].done
        if up := next((name for name in subjects if name in held), None):
            raise Doubt(command.words, f"{up} is held up, and only what stands there is {done}")
        tools = {name: entry for name, entry in self.things.items() if able(entry) and name not in subjects}
        if len(tools) > 1 and (named.definite or tools.keys() != named.named(tools, short=True).keys()):
            raise Doubt(named.text, f"no goal says which of {listed(tools)} it is {done} with")
