"""Resolve pronouns and "the red one" in every way that the sentence allows."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import replace

from vcage.models.rules.nouns import Noun
from vcage.models.rules.sentence import Command


def resolved(commands: tuple[Command, ...], done: tuple[Command, ...] = ()) -> Iterator[tuple[Command, ...]]:
    """Every way in which pronouns and "the red one" can stand for what was named before.

    Args:
        commands: those that are left.
        done: those before them, resolved.
    """
    if not commands:
        yield done
        return
    command, *later = commands
    for choice in itertools.product(*(_thing_for(noun, done, command) for noun in command.things)):
        told = replace(command, things=tuple(noun for nouns in choice for noun in nouns))
        for place in _place_for(told, done):
            yield from resolved(tuple(later), (*done, replace(told, place=place)))


def _thing_for(noun: Noun, done: tuple[Command, ...], command: Command) -> list[tuple[Noun, ...]]:
    """Referents of a noun for things: itself, those of a pronoun, or the noun that "the red one" leans on."""
    if noun.pronoun and done:
        return [(other,) for other in _single(done, command.verb)] if noun.pronoun == "it" else _several(noun, done)
    heads = _heads((*done, command))
    if not noun.headless or not heads:
        return [(noun,)]
    # In "the red and blue mugs" nobody can tell how many are red.
    return [] if heads[-1].several and not noun.several and heads[-1].at > noun.at else [(noun.like(heads[-1]),)]


def _heads(commands: tuple[Command, ...]) -> list[Noun]:
    return [noun for c in commands for noun in c.things if not noun.headless and not noun.pronoun]


def _single(done: tuple[Command, ...], verb: str) -> list[Noun]:
    """Referents of "it": nouns of the command before; for closing also what was opened longer ago."""
    opened = [noun for c in done if c.verb == "open" == verb.replace("close", "open") for noun in c.things]
    closed = [noun for c in done if c.verb == "close" for noun in c.things]
    nouns = [*done[-1].things, *_places(done[-1]), *(noun for noun in opened if noun not in closed)]
    return [noun for noun in dict.fromkeys(nouns) if not noun.several] if len(done[-1].things) == 1 else []


def _places(command: Command) -> list[Noun]:
    return [command.place] if command.place is not None and command.how else []


def _several(pronoun: Noun, done: tuple[Command, ...]) -> list[tuple[Noun, ...]]:
    """Referents of "them" or "both": the things of the command before, or, where that is one, of all commands."""
    told = done[-1].things
    if len(told) == 1 and not told[0].several:
        told = tuple(dict.fromkeys(noun for c in done for noun in c.things))
        told = told if len(told) > 1 else (*told, *_places(done[-1]))
    elif len(told) == 1 and pronoun.pronoun == "both":
        told = (replace(told[0], count=2, quantifier="the"),)
    return [told] if pronoun.pronoun == "them" or len(told) <= 2 else []


def _place_for(command: Command, done: tuple[Command, ...]) -> list[Noun | None]:
    """Referents of a noun for a place: of a pronoun a thing or the place before, of "the blue one" a kind."""
    place = command.place
    if place is None:
        return [None]
    if not (place.pronoun or place.headless):
        of_things = command.things[-1].several and not place.several  # "all pens into the box except the red one"
        return [replace(place, but=tuple(noun for noun in place.but if not (noun.headless and of_things)))]
    found = [noun for c in done[-1:] for noun in (*c.things, *_places(c)) if not noun.several]
    if place.headless:
        former = [noun for c in done for noun in _places(c)]
        found = [place.like(head) for head in (*former[-1:], *_heads((*done, command))[-1:])]
    return [*dict.fromkeys(found)] or [place]
