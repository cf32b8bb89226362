"""Upright plates: blades, tabs and grips that fingers close on from the left and the right."""

from __future__ import annotations

from numpy.typing import ArrayLike

from vcage.objects.builders.solids import Solid, prism


def upright(profile: ArrayLike, thickness: float) -> Solid:
    """A profile (n, 2) of y and z, counter-clockwise as seen from the right, as a plate around x = 0."""
    plate = prism(profile, thickness, -thickness / 2)
    plate.vertices = plate.vertices[:, [2, 0, 1]]  # a cyclic change of axes keeps it right side out
    return plate
