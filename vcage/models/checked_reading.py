"""A reading beside the instruction and the objects that it is of: the record that every check looks at."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property

from vcage.base.words import COLOURS, DETERMINERS, FUNCTION_WORDS, NUMBERS, PARTS, VERBS, lemma, tokens
from vcage.models.asides import AskedPart, asked_part
from vcage.objects.mentions import Noun, nouns
from vcage.objects.names import texts_of
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import Goal, Reading, named_by


@dataclass(frozen=True)
class Instructed:
    """An instruction and its objects.

    Args:
        instruction: in plain language.
        things: the catalogue's entries by object id, with no other look than the object's.
        lying: object id → id of what it lies in or on at the start.
        moved: ids of the objects that were chosen to be moved, each of which is in a goal.
    """

    instruction: str
    things: Mapping[str, CatalogueEntry]
    lying: Mapping[str, str] = field(default_factory=dict)
    moved: Collection[str] = ()

    @property
    def phrases(self) -> dict[str, str]:
        """Name each object: colour and name, with a number where that is not unique."""
        found: dict[str, str] = {}
        for name, entry in self.things.items():
            colour = entry.variants[0].colour
            phrase = entry.words.name if colour in entry.words.name else f"{colour} {entry.words.name}"
            alike = sum(other.partition(" (")[0] == phrase for other in found.values())
            found[name] = f"{phrase} ({name})" if alike else phrase
        return found


@dataclass(frozen=True)
class CheckedReading(Instructed):
    """A reading of an instruction.

    Args:
        reading: of the instruction, by any reader.
    """

    reading: Reading = field(kw_only=True)

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
        """The same with the alternatives."""
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


_OWNED = re.compile(
    r"\b(the|my|a) ((?:\w+ ){0,2}\w+)(?:'s|s') (left|right)\b(?: hand)?(?: side)?(?! (?:arm|hand|gripper)\b)"
)
"""A side of a thing: "the plate's left"."""
_LETTER = re.compile(r"[^\W\d_]")


def in_english(
    instruction: str, entries: Iterable[CatalogueEntry], ascii_share: float = 0.9, known_share: float = 0.5
) -> bool:
    """Check if an instruction is in English; of another language no words are checked.

    Args:
        instruction: in plain language.
        entries: kinds whose names count as known words.
        ascii_share: least share of its letters that are ASCII.
        known_share: least share of its words that are known.
    """
    letters = _LETTER.findall(instruction)
    if sum(letter.isascii() for letter in letters) < len(letters) * ascii_share:
        return False
    named = {word for entry in entries for text in texts_of(entry) for word in tokens(text)}
    known = FUNCTION_WORDS | VERBS | COLOURS | DETERMINERS | NUMBERS.keys() | PARTS | named | {*map(lemma, named)}
    said = tokens(instruction)
    return sum(word in known or lemma(word) in known for word in said) >= len(said) * known_share


def plain_sides(text: str) -> str:
    """A text in which "the plate's left" is "the left of the plate"."""
    return _OWNED.sub(r"\1 \3 of \1 \2", text)
