"""SAPIEN's shaders without the table that nothing of ours reads."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from vcage.base.geometry import Camera, look_at
from vcage.sim import render, shaders
from vcage.sim.cameras import shoot
from vcage.sim.shaders import TABLE, shaders_without_table
from vcage.sim.world import World

DECLARED = f"layout(set = 2, binding = 8) uniform sampler2D {TABLE};"
READ = f"vec2 envBRDF = texture({TABLE}, vec2(roughness, dotNV)).xy;"


@pytest.fixture
def packs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of a SAPIEN with one pack."""
    monkeypatch.setenv("VCAGE_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(shaders.resources, "files", lambda _: tmp_path / "sapien")
    folder = tmp_path / "sapien" / "vulkan_shader"
    for name in ("common", "default"):
        (folder / name).mkdir(parents=True)
    (folder / "common" / "lights.glsl").write_text("struct Light {};\n")
    return folder


def test_the_table_is_neither_declared_nor_read(packs):
    (packs / "default" / "deferred.frag").write_text(f"one\n{DECLARED}\n{READ}\n")
    (packs / "default" / "scene_set.glsl").write_text(f"two\n{DECLARED}")
    made = shaders_without_table("default")
    assert (made / "deferred.frag").read_text() == "one\nvec2 envBRDF = vec2(0);\n"
    assert (made / "scene_set.glsl").read_text() == "two\n"
    assert (made.parent / "common" / "lights.glsl").read_text() == "struct Light {};\n"


def test_a_pack_that_reads_it_in_another_way_is_left_as_it_is(packs):
    texts = {"deferred.frag": f"{DECLARED}\n{READ}\n", "other.frag": f"textureLod({TABLE}, at, 0);\n"}
    for name, text in texts.items():
        (packs / "default" / name).write_text(text)
    made = shaders_without_table("default")
    assert {name: (made / name).read_text() for name in texts} == texts


def test_it_is_made_once(packs):
    (packs / "default" / "deferred.frag").write_text("one")
    made = shaders_without_table("default")
    (packs / "default" / "deferred.frag").write_text("two")
    assert shaders_without_table("default") == made and (made / "deferred.frag").read_text() == "one"


@pytest.mark.parametrize("name", ["default", "minimal"])
def test_the_shaders_of_the_sapien_that_is_installed_lose_it(name):
    assert not [path.name for path in shaders_without_table(name).iterdir() if TABLE in path.read_text()]


@pytest.mark.slow
def test_pictures_are_the_same_to_the_last_bit_as_with_the_shaders_as_they_came(
    template, bodies, robot, rendered, monkeypatch
):
    camera = Camera(160, 120, 0.9, look_at([0.5, -0.6, 1.4], [0, 0, 0.74]))
    world = World(template.table, bodies, robot, render=True)
    rendered.set_state(world.state())
    ours = shoot(rendered, camera)
    monkeypatch.setattr(render, "shaders_without_table", lambda name: name)
    assert np.array_equal(shoot(world, camera), ours)
