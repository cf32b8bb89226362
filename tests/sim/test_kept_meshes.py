"""Meshes and textures that SAPIEN keeps in memory."""

from __future__ import annotations

import gc

import numpy as np
import psutil
import pytest
import trimesh
from PIL import Image

from vcage.base.geometry import Camera, Pose, look_at
from vcage.schema.scene import Table
from vcage.sim.bodies import Body
from vcage.sim.cameras import shoot
from vcage.sim.world import World

TABLE = Table()
CAMERA = Camera(64, 48, 0.5, look_at([0, 0.5, 1.5], [0, 0, TABLE.height]))
PLACE = Pose([0, 0, TABLE.height])


def textured(model, folder, number, size=1024):
    """The model with a texture of its own, some megabytes when loaded."""
    mesh = trimesh.creation.box(bounds=[model.lower, model.upper])
    picture = Image.new("RGB", (size, size), (40 + number, 200, 40))
    mesh.visual = trimesh.visual.TextureVisuals(uv=np.zeros((len(mesh.vertices), 2)), image=picture)
    path = folder / f"object-{number}.glb"
    path.write_bytes(mesh.export(file_type="glb"))
    return model.model_copy(update={"visual": str(path)})


def drawn(*models):
    return World(TABLE, {str(i): Body(model, PLACE) for i, model in enumerate(models)}, render=True)


@pytest.mark.slow
def test_the_memory_of_a_process_that_draws_ever_other_objects_does_not_grow(models, tmp_path):
    megabytes = []
    for number in range(60):
        shoot(drawn(textured(models["cube"], tmp_path, number)), CAMERA)
        gc.collect()
        megabytes.append(psutil.Process().memory_info().rss / 1e6)
    assert max(megabytes[30:]) - max(megabytes[:30]) < 40


def test_a_world_draws_the_same_after_many_other_objects_and_so_does_one_made_anew(models, tmp_path):
    first = textured(models["cube"], tmp_path, 0)
    world = drawn(first)
    before = shoot(world, CAMERA)
    for number in range(1, 20):
        drawn(textured(models["cube"], tmp_path, number, size=8))
    assert np.array_equal(shoot(world, CAMERA), before)
    assert np.array_equal(shoot(drawn(first), CAMERA), before)
