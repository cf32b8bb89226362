"""Names in full, where only one kind of that name can be meant: "the block" that takes a peg, or two hands, and "the
microwave" that things go in."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

from vcage.models.rules.commands import Command, nouns_of
from vcage.models.rules.nouns import Doubt, Noun
from vcage.objects.names import SYNONYM, Name, Names, names_of
from vcage.schema.asset import CatalogueEntry

_BLOCK = ("block",)


def with_full_names(commands: Sequence[Command], kinds: Mapping[str, CatalogueEntry]) -> list[Command]:
    """The commands with "the block" as the peg block that pegs are inserted in, or the long block that changes hands,
    if no other block is named; and with "the microwave" that something is put in or taken out of as the one open kind.

    Args:
        commands: of a sentence.
        kinds: the catalogue's, by name.

    Raises:
        Doubt: of the thing that something is put in a door is named, which it does not have.
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
    """The full name of each thing that something is put in or taken out of, or that has a drawer, where the kinds of
    its name have no such place or part, but one other that is called so, too.

    Raises:
        Doubt: a door of that thing is named as well.
    """
    full = {}
    for noun, suits in _asked_of(commands, kinds):
        called = [kind for kind in kinds.values() if noun.fit(kind)[0] >= SYNONYM]
        suitable = [kind for kind in called if suits(kind)]
        if len(suitable) == 1 and suitable[0].name not in noun.named(kinds):
            full[noun.name] = _in_full(noun.words, names_of(suitable[0]))
    doors = [noun for noun in nouns_of(commands) if noun.part == "door" and _owner(noun) in ((), *full)]
    if full and doors:
        short, name = (" ".join(words) for words in next(iter(full.items())))
        raise Doubt(doors[0].text, f"things go in no {short} with a door; those that they go in have a drawer: {name}")
    return full


def _asked_of(
    commands: Sequence[Command], kinds: Mapping[str, CatalogueEntry]
) -> Iterator[tuple[Noun, Callable[[CatalogueEntry], bool]]]:
    """Nouns whose thing must be open, or have a drawer, and the test of its kind."""
    for noun in _open_things(commands):
        if noun.words and not noun.of_part(kinds.values()):
            yield noun, lambda kind: any(point.holds == "in" for point in kind.functional_points)
    for noun in nouns_of(commands):
        if noun.part == "drawer" and _owner(noun):
            yield replace(noun, words=_owner(noun), position=None), lambda kind: "drawer" in kind.parts


def _open_things(commands: Sequence[Command]) -> list[Noun]:
    """The nouns for what something is put in, taken out of, or said to lie in."""
    put = [c.place for c in commands if c.verb == "put" and c.how == "in"]
    taken = [c.source for c in commands if c.source_how == "in"]
    lain_in = [other for noun in nouns_of(commands) for how, other in noun.relations if how == "in"]
    return [*filter(None, [*put, *taken]), *lain_in]


def _owner(noun: Noun) -> Name:
    """The words for the thing that has the part that a noun names."""
    return tuple(word for word in noun.words[:-1] if word != "of")


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
