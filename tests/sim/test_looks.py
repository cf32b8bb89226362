"""Looks: the same record gives the same look, within its ranges, and what things are called stays true."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vcage.base.errors import MissingStage, SchemaMismatch, UnknownName
from vcage.schema.randomisation import MOST_LIGHTS, Tint
from vcage.sim.looks import _lights
from vcage.sim.robots import load_randomisation
from vcage.sim.tints import Colours, truthful

CHANNEL = st.integers(0, 255)


@given(
    rgb=st.tuples(CHANNEL, CHANNEL, CHANNEL),
    hue=st.floats(-180, 180),
    saturation=st.floats(0.5, 2),
    lightness=st.floats(0.5, 2),
)
def test_the_word_for_a_colour_stays_whatever_is_drawn(rgb, hue, saturation, lightness):
    colours = Colours(np.array([rgb], np.uint8), np.ones(1))
    kept = truthful(colours, Tint(hue_deg=hue, saturation=saturation, lightness=lightness))
    assert kept is None or colours.words(kept) == colours.words()


@pytest.mark.parametrize("name", ["none", "light", "full"])
def test_every_file_of_ranges_is_loaded_by_its_name(name):
    assert load_randomisation(name).name == name


@given(seed=st.integers(0, 10_000))
def test_lights_shine_down_and_only_the_key_light_throws_shadows(seed):
    lights, ambient = _lights(load_randomisation("full").look.light, np.random.default_rng(seed))
    assert 1 <= len(lights) <= MOST_LIGHTS and all(0 < c < 1 for c in ambient)
    assert all(light.direction[2] < 0 for light in lights) and not any(light.shadows for light in lights[1:])


def test_an_unknown_name_lists_those_there_are():
    with pytest.raises(UnknownName, match="full, light, none"):
        load_randomisation("wild")


def test_a_file_of_ones_own_must_be_there(tmp_path):
    with pytest.raises(MissingStage, match=r"mine\.yml"):
        load_randomisation(str(tmp_path / "mine.yml"))


def test_a_wrong_range_is_named(tmp_path):
    file = tmp_path / "mine.yml"
    file.write_text("schema: vcage.randomisation/1\nname: mine\ndescription: x\nlook: {light: {slant: [1, 0]}}\n")
    with pytest.raises(SchemaMismatch, match=r"look\.light\.slant"):
        load_randomisation(str(file))
