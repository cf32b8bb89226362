"""The nouns that pronouns and "the red one" refer to in the commands of a sentence."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import replace

from vcage.models.rules.commands import USING, Command
from vcage.models.rules.nouns import Noun


def resolved(commands: tuple[Command, ...], done: tuple[Command, ...] = ()) -> Iterator[tuple[Command, ...]]:
    """Every way in which pronouns and "the red one" can refer to earlier nouns.

    Args:
        commands: the remaining ones.
        done: the resolved commands before them.
    """
    if not commands:
        yield done
        return
    command, *later = commands
    things = (_things_for(noun, done, command) for noun in command.things)
    for chosen, place in itertools.product(itertools.product(*things), _places_for(command, done)):
        named = tuple(noun for nouns in chosen for noun in nouns)
        found = replace(command, things=named, place=place, may_be=_tool_or_thing(command, done))
        yield from resolved(tuple(later), (*done, *(found.pushed_in() if found.verb == "push_in" else [found])))


def _tool_or_thing(command: Command, done: tuple[Command, ...]) -> tuple[str, ...]:
    """The things that a pronoun may mean after a command with a tool, as typed; empty where one is meant."""
    pronouns = [noun for noun in command.things if noun.pronoun] if done and done[-1].verb in USING else []
    found = [nouns[0].text for noun in pronouns for nouns in _referents(noun, done, command.verb)]
    return tuple(found) if len(found) > 1 else ()


def _things_for(noun: Noun, done: tuple[Command, ...], command: Command) -> list[tuple[Noun, ...]]:
    """Referents of a noun for things: itself, those of a pronoun, or of the kind meant by "the red one"."""
    if noun.pronoun:
        return [tuple(o.without(noun.but) for o in nouns) for nouns in _referents(noun, done, command.verb)]
    return _of_kind_meant(noun, _heads((*done, command))) if noun.headless else [(noun,)]


def _of_kind_meant(noun: Noun, heads: Sequence[Noun]) -> list[tuple[Noun, ...]]:
    """Referents of "the red one" or "the small one" among nouns that name a kind."""
    if not heads:
        return [(noun,)]
    if noun.size and (alike := _sized_like(heads)):
        return [(one,) for one in _of_size(noun.size, alike) or [noun]]
    after = heads[-1] if heads[-1].at > noun.at else None
    return [] if after is not None and _is_one_thing_with(after, noun) else [(noun.like(heads[-1]),)]


_BY_SIZE = ("small", "medium", "large")


def _sized_like(heads: Sequence[Noun]) -> list[Noun]:
    """The nouns that "the small one" is one of: the last if it means several, or those that differ in size alone."""
    alike = {noun.size: noun for noun in heads if noun.words == heads[-1].words}
    return list(alike.values()) if len(alike) > 1 or heads[-1].several else []


def _of_size(size: str, alike: Sequence[Noun]) -> list[Noun]:
    """The smallest, middle or largest of some nouns, if it is plain; one that says no size is of medium size."""
    if size not in _BY_SIZE or any(noun.several or (noun.size or "medium") not in _BY_SIZE for noun in alike):
        return []
    order = sorted(alike, key=lambda noun: _BY_SIZE.index(noun.size or "medium"))
    return [order[0] if size == "small" else order[-1]] if size != "medium" else order[1:-1]


def _is_one_thing_with(after: Noun, noun: Noun) -> bool:
    """True where a colour before a name is no thing of its own.

    In "the red and blue mugs" the number of red ones is open, and "the red and blue mug" is one.
    """
    return noun.count is None and not noun.several if after.several else not after.quantifier


def _places_for(command: Command, done: tuple[Command, ...]) -> list[Noun | None]:
    """Referents of a noun for a place: for a pronoun the last one named, for "the blue one" a kind."""
    place = command.place
    if place is None or not (place.pronoun or place.headless):
        return [place]
    if place.pronoun:
        meant = [nouns[0] for nouns in _referents(place, done, command.verb) if len(nouns) == 1] or [place]
        return [noun.owner if command.how == "on" else noun for noun in meant]
    heads = [noun for noun in _places(*done) if not noun.of_table][-1:] + _heads((*done, command))[-1:]
    return [place.like(head) for head in heads] or [place]


def _heads(commands: tuple[Command, ...]) -> list[Noun]:
    return [noun for c in commands for noun in c.things if not noun.headless and not noun.pronoun]


def _places(*commands: Command) -> list[Noun]:
    return [command.place for command in commands if command.place is not None and command.how]


def _referents(pronoun: Noun, done: tuple[Command, ...], verb: str) -> list[tuple[Noun, ...]]:
    """Meanings of a pronoun: "it" is the object of the command before, its place, a tool in hand, or a part to close.

    "Them" are the things of the command before, or, where that is one, of all commands.
    """
    things = done[-1].things if done else ()
    if pronoun.pronoun == "them":
        return _several(things, done)
    nouns = [*things, *_places(*done[-1:])] if len(things) == 1 else []
    if nouns and done[-1].verb in USING:  # the tool is still in the hand
        nouns += [*_things_of(done, "pick", "lift"), *(noun for noun in [done[-1].place] if noun is not None)]
    if verb in ("close", "push_in"):
        closed = _things_of(done, "close")
        nouns += [noun for noun in _things_of(done, "open") if noun not in closed]
    return [(noun,) for noun in dict.fromkeys(nouns) if not noun.several]


def _several(things: tuple[Noun, ...], done: tuple[Command, ...]) -> list[tuple[Noun, ...]]:
    if done and done[-1].verb == "tower" and done[-1].place is not None:
        return [(done[-1].place,)]  # where the lowest goes, all of the stack goes
    if len(things) == 1 and not things[0].several:
        things = tuple(dict.fromkeys(noun for command in done for noun in command.things))
    return [things] if len(things) > 1 or any(noun.several for noun in things) else []


def _things_of(commands: tuple[Command, ...], *verbs: str) -> list[Noun]:
    return [noun for command in commands if command.verb in verbs for noun in command.things]
