"""Chooses and orders the feasible sub-tasks that together fulfil an instruction."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace

from vcage.models.rules.catalogue_match import Occasion, Places, scene_tags, things_meant, variants_of
from vcage.models.rules.instruction import Request, parse_instruction
from vcage.models.rules.phrases import Phrase
from vcage.schema.asset import CatalogueEntry
from vcage.schema.subtasks import ChainOption

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class _Move:
    """Things of the instruction, and the clause that says where they end up."""

    phrase: Phrase
    request: Request


def compose_chain(instruction: str, options: Sequence[ChainOption]) -> list[str]:
    """Ids of the options that fulfil every phrase of the instruction, in its order; empty when one stays open.

    A phrase means the same kinds of things here as when they were selected, out of those that the options move.
    All things of a plural without a number go to one and the same receptacle: the one that the most of them fit.
    A chain moves each thing once, so what the instruction moves twice goes to its last place at once.
    """
    moves = _moves(parse_instruction(instruction))
    chooser = _Chooser(instruction, moves, options)
    chosen: dict[int, list[ChainOption]] = {}
    for index in sorted(range(len(moves)), key=lambda i: chooser.generality(moves[i])):
        chosen[index] = chooser.take(moves[index])
        if len(chosen[index]) < (moves[index].phrase.count or 1):
            return []
    return [option.id for index in sorted(chosen) for option in chosen[index]]


class _Chooser:
    """Takes options for one phrase after another; an object that is taken once is gone."""

    def __init__(self, instruction: str, moves: Sequence[_Move], options: Sequence[ChainOption]):
        self._options = options
        self._things = list({o.object: o.object_kind for o in options}.values())
        self._places = Places(list({o.receptacle: o.receptacle_kind for o in options}.values()))
        self._occasion = Occasion(instruction, scene_tags((move.phrase for move in moves), self._things))
        self._used: set[str] = set()

    def generality(self, move: _Move) -> tuple[bool, int, bool]:
        """Larger for phrases that more things answer: 'the tomato' is taken before 'the products'."""
        return move.phrase.count is None, len(self._kinds(move)), move.phrase.colour is None

    def take(self, move: _Move) -> list[ChainOption]:
        """One option for each thing that the phrase means, as many as it asks for if there are so many."""
        kinds = self._kinds(move)
        fitting = [
            o
            for o in self._options
            if o.object not in self._used and _is_one(o.object_kind, kinds, move.phrase) and self._ends_there(o, move)
        ]
        taken = _one_receptacle(fitting)[: move.phrase.count]
        self._used |= {option.object for option in taken}
        return taken

    def _kinds(self, move: _Move) -> set[str]:
        """Names of the kinds that the phrase means; the place's own only when no other answers it."""
        place = self._places.of(move.request, self._things)
        taken = [] if place is None else [place.name]
        found = things_meant(move.phrase, self._things, self._occasion, taken)
        return {kind.name for kind in found or things_meant(move.phrase, self._things, self._occasion)}

    def _ends_there(self, option: ChainOption, move: _Move) -> bool:
        if move.request.receptacle is None:
            return True
        place = self._places.of(move.request, self._things)
        return place is not None and _is_one(option.receptacle_kind, {place.name}, move.request.receptacle)


def _is_one(kind: CatalogueEntry, names: set[str], phrase: Phrase) -> bool:
    """Whether a thing is of one of these kinds and has the colour that is asked for."""
    return kind.name in names and bool(variants_of(kind, phrase))


def _moves(requests: Sequence[Request]) -> list[_Move]:
    """Every phrase with the clause that names its last place."""
    moves: list[_Move] = []
    for request in requests:
        moves = [_moved_on(move, request) for move in moves]
        moves += [_Move(phrase, request) for phrase in request.contents]
    return moves


def _moved_on(move: _Move, request: Request) -> _Move:
    """The move after a later clause, which may take its things on to another place."""
    if move.phrase not in request.again or request.receptacle is None:
        return move
    before = move.request.receptacle
    if before is not None and before != request.receptacle:
        logger.warning(
            "a chain moves each thing once: %r goes to %r at once, not by way of %r",
            move.phrase.text,
            request.receptacle.text,
            before.text,
        )
    return replace(move, request=request)


def _one_receptacle(options: Sequence[ChainOption]) -> list[ChainOption]:
    """The options of the receptacle that holds the most objects; one option for each object."""
    groups: dict[str, dict[str, ChainOption]] = {}
    for option in options:
        groups.setdefault(option.receptacle, {}).setdefault(option.object, option)
    return list(max(groups.values(), key=len).values()) if groups else []
