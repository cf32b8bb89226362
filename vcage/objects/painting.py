"""Looks that are made on demand: colours of objects whose look has one main colour, and objects on their sides."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from vcage.objects.colour_words import word_of
from vcage.objects.modelling.parts import BuiltObject, Part
from vcage.schema.asset import Annotation, CatalogueEntry, Variant

if TYPE_CHECKING:
    from vcage.objects.modelling.noise import Colour

PAINTS: dict[str, Colour] = {
    "red": (196, 40, 36), "orange": (232, 122, 30), "yellow": (242, 200, 40), "green": (52, 144, 70),
    "cyan": (60, 190, 214), "blue": (38, 88, 186), "purple": (122, 62, 168), "pink": (238, 142, 178),
    "brown": (116, 74, 44), "black": (36, 36, 38), "white": (240, 239, 235), "grey": (132, 133, 136),
    "beige": (224, 204, 166), "cream": (246, 236, 204), "gold": (206, 160, 58), "magenta": (202, 44, 140),
    "navy": (28, 42, 96), "silver": (186, 189, 194), "tan": (200, 160, 110), "teal": (24, 128, 128),
    "turquoise": (64, 200, 188),
}  # fmt: skip
"""Every colour that a look can have on demand, sRGB."""


LYING = "_lying"
"""Suffix of the id of a look on its side (:mod:`vcage.objects.lying`)."""


@dataclass(frozen=True)
class PaintSettings:
    """How the main colour of a look is told from its other colours, and how its shades are kept.

    Args:
        same: Lab distance from the main colour up to which a texel is painted.
        other: the distance from which it is left; between the two it is mixed.
        shades: least and largest lightness of a painted texel, as shares of the paint's.
    """

    same: float = 30.0
    other: float = 48.0
    shades: tuple[float, float] = (0.6, 1.12)


SETTINGS = PaintSettings()


def look(kind: Annotation | CatalogueEntry, variant: str) -> Variant | None:
    """The look of a kind with this id: one of its variants, or a colour that it can be painted in; None without one."""
    found = next((own for own in kind.variants if own.id == variant), None) or in_colour(kind, variant)
    if found is None and variant.endswith(LYING) and (standing := look(kind, variant.removesuffix(LYING))):
        return lying_look(standing)
    return found


def lying_look(variant: Variant) -> Variant:
    """The look of a standing one on its side."""
    return variant.model_copy(update={"id": f"{variant.id}{LYING}", "laid": variant.id})


def in_colour(kind: Annotation | CatalogueEntry, colour: str) -> Variant | None:
    """The variant of a kind that is painted in a colour; None where that is no colour, or no look has a main colour."""
    base = next((own for own in kind.variants if own.id == kind.any_colour), None)
    if base is None or colour not in PAINTS or any(own.id == colour for own in kind.variants):
        return None
    return base.model_copy(update={"id": colour, "colour": colour, "description": "", "painted": base.id})


def looks_of(kind: Annotation | CatalogueEntry) -> list[str]:
    """The ids of all looks of a kind: its variants, then the colours that it comes in on demand."""
    own = [variant.id for variant in kind.variants]
    return own if kind.any_colour is None else [*own, *(colour for colour in PAINTS if colour not in own)]


def with_look(entry: CatalogueEntry, variant: Variant) -> CatalogueEntry:
    """The entry of an object: it has its own look only."""
    return entry.model_copy(update={"variants": [variant], "any_colour": None})


def repainted(built: BuiltObject, colour: str) -> BuiltObject:
    """The same object with its main colour replaced; shape, mass and all other colours stay.

    Args:
        built: in the look that has one main colour.
        colour: of :data:`PAINTS`.
    """
    main = main_colour([*built.parts, *(part for link in built.moving for part in link.parts)])
    return replace(
        built,
        parts=[_painted(part, main, PAINTS[colour]) for part in built.parts],
        moving=[replace(m, parts=[_painted(part, main, PAINTS[colour]) for part in m.parts]) for m in built.moving],
    )


def main_colour(parts: list[Part]) -> np.ndarray:
    """(3,) sRGB: the mean of the triangles whose colour has the word that most of the surface has."""
    sums: dict[str, np.ndarray] = {}
    for colour, area in _triangles(parts):
        word = word_of(colour)
        sums[word] = sums.get(word, np.zeros(4)) + area * np.array([*colour, 1.0])
    most = max(sums.values(), key=lambda total: total[3])
    return most[:3] / most[3]


def _triangles(parts: list[Part]) -> Iterator[tuple[np.ndarray, float]]:
    """Colour at the middle, and area, of all triangles."""
    for part in parts:
        corners = part.vertices[part.faces]
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
        uv = part.uv[part.faces].mean(axis=1)
        high, wide = part.texture.shape[:2]
        columns = (uv[:, 0] % 1.0 * wide).astype(int).clip(0, wide - 1)
        rows = ((1 - uv[:, 1] % 1.0) * high).astype(int).clip(0, high - 1)
        yield from zip(part.texture[rows, columns].astype(np.float64), areas.tolist(), strict=True)


def _painted(part: Part, main: np.ndarray, paint: Colour) -> Part:
    import cv2

    texture = part.texture.astype(np.float32)
    lab = cv2.cvtColor(texture / 255, cv2.COLOR_RGB2LAB)
    from_main = lab - cv2.cvtColor((main / 255).astype(np.float32).reshape(1, 1, 3), cv2.COLOR_RGB2LAB)
    distance = np.linalg.norm(from_main, axis=2)
    share = np.clip((SETTINGS.other - distance) / (SETTINGS.other - SETTINGS.same), 0, 1)[..., None]
    shade = np.clip((texture.mean(axis=2) + 8) / (main.mean() + 8), *SETTINGS.shades)[..., None]
    mixed = texture * (1 - share) + np.asarray(paint, dtype=np.float32) * shade * share
    return replace(part, texture=np.clip(np.round(mixed), 0, 255).astype(np.uint8))
