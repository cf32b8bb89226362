"""Things that a sentence asks to slide over or into something: hung on pegs by their handles, inserted in holes."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from vcage.base.text import listed
from vcage.models.rules.commands import Command
from vcage.models.rules.full_names import puts_pegs_in_block
from vcage.models.rules.meanings import Meanings, Things
from vcage.models.rules.nouns import Conflict, Doubt, Noun
from vcage.schema.asset import CatalogueEntry

INSERTS = re.compile(r"\b(insert|plug)\b", re.IGNORECASE)
"""Verbs of what is slid into something."""


class SlidWords(NamedTuple):
    """The words of a goal for which a thing is slid over or into something.

    Args:
        ends: an infinitive that says how things end.
        spot, purpose: what each thing takes one of, and what for.
        spots: their number of a kind.
        able: the test of a thing.
        unable: a refusal of others.
        way: what to say where there are too few spots.
    """

    ends: str
    spot: str
    purpose: str
    spots: Callable[[CatalogueEntry], int]
    able: Callable[[CatalogueEntry], bool]
    unable: str
    way: str = ""


_ONE_EACH = "the red peg into the red peg block and the blue one into the blue peg block"
_WORDS = {
    "hung_on": SlidWords(
        ends="hang",
        spot="peg",
        purpose="to hang something on",
        spots=lambda e: e.pegs,
        able=lambda e: e.hangs,
        unable="has no closed handle to hang it by",
    ),
    "inserted_in": SlidWords(
        ends="be inserted",
        spot="hole",
        purpose="to insert something in",
        spots=lambda e: e.holes,
        able=lambda e: e.goes_into_holes,
        unable="is no peg that goes into a hole",
        way=f"; name a peg block for each, as in: {_ONE_EACH}",
    ),
}
"""Goals → their words."""


@dataclass(frozen=True)
class Slid:
    """The pegs and holes of a scene.

    Args:
        things: catalogue's entries by object id.
        meanings: of the sentence's nouns.
    """

    things: Things
    meanings: Meanings

    def rack(self, command: Command) -> str:
        """The place on which a command hangs things: the one that it names, or else the only one with pegs.

        Raises:
            Doubt: there is none, or more than one.
        """
        if command.how not in ("on", ""):
            raise Doubt(command.words, "things are hung on something, not beside, in or to it")
        with_pegs = [name for name, entry in self.things.items() if entry.pegs]
        racks = with_pegs if command.place is None else self.meanings.objects(command.place)
        if len(racks) != 1:
            example = listed(racks) or "a mug rack"
            raise Doubt(command.words, f"say on what it is hung, one thing with pegs such as {example}")
        return racks[0]

    def block(self, command: Command) -> str | None:
        """The place in whose hole a command puts things; None where the place that it names has none.

        Raises:
            Doubt: it names several.
        """
        assert command.place is not None
        kinds = command.place.named(self.things, short=True) if command.how == "in" else ()
        if not any(self.things[name].holes for name in kinds):
            self._require_other_place(command, command.place)
            return None
        self._require_own(command, command.place)
        places = self.meanings.objects(command.place)
        if len(places) > 1:
            raise Doubt(command.place.text, f"say which peg goes in which of them, as in: {_ONE_EACH}")
        return places[0]

    def only_block(self, command: Command) -> str:
        """The only thing with holes.

        Raises:
            Doubt: there is none, or more than one.
        """
        blocks = [name for name, entry in self.things.items() if entry.holes]
        if len(blocks) != 1:
            raise Doubt(command.words, f"say in what it is inserted, as in: into {(blocks or ['the peg block'])[0]}")
        return blocks[0]

    def _require_own(self, command: Command, place: Noun) -> None:
        """Refuse the hole of something that is named elsewhere in the sentence, and has none.

        Raises:
            Conflict: says what to name.
        """
        others = [noun for noun in self.meanings.nouns if noun != place and noun not in command.things]
        owner = place.words[: place.words.index("of")] if "of" in place.words else ()
        if any(noun.words == owner for noun in others) or (others and place.text.lower().startswith("its ")):
            raise Conflict(place.text, "say whose hole it is by its full name, as in: the hole of the peg block")

    def _require_other_place(self, command: Command, place: Noun) -> None:
        """Refuse to put pegs in a block without a hole.

        Raises:
            Doubt: says what to name.
        """
        if puts_pegs_in_block(command, self.things):
            raise Doubt(place.text, "it has no hole; say it by its full name, as in: in the peg block")

    def require(self, command: Command, relation: str, names: Sequence[str], place: str) -> None:
        """Refuse a place without a spot for each of some things, and things that do not go there.

        Args:
            command: that brings them there.
            relation: of the goal.
            names: of the things.
            place: object id.

        Raises:
            Doubt: says which.
        """
        words = _WORDS[relation]
        if command.verb == "insert" and command.place is None and not INSERTS.search(command.words):
            for name in (name for name in names if not words.able(self.things[name])):
                why = "a drawer is pushed in, which closes it, a button, which presses it, and a peg"
                raise Doubt(command.words, f"no goal pushes in {name}: {why}")
        spots = words.spots(self.things[place])
        if len(names) > spots:
            named = f"{place} has {spots or 'no'} {words.spot}{'s' * (spots > 1)} {words.purpose}"
            more = f", and {len(names)} things are to {words.ends} there{words.way}" if spots else ""
            raise Doubt(command.words, named + more)
        for name in names:
            if not words.able(self.things[name]):
                raise Doubt(command.words, f"{name} {words.unable}")
