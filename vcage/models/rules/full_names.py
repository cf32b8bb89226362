"""Names in full, where only one kind of that name can be meant: "the block" that takes a peg, or two hands, and "the
microwave" that things go in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from vcage.models.rules.commands import Command, nouns_of
from vcage.models.rules.nouns import Noun
from vcage.objects.names import SYNONYM, Name, Names, names_of
from vcage.schema.asset import CatalogueEntry

_BLOCK = ("block",)


def with_full_names(commands: Sequence[Command], kinds: Mapping[str, CatalogueEntry]) -> list[Command]:
    """The commands with "the block" as the peg block that pegs are inserted in, or the long block that changes hands,
    if no other block is named; and with "the microwave" that something is put in or taken out of as the one open kind.

    Args:
        commands: of a sentence.
        kinds: the catalogue's, by name.
    """
    full = {**_full_block(commands, kinds), **_full_receptacles(commands, kinds)}
    return [_naming(command, full) for command in commands] if full else [*commands]


def _full_block(commands: Sequence[Command], kinds: Mapping[str, CatalogueEntry]) -> dict[Name, Name]:
    blocks = {replace(n, text="", at=0, quantifier="") for n in nouns_of(commands) if n.words[-1:] == _BLOCK}
    plain = {replace(n, colour=None) for n in blocks}
    one = len(plain) == 1 and len(blocks - plain) < 2  # after "the red block", "the block" is that one
    if one and any(map(_hands_one_block, commands)):
        return {_BLOCK: ("long", *_BLOCK)}
    if len(blocks) == 1 and any(puts_pegs_in_block(c, kinds) for c in commands):
        return {_BLOCK: ("peg", *_BLOCK)}
    return {}


def _full_receptacles(commands: Sequence[Command], kinds: Mapping[str, CatalogueEntry]) -> dict[Name, Name]:
    """The full name of each place that something is put in or taken out of, where nothing goes in the kinds that have
    its name, but in one other that is called so, too."""
    put = [c.place for c in commands if c.verb == "put" and c.how == "in"]
    taken = [c.source for c in commands if c.source_how == "in"]
    full = {}
    for noun in {*put, *taken}:
        if noun is None or not noun.words or noun.of_part(kinds.values()):
            continue
        called = [kind for kind in kinds.values() if noun.fit(kind)[0] >= SYNONYM]
        open_kinds = [kind for kind in called if any(point.holds == "in" for point in kind.functional_points)]
        if len(open_kinds) == 1 and open_kinds[0].name not in noun.named(kinds):
            full[noun.name] = _in_full(noun.words, names_of(open_kinds[0]))
    return full


def _in_full(words: Name, names: Names) -> Name:
    """The words for a kind with its full name for the short one: those that describe its look stay."""
    short = max((name for name in names.all if set(name) <= set(words)), key=len, default=words)
    return (*(word for word in words if word not in short), *names.words)


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


def _naming(command: Command, full: Mapping[Name, Name]) -> Command:
    """A command with full names for short ones, wherever one thing is named so."""
    place, source = (None if noun is None else _named(noun, full) for noun in (command.place, command.source))
    things = tuple(_named(noun, full) for noun in command.things)
    return replace(command, things=things, place=place, source=source)


def _named(noun: Noun, full: Mapping[Name, Name]) -> Noun:
    relations = tuple((how, _named(other, full)) for how, other in noun.relations)
    return replace(noun, relations=relations, words=noun.words if noun.several else full.get(noun.name, noun.words))
