"""An open carton with two rows of three cells, of moulded paper."""

from __future__ import annotations

import itertools

import numpy as np

from vcage.objects.modelling import pieces, prints, solids
from vcage.objects.modelling.mappings import from_front, tiled
from vcage.objects.modelling.noise import Colour, clouds, noise, over, shaded
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

CELL = np.array([0.055, 0.05])
"""Distances of an egg carton's cells along x and y, metres."""

ROWS = np.array([3, 2])
"""Cells of a carton along x and y."""

FLOOR, RIDGE, RIM = 0.003, 0.027, 0.033
"""Heights of a carton's floor, of the ridges between cells, and of its rim, metres."""

ROUNDING = (0.013, 0.019)
"""Radii of a cell's upright edges at its floor and at its top, metres."""

FOOT, CREST = 0.009, 0.0028
"""Half widths of a ridge at the floor and at its top, metres."""

POST = [(0.0095, FLOOR), (0.0092, 0.024), (0.0072, 0.04), (0.0055, 0.0445), (0.003, 0.046)]
"""Profile (radius, z) of the blunt cone where four cells meet, metres."""

POSTS = (-CELL[0] / 2, CELL[0] / 2)
"""Where the cones stand along x, metres."""

COLOURS = {"grey": (158, 158, 150), "blue": (122, 152, 176), "brown": (176, 146, 108)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("egg_carton", variant)
    colour = COLOURS[variant]
    inner = CELL * ROWS
    block = _frustum(inner / 2 + 0.001, inner / 2 + 0.0045, 0.0, RIM - 0.001)
    lip = _frustum(inner / 2 + 0.006, inner / 2 + 0.0065, RIM - 0.003, RIM)
    centres = list(itertools.product(*(_places(i) for i in range(2))))
    cells = [_cell(centre) for centre in centres]
    room = _frustum(inner / 2 - CREST, inner / 2 - CREST, RIDGE, 2 * RIM)
    cone = solids.revolved([(0, FLOOR), *POST, (0, POST[-1][1])], 20)
    posts = [solids.moved(cone, (x, 0, 0)) for x in POSTS]
    body = solids.union(solids.cut(solids.union(block, lip), room, *cells), *posts)
    paper = _pulp(rng, colour)
    label = prints.canvas(480, 96, (250, 244, 220))
    label = prints.text(label, "6 FARM EGGS", (0.5, 0.5), 0.66, (150, 74, 30))
    front = solids.moved(solids.box((0.11, 0.0006, 0.022)), turn=float(np.degrees(0.0035 / RIM)), axis=(1, 0, 0))
    front = solids.moved(front, (0, -inner[1] / 2 - 0.0014, 0.004))
    parts = [
        paint(body, paper, tiled(0.09), roughness=0.95, crease=35),
        paint(front, label, from_front(), roughness=0.8),
    ]
    return BuiltObject(parts, _carton_pieces(inner), mass=0.06, friction=0.8)


def _places(axis: int) -> np.ndarray:
    """Middles of the cells along an axis."""
    return (np.arange(ROWS[axis]) - (ROWS[axis] - 1) / 2) * CELL[axis]


def _frustum(
    low: np.ndarray, high: np.ndarray, bottom: float, top: float, radii: tuple[float, float] = (0.007, 0.007)
) -> solids.Solid:
    """A box around the z axis whose half widths go from ``low`` to ``high``, with upright edges of the given radii."""
    outlines = [solids.rounded_rectangle(2 * half, r, 6) for half, r in zip((low, high), radii, strict=True)]
    rings = [np.column_stack([o, np.full(len(o), z)]) for o, z in zip(outlines, (bottom, top), strict=True)]
    return solids.closed_rings(rings)


def _cell(centre: tuple[float, float]) -> solids.Solid:
    """What is cut out for one egg: a round funnel with a flat floor."""
    funnel = _frustum(CELL / 2 - FOOT, CELL / 2 - CREST, FLOOR, RIDGE + 0.0005, ROUNDING)
    return solids.moved(funnel, (*centre, 0))


def _carton_pieces(inner: np.ndarray) -> list[pieces.Piece]:
    """Floor, four walls, ridges between the cells, and posts."""
    half = inner / 2
    wall = [(-FOOT, FLOOR), (0.001, 0), (-CREST, RIDGE), (-CREST, RIM), (0.006, RIM - 0.003), (0.0065, RIM)]
    ridge = [(-FOOT, FLOOR), (FOOT, FLOOR), (-CREST, RIDGE), (CREST, RIDGE)]
    out = [solids.box((*(inner + 0.002), FLOOR))]
    out += [
        _bar(axis, np.array(wall) * (sign, 1) + (sign * half[axis], 0), half[1 - axis] + 0.004)
        for axis, sign in itertools.product((0, 1), (-1, 1))
    ]
    out += [_bar(0, np.array(ridge) + (x, 0), half[1]) for x in (-CELL[0] / 2, CELL[0] / 2)]
    out += [_bar(1, np.array(ridge), half[0]), *(pieces.stack(POST, 12, (x, 0.0)) for x in POSTS)]
    places = itertools.product(_places(0), _places(1), (-1, 1), (-1, 1))
    return out + [_corner(np.array(place[:2]), np.array(place[2:])) for place in places]


def _corner(centre: np.ndarray, signs: np.ndarray) -> pieces.Piece:
    """What fills a cell's corner up to the plane that touches its rounding; ``signs`` say which corner."""
    points = []
    for half, radius, z in ((CELL / 2 - FOOT, ROUNDING[0], FLOOR), (CELL / 2 - CREST, ROUNDING[1], RIDGE)):
        leg = (2 - 2**0.5) * radius
        points += [(*(centre + signs * (half - back)), z) for back in ((0, 0), (leg, 0), (0, leg))]
    return pieces.hull(points)


def _bar(axis: int, section: np.ndarray, reach: float) -> pieces.Piece:
    """A section (k, 2) of the coordinate ``axis`` and z, drawn out to both sides along the other coordinate."""
    ends = []
    for place in (-reach, reach):
        ring = np.full((len(section), 3), place)
        ring[:, axis], ring[:, 2] = section[:, 0], section[:, 1]
        ends.append(ring)
    return pieces.hull(*ends)


def _pulp(rng: np.random.Generator, colour: Colour, size: int = 256) -> np.ndarray:
    """Moulded paper: matt, with short fibres."""
    shape = (size, size)
    picture = shaded(np.full((*shape, 3), colour, dtype=np.uint8), 0.88 + 0.16 * clouds(rng, shape, (20, 20), 3))
    picture = over(picture, np.asarray(colour) * 0.6, (noise(rng, shape, (60, 20)) > 0.93) * 0.35)
    return over(picture, (236, 234, 228), (noise(rng, shape, (24, 60)) > 0.94) * 0.35)
