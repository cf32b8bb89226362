"""What differs between two episodes of one scene."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.example_scenes import TABLE_TOP, thing
from vcage.base.geometry import boxes_overlap, wrap_angle
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.variation import shifted_poses

seeds = st.integers(0, 2**32 - 1)


def crowd() -> list[SceneObject]:
    """Objects that stand closer than they may be shifted to."""
    assets = ["block", "marker", "whiteboard_eraser", "tape_roll", "glue_stick", "block"]
    xs = (-0.3, -0.19, -0.05, 0.08, 0.17, 0.22)
    return [thing(name, (x, 0.0), id=f"{name}-{i}") for i, (name, x) in enumerate(zip(assets, xs, strict=True))]


@settings(deadline=None)
@given(seeds)
def test_shifted_objects_never_collide(seed: int):
    objects = crowd()
    poses = shifted_poses(objects, np.random.default_rng(seed))
    boxes = [o.moved(poses[o.id]).aabb for o in objects]
    assert not any(boxes_overlap(a, b) for a, b in combinations(boxes, 2))


@settings(deadline=None)
@given(seeds)
def test_shifts_and_turns_are_small_and_stay_on_the_table(seed: int):
    objects = crowd()
    poses = shifted_poses(objects, np.random.default_rng(seed), shift_m=0.008, turn_deg=6.0)
    for o, pose in zip(objects, poses.values(), strict=True):
        assert np.abs(pose.p - o.pose.p)[:2].max() <= 0.008
        assert pose.p[2] == TABLE_TOP
        assert abs(wrap_angle(pose.yaw - o.pose.yaw)) <= np.radians(6.0) + 1e-9


def test_an_object_that_stands_alone_is_shifted():
    block = thing("block")
    pose = shifted_poses([block], np.random.default_rng(0))["block"]
    assert not np.allclose(pose.p, block.pose.p)


def test_a_container_and_its_contents_stay_in_place():
    box = thing("packaging_box")
    inside = thing("marker", container=box.id, height=TABLE_TOP + 0.004)
    poses = shifted_poses([box, inside], np.random.default_rng(0))
    assert poses == {box.id: box.pose, inside.id: inside.pose}


def test_the_poses_come_in_the_order_of_the_objects():
    objects = crowd()
    assert list(shifted_poses(objects, np.random.default_rng(0))) == [o.id for o in objects]


@pytest.mark.parametrize("seed", [0, 1])
def test_the_same_seed_gives_the_same_shifts(seed: int):
    first, second = (shifted_poses(crowd(), np.random.default_rng(seed)) for _ in range(2))
    assert all(np.array_equal(first[key].matrix(), second[key].matrix()) for key in first)


def test_another_seed_gives_other_shifts():
    first, second = (shifted_poses([thing("block")], np.random.default_rng(seed)) for seed in (0, 1))
    assert not np.allclose(first["block"].p, second["block"].p)
