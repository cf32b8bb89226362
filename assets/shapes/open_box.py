"""Boxes without a lid, with their convex pieces and words printed on the front."""

from __future__ import annotations

from collections.abc import Sequence

from vcage.objects.modelling import pieces, prints, solids
from vcage.objects.modelling.mappings import from_front
from vcage.objects.modelling.parts import Part, paint


def open_shell(inner: Sequence[float], wall: float, floor: float, height: float, rounding: float = 0.0) -> solids.Solid:
    """A box without a lid; ``rounding`` is the radius of its upright edges.

    Args:
        inner: (2,) free size inside, metres.
        wall, floor: thicknesses.
        height: of the rim.
        rounding: radius of the upright outer edges.
    """
    outer = (inner[0] + 2 * wall, inner[1] + 2 * wall)
    if rounding == 0:
        return solids.cut(solids.box((*outer, height)), solids.box((*inner, 1.0), (0, 0, floor)))
    hollow = solids.prism(solids.rounded_rectangle(inner, max(rounding - wall, 0.002)), 1.0, floor)
    return solids.cut(solids.prism(solids.rounded_rectangle(outer, rounding), height), hollow)


def front_sign(
    words: str, width: float, height: float, bottom: tuple[float, float, float], ground: tuple, ink: tuple
) -> Part:
    """Words printed on the front: a plate of half a millimetre.

    Args:
        words: what is printed.
        width, height: of the plate, metres.
        bottom: (3,) the middle of its lower edge.
        ground, ink: colours.
    """
    picture = prints.canvas(round(128 * width / height), 128, ground)
    picture = prints.text(picture, words, (0.5, 0.5), 0.5, ink)
    return paint(solids.box((width, 0.0008, height), bottom), picture, from_front(), roughness=0.9)


def open_box(
    inner: Sequence[float], wall: float, floor: float, height: float, rounding: float
) -> tuple[solids.Solid, list[pieces.Piece]]:
    """A box without a lid around the origin, and its five pieces.

    Args:
        inner: (2,) free size inside, metres.
        wall, floor: thicknesses.
        height: of the rim.
        rounding: radius of the upright outer edges; the pieces have square ones.
    """
    return open_shell(inner, wall, floor, height, rounding), pieces.tray(inner, wall, floor, height)
