"""Short names in their full form, where only that can be meant: "the block" that takes a peg, or two hands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from vcage.models.rules.commands import Command, nouns_of
from vcage.models.rules.nouns import Noun
from vcage.schema.asset import CatalogueEntry

_BLOCK = ("block",)


def with_full_names(commands: Sequence[Command], kinds: Mapping[str, CatalogueEntry]) -> list[Command]:
    """The commands with "the block" as the peg block that pegs are inserted in, or the long block that changes hands,
    if no other block is named.

    Args:
        commands: of a sentence.
        kinds: the catalogue's, by name.
    """
    blocks = {replace(n, text="", at=0, quantifier="") for n in nouns_of(commands) if n.words[-1:] == _BLOCK}
    plain = {replace(n, colour=None) for n in blocks}
    one = len(plain) == 1 and len(blocks - plain) < 2  # after "the red block", "the block" is that one
    if one and any(map(_hands_one_block, commands)):
        return [_naming(c, "long") for c in commands]
    if len(blocks) == 1 and any(puts_pegs_in_block(c, kinds) for c in commands):
        return [_naming(c, "peg") for c in commands]
    return [*commands]


def puts_pegs_in_block(command: Command, kinds: Mapping[str, CatalogueEntry]) -> bool:
    """True where pegs, and nothing else, go in "the block"."""
    place = command.place
    if command.verb != "put" or command.how != "in" or place is None or place.name != _BLOCK or place.several:
        return False
    return all(kinds[name].goes_into_holes for noun in command.things for name in noun.named(kinds))


def _hands_one_block(command: Command) -> bool:
    return command.verb == "hand" and any(map(_is_one_block, command.things))


def _is_one_block(noun: Noun) -> bool:
    return noun.name == _BLOCK and not noun.several


def _naming(command: Command, kind: str) -> Command:
    """A command with "the block" as one of a kind, wherever it is named."""
    place, source = (None if noun is None else _named(noun, kind) for noun in (command.place, command.source))
    things = tuple(_named(noun, kind) for noun in command.things)
    return replace(command, things=things, place=place, source=source)


def _named(noun: Noun, kind: str) -> Noun:
    relations = tuple((how, _named(other, kind)) for how, other in noun.relations)
    return replace(noun, relations=relations, words=(kind, *_BLOCK) if _is_one_block(noun) else noun.words)
