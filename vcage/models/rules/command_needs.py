"""Needs of a command: the role and the test of its things, and of the place that they go to."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from vcage.goals.thresholds import THRESHOLDS
from vcage.models.rules.commands import Command
from vcage.models.rules.goals import ACTS
from vcage.models.rules.meanings import BESIDE
from vcage.models.rules.nouns import Noun
from vcage.schema.asset import CatalogueEntry
from vcage.schema.goals import part_that
from vcage.schema.scene import Role

Good = Callable[[CatalogueEntry], bool]


def _stands(entry: CatalogueEntry) -> bool:
    return entry.can_be_carried and entry.tall


UNSAID = {"scan": "barcode scanner", "weigh": "electronic scale", "hang": "mug rack", "insert": "peg block"}
"""Commands → what they take where nothing is named."""
_CONTENTS: Mapping[str, Good] = {
    "scan": lambda e: e.can_be_carried and any(face.kind == "code" for face in e.faces),
    "stand_up": _stands,
    "fallen": _stands,
    "pour": lambda e: e.loose or (e.holds_loose and e.can_be_carried),
    "hang": lambda e: e.hangs,
    "insert": lambda e: e.goes_into_holes,
}
"""Commands → the test that their things must pass; things of other commands must be portable."""
RECEIVERS: Mapping[str, Good] = {
    "pour": lambda e: e.takes_poured(THRESHOLDS.poured_into_m),
    "hang": lambda e: e.pegs > 0,
    "insert": lambda e: e.holes > 0,
}
"""Commands → the test of the place that they name; of any other it has room for the things."""


def role_and_test(command: Command) -> tuple[Role, Good]:
    """The role of the things of a command, and the test that they must pass."""
    if command.verb in ACTS:
        return "receptacle", lambda e: any(part_that(ACTS[command.verb], part) for part in e.moving_parts)
    if good := _CONTENTS.get(command.verb):
        return "content", good
    pushed = command.verb in ("put", "together") and command.how in BESIDE
    return "content", lambda e: (e.can_be_carried or pushed) and not e.loose


def is_side_by_side(command: Command) -> bool:
    """True where several things of a command need room beside each other: one goes into each of several drawers."""
    drawers = command.place is not None and command.place.several
    return command.verb not in ("tower", "pour") and not drawers


def part_of(noun: Noun, place: CatalogueEntry | None) -> CatalogueEntry | None:
    """A place with the room of the meant part only, where a part is meant."""
    if place is None or noun.part is None:
        return place
    points = [point for point in place.functional_points if (point.part or "").startswith(noun.part)]
    rooms = [room for room in place.rooms if room.point in {point.id for point in points}]
    return place.model_copy(update={"functional_points": points, "rooms": rooms}) if points else place
