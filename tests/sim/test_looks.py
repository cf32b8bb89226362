"""Looks: the same record gives the same look, within its ranges, and what things are called stays true."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vcage.base.errors import DamagedFile, InputFileError, MissingStage, SchemaMismatch, UnknownName
from vcage.objects.surface_pictures import surface_picture
from vcage.schema.randomisation import MOST_LIGHTS, CameraRanges, Light, Look, Surface, Tint
from vcage.schema.scene import ObjectRecord, Scene
from vcage.sim.cameras import placed
from vcage.sim.looks import _cameras, _lights, appearance_of
from vcage.sim.robots import load_randomisation, load_robot
from vcage.sim.tints import HUE_MARGIN_DEG, Colours, truthful

CHANNEL = st.integers(0, 255)


@given(
    rgb=st.tuples(CHANNEL, CHANNEL, CHANNEL),
    hue=st.floats(-180, 180),
    saturation=st.floats(0.5, 2),
    lightness=st.floats(0.5, 2),
)
def test_the_word_for_a_colour_stays_under_every_tint(rgb, hue, saturation, lightness):
    colours = Colours(np.array([rgb], np.uint8), np.ones(1))
    kept = truthful(colours, Tint(hue_deg=hue, saturation=saturation, lightness=lightness))
    assert kept is None or colours.words(kept) == colours.words()


@given(st.integers(43, 60), st.floats(-20, 20))
def test_a_yellow_thing_keeps_its_distance_from_orange(hue, turn):
    picture = np.array([[[hue, 0.5, 0.9]]], np.float32)
    rgb = (cv2.cvtColor(picture, cv2.COLOR_HLS2RGB)[0, 0] * 255).round().astype(np.uint8)
    colours = Colours(rgb[None], np.ones(1))
    kept = truthful(colours, Tint(hue_deg=turn, saturation=1.0, lightness=1.0))
    nearer = None if kept is None else kept.model_copy(update={"hue_deg": kept.hue_deg - HUE_MARGIN_DEG})
    assert nearer is None or colours.words(nearer) == colours.words()


@pytest.mark.parametrize("name", ["none", "light", "full"])
def test_every_file_of_ranges_is_loaded_by_its_name(name):
    assert load_randomisation(name).name == name


@given(seed=st.integers(0, 10_000))
def test_lights_shine_down_and_only_the_key_light_throws_shadows(seed):
    lights, ambient = _lights(load_randomisation("full").look.light, np.random.default_rng(seed))
    assert 1 <= len(lights) <= MOST_LIGHTS and all(0 < c < 1 for c in ambient)
    assert all(light.direction[2] < 0 for light in lights) and not any(light.shadows for light in lights[1:])


@pytest.mark.parametrize(("where", "name"), [("table", "oak"), ("wall", "brick"), ("floor", "screed")])
def test_the_colour_of_a_surface_multiplies_its_texture(where, name):
    def shown(colour):
        plain, painted = Surface(texture=None, colour=(0.5, 0.5, 0.5)), Surface(texture=name, colour=colour)
        light = Light(direction=(0, 0, -1), colour=(1, 1, 1), shadows=False)
        surfaces = {**dict.fromkeys(("table", "wall", "floor"), plain), where: painted}
        made = appearance_of(Look(lights=[light], ambient=(0.5, 0.5, 0.5), surfaces=surfaces))
        return getattr(made, f"{where}_texture").astype(float)

    own, half = surface_picture(where, name), shown((1.0, 0.5, 1.0))
    np.testing.assert_array_equal(shown((1.0, 1.0, 1.0)), own)
    np.testing.assert_allclose(half, own * [1, 0.5 ** (1 / 2.2), 1], atol=0.51)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=25)
def test_a_shifted_camera_sees_every_object_that_it_sees_where_its_file_puts_it(seed):
    rng, robot = np.random.default_rng(seed), load_robot("aloha_agilex")
    middles = [*rng.uniform([-0.6, -0.3, 0.75], [0.6, 0.3, 0.8], (8, 3)), [0.405, -0.24, 0.76]]
    objects = [ObjectRecord.model_construct(aabb=(m - 0.02, m + 0.02)) for m in map(np.array, middles)]
    scene = Scene.model_construct(objects=objects)
    wild = CameraRanges(shift=0.05, turn_deg=10.0, fovy=(0.8, 1.2))
    for name, shift in _cameras(wild, scene, robot, rng).items():
        camera = robot.cameras[name]
        if camera.arm is None:
            lost = placed(camera).sees(middles) & ~placed(camera, shift).sees(middles)
            assert not lost.any()


def test_lossless_cameras_and_those_on_arms_are_shifted_as_drawn():
    robot = load_robot("aloha_agilex")
    drawn = _cameras(CameraRanges(turn_deg=3.0), Scene.model_construct(objects=[]), robot, np.random.default_rng(0))
    assert len(drawn) == len(robot.cameras) and all(np.any(shift.turn_deg) for shift in drawn.values())


def test_an_unknown_name_error_lists_the_known_ones():
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


HEAD = "schema: vcage.randomisation/1\nname: full\ndescription: x\n"


def test_a_file_of_ones_own_is_not_taken_for_ours_of_that_name(tmp_path):
    file = tmp_path / "mine.yml"
    file.write_text(HEAD)
    assert load_randomisation(str(file)).name == "mine.yml"


def test_an_unknown_texture_is_named_with_the_known_ones(tmp_path):
    file = tmp_path / "mine.yml"
    file.write_text(HEAD + "look: {surfaces: {floor: [lava]}}\n")
    with pytest.raises(UnknownName, match=r"unknown floor 'lava'.*screed"):
        load_randomisation(str(file))


def test_an_unreadable_file_is_named(tmp_path, monkeypatch):
    file = tmp_path / "mine.yml"
    file.write_text(HEAD)

    def refused(*_: object, **__: object) -> str:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refused)
    with pytest.raises(InputFileError, match=r"mine\.yml cannot be read: .*Permission denied"):
        load_randomisation(str(file))


def test_a_file_without_text_is_named(tmp_path):
    file = tmp_path / "mine.yml"
    file.write_bytes(b"\xff\xfe\x00bad")
    with pytest.raises(DamagedFile, match=r"mine\.yml"):
        load_randomisation(str(file))
