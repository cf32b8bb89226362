"""Short names in their full form, where only that can be meant: "the block" that takes a peg, or two hands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from vcage.models.rules.commands import Command
from vcage.models.rules.nouns import Noun
from vcage.models.rules.too_little import with_relations
from vcage.schema.asset import CatalogueEntry

_BLOCK = ("block",)


def with_full_names(commands: Sequence[Command], kinds: Mapping[str, CatalogueEntry]) -> list[Command]:
    """The commands with "the block" as the peg block that pegs are inserted in, or the long block that changes hands,
    if no other block is named.

    Args:
        commands: of a sentence.
        kinds: the catalogue's, by name.
    """
    nouns = list(with_relations(*(noun for c in commands for noun in (*c.things, c.place, c.source))))
    named = {replace(noun, text="", at=0) for noun in nouns if noun.words[-1:] == _BLOCK}
    if len(named) != 1:
        return [*commands]
    if any(c.verb == "hand" and any(map(_is_one_block, c.things)) for c in commands):
        return [replace(c, things=tuple(map(_long, c.things))) for c in commands]
    return [_to_peg_block(c) if puts_pegs_in_block(c, kinds) else c for c in commands]


def puts_pegs_in_block(command: Command, kinds: Mapping[str, CatalogueEntry]) -> bool:
    """True where pegs, and nothing else, go in "the block"."""
    place = command.place
    if command.verb != "put" or command.how != "in" or place is None or place.name != _BLOCK or place.several:
        return False
    return all(kinds[name].goes_into_holes for noun in command.things for name in noun.named(kinds))


def _to_peg_block(command: Command) -> Command:
    assert command.place is not None
    return replace(command, place=replace(command.place, words=("peg", *_BLOCK)))


def _is_one_block(noun: Noun) -> bool:
    return noun.name == _BLOCK and not noun.several


def _long(noun: Noun) -> Noun:
    """A noun, "the block" as the long one."""
    return replace(noun, words=("long", *_BLOCK)) if _is_one_block(noun) else noun
