"""Painted textures: same name, same bytes; and they repeat without a seam."""

from __future__ import annotations

import numpy as np
import pytest

from vcage.base.errors import UnknownName
from vcage.objects.modelling import materials
from vcage.objects.modelling.noise import clouds, noise
from vcage.objects.table_tops import TABLES, table_texture


@pytest.mark.parametrize("name", TABLES)
def test_a_table_top_is_a_picture_and_always_the_same(name: str) -> None:
    first = table_texture(name)
    assert first.dtype == np.uint8 and first.ndim == 3 and first.shape[2] == 3
    assert first.std() > 0.5
    np.testing.assert_array_equal(first, table_texture(name))


def test_an_unknown_table_top_is_refused_with_those_that_exist() -> None:
    with pytest.raises(UnknownName, match="grey_stone, oak, walnut, white_laminate"):
        table_texture("marble")


def test_noise_repeats_without_a_seam() -> None:
    picture = clouds(np.random.default_rng(0), (64, 96), (4, 6))
    for axis in (0, 1):
        steps = np.abs(np.diff(picture, axis=axis)).max()
        seam = np.abs(np.take(picture, 0, axis) - np.take(picture, -1, axis)).max()
        assert seam <= 1.5 * steps


def test_noise_stays_between_0_and_1() -> None:
    picture = noise(np.random.default_rng(1), (40, 50), (5, 7))
    assert picture.shape == (40, 50) and picture.min() >= 0 and picture.max() <= 1


def test_colours_survive() -> None:
    red = materials.plastic(np.random.default_rng(0), (200, 30, 40))
    np.testing.assert_allclose(red.reshape(-1, 3).mean(axis=0), (200, 30, 40), atol=8)
