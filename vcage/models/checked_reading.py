"""A reading beside the instruction and the objects that it is of: what every check of a reading looks at."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property

from vcage.models.asides import AskedPart, asked_part
from vcage.models.directions import plain_sides
from vcage.models.plain_english import in_english
from vcage.objects.mentions import Noun, nouns
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import Goal, Reading, named_by


@dataclass(frozen=True)
class CheckedReading:
    """A reading of an instruction.

    Args:
        instruction: in plain language.
        things: by object id, the catalogue's entries with no other look than the object's.
        reading: of the instruction, by any reader.
        moved: ids of the objects that were chosen to be moved.
    """

    instruction: str
    things: Mapping[str, CatalogueEntry]
    reading: Reading
    moved: Collection[str] = ()

    @cached_property
    def english(self) -> bool:
        """True if the instruction is in English; words of other languages are not checked."""
        return in_english(self.instruction, self.things.values())

    @cached_property
    def task(self) -> AskedPart:
        """The part of the instruction that asks for something."""
        return asked_part(plain_sides(self.instruction), self.things.values())

    @cached_property
    def said(self) -> list[Noun]:
        """The nouns that must be answered."""
        return nouns(self.task.text, self.things.values())

    @cached_property
    def said_or_offered(self) -> list[Noun]:
        """The same with things of which one is to be chosen."""
        return nouns(self.task.open_text, self.things.values())

    @cached_property
    def goals(self) -> list[Goal]:
        """The goals, without steps and words."""
        return [asked.goal for asked in self.reading.goals]

    @cached_property
    def relations(self) -> set[str]:
        """The relations of goals."""
        return {goal.relation for goal in self.goals}

    @cached_property
    def spoken(self) -> set[str]:
        """Ids of the objects of goals and descriptions, of those left alone, and of tools and addressees of goals."""
        named = {*named_by(self.reading.stated), *self.reading.untouched}
        return {*self.reading.untouched} | {
            name for name, entry in self.things.items() if name in named or self.relations & _serves(entry)
        }


def _serves(entry: CatalogueEntry) -> set[str]:
    """Goal words that a thing is the tool for, or the addressee of."""
    return {*entry.tool_for, *(["presented"] if "customer" in entry.words.name else [])}
