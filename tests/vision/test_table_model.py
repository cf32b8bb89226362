from __future__ import annotations

import numpy as np
import pytest

from vcage.vision.table_model import fit_table

SHAPE = (120, 160, 3)


@pytest.fixture(scope="module")
def grain() -> np.ndarray:
    """A table with stripes and noise."""
    rng = np.random.default_rng(3)
    stripes = 12 * np.sin(np.arange(SHAPE[0]) / 3)[:, None, None]
    return np.clip(rng.normal((170, 140, 100), 2, SHAPE) + stripes, 0, 255).astype(np.uint8)


def with_object(table: np.ndarray) -> np.ndarray:
    picture = table.copy()
    picture[40:70, 60:100] = (60, 80, 190)
    return picture


def shares(salience: np.ndarray) -> tuple[float, float]:
    """Mean salience of the object and of the table away from it."""
    table = np.ones(SHAPE[:2], bool)
    table[30:80, 50:110] = False
    return float(salience[45:65, 65:95].mean()), float(salience[table].mean())


def test_an_object_stands_out_of_the_known_table(grain):
    model = fit_table(with_object(grain), grain)
    assert model.known
    inside, outside = shares(model.salience)
    assert inside > 0.95 and outside < 0.15


def test_an_object_stands_out_of_an_unknown_table(grain):
    inside, outside = shares(fit_table(with_object(grain)).salience)
    assert inside > 0.8 and outside < 0.2


def test_a_repainted_table_is_learnt_from_the_picture(grain):
    other = np.clip(np.random.default_rng(4).normal((90, 150, 110), 2, SHAPE), 0, 255).astype(np.uint8)
    model = fit_table(with_object(other), grain)
    assert not model.known
    inside, outside = shares(model.salience)
    assert inside > 0.95 and outside < 0.15


def test_another_light_and_a_shadow_do_not_stand_out(grain):
    u = np.linspace(0.8, 1.1, SHAPE[1])[None, :, None]
    lit = np.clip(with_object(grain) * u, 0, 255)
    lit[90:110, 20:60] *= 0.88
    salience = fit_table(lit.astype(np.uint8), grain).salience
    assert salience[92:108, 22:58].mean() < 0.6
    assert shares(salience)[0] > 0.95


def test_outside_the_region_nothing_stands_out(grain):
    region = np.zeros(SHAPE[:2], bool)
    region[:, :50] = True
    assert not fit_table(with_object(grain), grain, region).salience[:, 50:].any()


def test_a_picture_of_one_colour_has_nothing_on_it():
    assert fit_table(np.full(SHAPE, 128, np.uint8)).salience.max() < 0.05
