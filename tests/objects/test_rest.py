"""Objects that are put down upright stay where they are."""

from __future__ import annotations

import numpy as np
import pytest

from vcage.objects.asset import Asset


def _drift(asset: Asset, seconds: float = 1.0) -> tuple[float, float]:
    """Metres and degrees that an object moves on a flat ground."""
    sapien = pytest.importorskip("sapien")
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    scene.set_timestep(1 / 250)
    material = sapien.physx.PhysxMaterial(asset.model.friction, asset.model.friction, 0.0)
    ground = scene.create_actor_builder()
    ground.add_box_collision(half_size=[1, 1, 0.1], pose=sapien.Pose([0, 0, -0.1]), material=material)
    ground.build_static()
    builder = scene.create_actor_builder()
    for path in asset.model.hulls:
        builder.add_convex_collision_from_file(path, material=material, density=asset.model.mass / asset.volume)
    entity = builder.build()
    for _ in range(round(seconds * 250)):
        scene.step()
    pose = entity.pose
    return float(np.linalg.norm(pose.p)), float(np.degrees(2 * np.arccos(min(1.0, abs(pose.q[0])))))


def test_it_stays_where_it_is_put(first_variant: Asset) -> None:
    moved, turned = _drift(first_variant)
    assert moved < 0.002
    assert turned < 2.0
