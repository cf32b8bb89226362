"""Arrivals, departures and moves between two views, and mere shadows."""

from __future__ import annotations

import cv2
import numpy as np

from vcage.models.rules.pixels import Change, displaced
from vcage.vision.protocols import View

RNG = np.random.default_rng(3)
TABLE = np.clip(cv2.GaussianBlur(RNG.normal(size=(120, 160)), (0, 0), 3)[..., None] * 60 + [150, 115, 80], 0, 255)
NONE = np.zeros((120, 160), bool)


def picture(*things: tuple[slice, slice], shade: tuple[slice, slice] | None = None) -> np.ndarray:
    drawn = TABLE.copy()
    if shade is not None:
        drawn[shade] = ((drawn[shade] / 255) ** 2.2 * 0.5) ** (1 / 2.2) * 255
    for thing in things:
        drawn[thing] = (40, 90, 190)
    return drawn.astype(np.uint8)


def mask(*things: tuple[slice, slice]) -> np.ndarray:
    found = NONE.copy()
    for thing in things:
        found[thing] = True
    return found


def change(one: np.ndarray, other: np.ndarray) -> Change:
    return Change.between(View(one, None), View(other, None))  # pyrefly: ignore


def test_an_arrival_is_an_object_and_its_shadow_is_not() -> None:
    thing, shade = np.s_[30:60, 40:70], np.s_[60:90, 45:75]
    found = change(picture(), picture(thing, shade=shade))
    assert found.things[34:56, 44:66].all()
    assert found.all[64:86, 49:71].all() and not found.things[66:88, 40:80].any()


def test_a_shadow_on_dark_wood_is_no_thing() -> None:
    wood = np.clip(TABLE * np.array([60, 40, 26]) / [150, 115, 80], 0, 255)
    shaded = wood.copy()
    shaded[40:80, 50:90] = ((wood[40:80, 50:90] / 255) ** 2.2 * 0.45) ** (1 / 2.2) * 255
    found = change(wood.astype(np.uint8), shaded.astype(np.uint8))
    assert found.all[44:76, 54:86].all() and found.things[44:76, 54:86].mean() < 0.1


def test_a_departure_with_an_arrival_elsewhere_is_displaced() -> None:
    old, new = np.s_[20:40, 20:40], np.s_[70:90, 100:120]
    found = change(picture(old), picture(new))
    assert displaced(found, NONE, mask(old), mask(new), far=15) > 200


def test_an_explained_change_is_not_displaced() -> None:
    old, new = np.s_[20:40, 20:40], np.s_[70:90, 100:120]
    found = change(picture(old), picture(new))
    explained = mask(np.s_[15:45, 15:45], np.s_[65:95, 95:125])
    assert displaced(found, explained, mask(old), mask(new), far=15) == 0


def test_a_nudged_object_stands_at_its_old_place() -> None:
    old, new = np.s_[20:60, 20:60], np.s_[20:60, 26:66]
    found = change(picture(old), picture(new))
    assert displaced(found, NONE, mask(old), mask(new), far=15) == 0
    assert displaced(found, NONE, mask(old), mask(new), far=3) > 0
