"""Evidence that an object has left a place, from two pictures of which one shows it there and the other does not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vcage.models.rules.pixels import changed
from vcage.vision.colour import distance, smoothed
from vcage.vision.protocols import View


@dataclass(frozen=True)
class VacatedSettings:
    """When pictures tell.

    Args:
        fewest_px, telling_share: pixels, and share of the outline, that must differ with the object and without.
    """

    fewest_px: int = 25
    telling_share: float = 0.3


SETTINGS = VacatedSettings()


def vacated(there: View, moment: View, gone: View, where: np.ndarray) -> float | None:
    """Share of the part of an outline (H, W) bool that differs with the object and without it that looks as without at
    the moment; None where little of it differs. A hand's shadow changes it too.

    Args:
        there, gone: views with the object and without it.
        moment: the view that is judged.
        where: the object's outline.
    """
    was, seen, then = (smoothed(view.picture) for view in (there, moment, gone))
    telling = where & changed(was, then)
    if telling.sum() < max(SETTINGS.fewest_px, SETTINGS.telling_share * where.sum()):
        return None
    return float((distance(seen, then) < distance(seen, was))[telling].mean())
