from __future__ import annotations

from functools import partial

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from vcage.sim.appearance import Appearance


def test_the_same_seed_gives_the_same_appearance():
    assert Appearance.random(np.random.default_rng(4)) == Appearance.random(np.random.default_rng(4))


@given(seed=st.integers(0, 10_000))
def test_variations_stay_moderate(seed):
    look = Appearance.random(np.random.default_rng(seed))
    assert look.light_direction[2] < 0 and look.light_direction[1] < 0
    assert all(0 < c < 1 for c in (*look.ambient, *look.floor_colour, *look.wall_colour, *look.table_colour))


def test_a_texture_is_chosen_from_those_given():
    textures = [partial(np.full, (2, 2, 3), i, np.uint8) for i in range(3)]
    chosen = {int(Appearance.random(np.random.default_rng(s), textures).table_texture[0, 0, 0]) for s in range(30)}
    assert chosen == {0, 1, 2}
