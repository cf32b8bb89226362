"""Lettering and patterns of printed packs."""

from __future__ import annotations

import numpy as np
import pytest

from assets.textures import packaging
from vcage.objects.modelling import prints

WHITE, BLACK = (255, 255, 255), (0, 0, 0)


def _inked(picture: np.ndarray) -> tuple[int, int]:
    """Height and width of what is dark, pixels."""
    rows, columns = np.nonzero(picture.sum(axis=2) < 380)
    return int(np.ptp(rows)) + 1, int(np.ptp(columns)) + 1


@pytest.mark.parametrize("words", ["A", "TEA", "EXTRAORDINARY"])
def test_fitted_words_fill_their_room_and_stay_in_it(words: str) -> None:
    tall, wide = _inked(packaging.fitted(prints.canvas(400, 200, WHITE), words, (0.5, 0.5), (0.5, 0.3), BLACK))
    assert tall <= 62 and wide <= 202
    assert tall >= 54 or wide >= 185


def test_upright_words_are_taller_than_wide() -> None:
    picture = packaging.fitted(prints.canvas(100, 300, WHITE), "MINT", (0.5, 0.5), (0.8, 0.5), BLACK, upright=True)
    tall, wide = _inked(picture)
    assert tall > wide


def test_a_cross_has_equal_arms_on_a_picture_that_is_not_square() -> None:
    tall, wide = _inked(packaging.cross(prints.canvas(400, 200, WHITE), (0.5, 0.5), 0.3, BLACK))
    assert abs(tall - wide) <= 2


def test_a_month_has_its_last_day_inside_the_page() -> None:
    page = packaging.calendar_page("MARCH", 6, 31, (200, 30, 30))
    assert (page[-1] == page[-1, 0]).all() and (page[:, -1] == page[:, -2]).all()


@pytest.mark.parametrize("paint", [packaging.quilted, lambda rng: packaging.terry(rng, (200, 180, 160))])
def test_patterns_are_always_the_same_for_the_same_seed(paint) -> None:
    np.testing.assert_array_equal(paint(np.random.default_rng(3)), paint(np.random.default_rng(3)))


def test_stripes_take_the_colours_in_turns() -> None:
    picture = packaging.striped([WHITE, BLACK], 4, (40, 2))
    assert [int(picture[0, x, 0]) for x in (5, 15, 25, 35)] == [255, 0, 255, 0]
