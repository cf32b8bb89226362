"""What an instruction asks for and no selection can give: things that the catalogue has not, and too many of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from vcage.base.commands import vcage_command
from vcage.base.errors import InfeasibleScene, NoAssetFits
from vcage.base.words import tokens
from vcage.models.rules.catalogue_match import MIN_SCORE, candidates, places, variants_of
from vcage.models.rules.instruction import Request
from vcage.models.rules.phrases import Phrase
from vcage.models.rules.wishes import require_tellable
from vcage.models.search import Search
from vcage.schema.asset import CatalogueEntry
from vcage.schema.plan import TABLE

MOST_OBJECTS = 40
"""Things that one phrase may ask for; no table holds more."""

SUGGESTIONS = 3
"""Names that a complaint suggests for a phrase that nothing answers."""


def require_answers(
    instruction: str, requests: Sequence[Request], catalogue: Sequence[CatalogueEntry], search: Callable[[], Search]
) -> None:
    """Check that something of the catalogue answers every phrase, in the colour that it asks for.

    Args:
        requests: what the instruction asks for.
        search: makes the search by meaning that suggests names for a phrase that nothing answers.

    Raises:
        NoAssetFits: the instruction names nothing to move, or nothing answers some phrases; names these.
        UnreadInstruction: nothing answers some phrases, and it holds a request of :mod:`~vcage.models.rules.wishes`.
    """
    missing = []
    for request in requests:
        named = [(p, candidates(p, catalogue)) for p in (*request.things, *request.tools)]
        if request.place is not None and request.place.lemmas != (TABLE,):
            named.append((request.place, places(request.place, catalogue)))
        missing += [p for p, found in named if not any(variants_of(c.entry, p) for c in found)]
    if missing:
        require_tellable(instruction)
        raise _no_asset(instruction, missing, catalogue, search())


def require_counts(instruction: str, requests: Sequence[Request]) -> None:
    """Check that of every thing as many are asked for as a table may hold.

    Raises:
        InfeasibleScene: the instruction asks for none of a thing, or for more than :data:`MOST_OBJECTS`.
    """
    for phrase in (phrase for request in requests for phrase in request.things):
        if phrase.count is not None and not 0 < phrase.count <= MOST_OBJECTS:
            raise InfeasibleScene(
                f"the instruction asks for {phrase.count} × {phrase.as_typed(instruction)!r}",
                hint=f"ask for 1 to {MOST_OBJECTS} of them",
            )


def _no_asset(
    instruction: str, phrases: Sequence[Phrase], catalogue: Sequence[CatalogueEntry], search: Search
) -> NoAssetFits:
    near = {
        p.as_typed(instruction): [entry.words.name for entry, _ in search.search(p.text, catalogue, SUGGESTIONS)]
        for p in phrases
    }
    listed = " and ".join(map(repr, near))
    nearest = "; ".join(f"{text!r}: {', '.join(found)}" for text, found in near.items())
    colours = [
        f"{c.entry.words.name} comes in {', '.join(v.colour for v in c.entry.variants)}"
        for p in phrases
        for c in candidates(p, catalogue, MIN_SCORE)[:1]
        if not variants_of(c.entry, p)
    ]
    return NoAssetFits(
        f"no asset of the catalogue matches {listed}",
        hint="; ".join(colours) or f"nearest in meaning: {nearest}; see all: {vcage_command('assets', 'list')}",
        details={"unmatched": list(near), "nearest": near, "words": tokens(instruction)},
    )
