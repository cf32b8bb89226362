"""Order of red and blue in stored pictures, and how it is known.

Nothing in a JPEG says that red and blue are swapped in it, and a blue cube looks like a red one then. So the
user decides (``--colours``), else the file or its pictures, else the layout's own convention. The content
of pictures overrules a convention only where large parts of most of them have the colour of wood. No blue object has
that colour with red and blue swapped. The user is informed.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from vcage.schema.base import Record
from vcage.schema.compression import ColourOrder, ColourSource

AUTO, RGB, BGR = "auto", "rgb", "bgr"
CHOICES = (AUTO, RGB, BGR)
"""Values of ``--colours``; with the last, red and blue changed places."""

MARK = b"\xff\xfe\x00\x0aXPL-RGB1"
"""JPEG comment with which newer files of RoboTwin's layouts say that red and blue are where they belong."""


@dataclass(frozen=True)
class ColourSettings:
    """Thresholds to recognise the order of colours by content; tested on drawn scenes, see ``test_colours.py``."""

    lowest_hue_deg: float = 18.0
    highest_hue_deg: float = 50.0
    """hues of wood, cardboard and straw: from sienna to burlywood"""
    least_saturation: float = 0.25
    """more than a white table has under cool light"""
    least_value: float = 0.25
    least_share: float = 0.3
    """of a picture's pixels that must have such a hue"""
    most_contrary: float = 0.2
    """of that share, what may have such a hue with red and blue changed"""
    least_pictures: int = 5
    """that must say something, and say the same"""
    least_saying: float = 0.5
    """of the pictures looked at, those that say something"""
    least_agreeing: float = 0.9
    """of those, the ones that say the same"""
    pictures_looked_at: int = 5
    """of each camera"""
    mark_within_bytes: int = 4096
    """of a JPEG, from its start, among which a comment is looked for"""


SETTINGS = ColourSettings()


@dataclass(frozen=True)
class Colours:
    """The order of red and blue in stored pictures.

    Args:
        swapped: true if they changed places.
        source: a user's option, a mark of the file or its pictures, the layout's convention, or the content of the
            pictures against that convention.
        sure: false where it may be otherwise.
    """

    swapped: bool
    source: ColourSource
    sure: bool

    @property
    def note(self) -> str | None:
        """A note for the user; None if pictures are surely read as they are stored."""
        read = "red and blue are taken as stored"
        if self.swapped:
            read = "red and blue were swapped in its pictures and are put back"
        if self.sure:
            return read if self.swapped else None
        why = "as its layout has it, but unsure: the pictures do not show it"
        if self.source == "pictures":
            why = "unlike its layout's convention, as the pictures are full of the colours of wood so"
        return f"{read}, {why}; if that is wrong, give --colours {RGB if self.swapped else BGR}"


def settle(convention: bool, votes: Sequence[int]) -> Colours:
    """Return the order of colours where neither a user nor the files state it.

    Args:
        convention: true if the layout's own writer swaps red and blue.
        votes: of some pictures, see :func:`leaning`.
    """
    seen = verdict(votes)
    if seen is None:
        return Colours(convention, "layout", sure=False)
    return Colours(seen, "layout" if seen == convention else "pictures", sure=seen == convention)


def verdict(votes: Sequence[int]) -> bool | None:
    """True if pictures show that red and blue changed places; None if they do not show it clearly.

    Args:
        votes: one of each picture, see :func:`leaning`.
    """
    saying = [vote for vote in votes if vote]
    agreeing = max(saying.count(1), saying.count(-1))
    if len(saying) < SETTINGS.least_saying * len(votes) or agreeing < SETTINGS.least_pictures:
        return None
    return None if agreeing < SETTINGS.least_agreeing * len(saying) else saying.count(1) == agreeing


def leaning(picture: NDArray[np.uint8]) -> int:
    """Return 1 if a (H, W, 3) uint8 picture looks like a room with red and blue changed, -1 if as it is, else 0."""
    hsv = cv2.cvtColor(np.ascontiguousarray(picture, np.float32) / 255, cv2.COLOR_RGB2HSV)
    hue, saturation, value = hsv[..., 0], hsv[..., 1], hsv[..., 2]
    coloured = (saturation >= SETTINGS.least_saturation) & (value >= SETTINGS.least_value)
    as_it_is, changed = (  # red and blue change places where a hue becomes 240° less it
        float((coloured & (one >= SETTINGS.lowest_hue_deg) & (one <= SETTINGS.highest_hue_deg)).mean())
        for one in (hue, 240 - hue)
    )
    larger, smaller = max(as_it_is, changed), min(as_it_is, changed)
    if larger < SETTINGS.least_share or smaller > SETTINGS.most_contrary * larger:
        return 0
    return 1 if changed > as_it_is else -1


def is_marked(data: bytes) -> bool:
    """True for a JPEG file that states that red and blue are where they belong."""
    return MARK in data[: SETTINGS.mark_within_bytes]


def colour_orders(found: Iterable[Colours | None]) -> list[ColourOrder]:
    """Return how the colours of recordings were understood, with numbers of recordings; None says nothing."""
    counts = Counter(one for one in found if one is not None)
    return [
        ColourOrder(stored=BGR if one.swapped else RGB, source=one.source, sure=one.sure, recordings=count)
        for one, count in counts.items()
    ]


def as_json(records: Sequence[Record]) -> list[dict[str, Any]]:
    """Return records for a summary."""
    return [record.model_dump() for record in records]
