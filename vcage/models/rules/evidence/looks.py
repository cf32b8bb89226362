"""Pixels that have the main colours of an object."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vcage.vision.colour import palette, palette_distance, to_lab
from vcage.vision.protocols import Reference


@dataclass(frozen=True)
class LooksSettings:
    """When a pixel may be an object's.

    Args:
        alike_lab: colour distance to the object's palette below which it may.
        main_share: share of an object's pixels that a colour of its palette needs.
        shade: factors of L, a and b by which a colour is told in the shade.
        opaque: value of alpha, of 255, above which a reference shows the object.
    """

    alike_lab: float = 16.0
    main_share: float = 0.08
    shade: tuple[float, float, float] = (0.75, 0.85, 0.85)
    opaque: int = 200


SETTINGS = LooksSettings()


def looks_like(reference: Reference, lab: np.ndarray) -> np.ndarray:
    """(n,) bool: pixels (n, 3) that have one of a reference's main colours, in light or in shade."""
    if not len(lab):
        return np.zeros(0, bool)
    seen = reference.picture[..., 3] > SETTINGS.opaque
    centres, shares = palette(to_lab(np.ascontiguousarray(reference.picture[..., :3]))[seen])
    centres = centres[shares > SETTINGS.main_share]
    shaded = centres * np.array(SETTINGS.shade)
    return palette_distance(lab, np.concatenate([centres, shaded])) < SETTINGS.alike_lab
