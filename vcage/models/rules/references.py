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
    things = (_things_for(noun, done, command) for noun in command.things)
    for *told, place in itertools.product(*things, _places_for(command, done)):
        named = tuple(noun for nouns in told for noun in nouns)
        yield from resolved(tuple(later), (*done, replace(command, things=named, place=place)))


def _things_for(noun: Noun, done: tuple[Command, ...], command: Command) -> list[tuple[Noun, ...]]:
    """Referents of a noun for things: itself, those of a pronoun, or of the kind that "the red one" leans on."""
    if noun.pronoun and done:
        several = [(other,) for other in _single(done, command.verb)] if noun.pronoun == "it" else _several(done)
        return [tuple(other.without(noun.but) for other in nouns) for nouns in several]
    heads = _heads((*done, command))
    if not noun.headless or not heads:
        return [(noun,)]
    # In "the red and blue mugs" nobody can tell how many are red.
    return [] if heads[-1].several and not noun.several and heads[-1].at > noun.at else [(noun.like(heads[-1]),)]


def _places_for(command: Command, done: tuple[Command, ...]) -> list[Noun | None]:
    """Referents of a noun for a place: of a pronoun what was named last, of "the blue one" a kind."""
    place = command.place
    if place is None or not (place.pronoun or place.headless):
        return [place] if place is None or not place.but or not place.definite else []
    if place.pronoun:
        return [*_single(done, command.verb)] or [place]
    heads = [place for c in done for place in _places(c)][-1:] + _heads((*done, command))[-1:]
    return [place.like(head) for head in heads] or [place]


def _heads(commands: tuple[Command, ...]) -> list[Noun]:
    return [noun for c in commands for noun in c.things if not noun.headless and not noun.pronoun]


def _single(done: tuple[Command, ...], verb: str) -> list[Noun]:
    """Referents of "it": the thing of the command before, and its place; for closing also what was opened before."""
    nouns = [noun for c in done[-1:] if len(c.things) == 1 for noun in (*c.things, *_places(c))]
    if verb == "close":
        closed = [noun for c in done if c.verb == "close" for noun in c.things]
        nouns += [noun for c in done if c.verb == "open" for noun in c.things if noun not in closed]
    return [noun for noun in dict.fromkeys(nouns) if not noun.several]


def _places(command: Command) -> list[Noun]:
    return [command.place] if command.place is not None and command.how else []


def _several(done: tuple[Command, ...]) -> list[tuple[Noun, ...]]:
    """Referents of "them": the things of the command before, or, where that is one, of all commands."""
    told = done[-1].things
    if len(told) == 1 and not told[0].several:
        told = tuple(dict.fromkeys(noun for command in done for noun in command.things))
    return [told] if len(told) > 1 or told[0].several else []
