"""Where on the table a thing is put down."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.example_scenes import GROUND, TABLE_TOP, thing
from vcage.base.attempts import LIMITS
from vcage.base.geometry import Pose, boxes_overlap
from vcage.goals.in_place_of import off_place
from vcage.goals.presented import TOWARDS_CUSTOMER, faces, on_customers_half
from vcage.goals.thresholds import THRESHOLDS
from vcage.plans.relations import holds
from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE
from vcage.sim.kinematics import kinematics_of
from vcage.sim.robots import load_robot
from vcage.tasks.grasps import grasp_poses
from vcage.tasks.ground import Ground

PLATE = thing("plate", (0.0, 0.05))
WORDS = ["left_of", "right_of", "in_front_of", "behind", "beside", "near"]


def goal(word: str, reference: str | None = None) -> Goal:
    return Goal(subject="block", relation=word, reference=reference)  # pyrefly: ignore


@settings(deadline=None, max_examples=30)
@given(st.sampled_from(WORDS), st.integers(0, 2**32 - 1))
def test_an_object_put_beside_another_touches_nothing(word: str, seed: int) -> None:
    block, other = thing("block", (-0.3, -0.1)), thing("mug", (0.2, 0.0))
    poses = GROUND.poses(block, goal(word, PLATE.id), [PLATE, other], np.random.default_rng(seed))
    pose = next(poses)
    there = block.moved(pose)
    assert holds(word, there.aabb, PLATE.aabb)  # pyrefly: ignore
    assert not any(boxes_overlap(there.aabb, o.aabb) for o in (PLATE, other))


def test_an_object_at_the_target_moves_it_elsewhere() -> None:
    block = thing("block", (-0.3, -0.1))
    full = [np.array([[-0.45, -0.25], [0.0, 0.3]])]
    poses = GROUND.poses(block, goal("on", TABLE), [], np.random.default_rng(0), full)
    assert all(pose.p[0] > 0 for pose in itertools.islice(poses, 5))


def test_an_object_is_put_down_in_reach_of_an_arm() -> None:
    left = kinematics_of(load_robot("aloha_agilex").arms["left"])
    block, reached = thing("block", (-0.3, -0.1)), replace(GROUND, arms=(left,))
    found = list(reached.poses(block, goal("on", TABLE), [], np.random.default_rng(0)))
    anywhere = list(GROUND.poses(block, goal("on", TABLE), [], np.random.default_rng(0)))
    assert 0 < len(found) < len(anywhere)
    assert {pose.p.tobytes() for pose in found} < {pose.p.tobytes() for pose in anywhere}
    for pose in found:
        grasps = [grasp_poses(pose, c, left.arm.gripper, TABLE_TOP) for c in block.asset.annotation.carrying_points]
        assert any(left.reachable(grasp.pose) for some in grasps for grasp in some)


def test_a_full_table_has_no_place() -> None:
    full = [np.array([[-0.45, -0.25], [0.45, 0.3]])]
    assert not list(GROUND.poses(thing("block"), goal("on", TABLE), [], np.random.default_rng(0), full))


def test_back_is_where_it_stood() -> None:
    block = thing("block", (-0.3, -0.1), 0.4)
    assert list(GROUND.poses(block, goal("back"), [], np.random.default_rng(0))) == [block.pose]


def test_a_shown_object_faces_the_customer_on_the_far_side() -> None:
    poses = GROUND.poses(thing("block"), goal("presented"), [], np.random.default_rng(0))
    for pose in itertools.islice(poses, 5):
        assert faces(pose, TOWARDS_CUSTOMER) and on_customers_half(pose)


def test_a_full_customer_s_strip_leaves_the_customer_s_half() -> None:
    strip = [np.array([[-0.45, 0.12], [0.45, 0.3]])]
    pose = next(GROUND.poses(thing("block"), goal("presented"), [], np.random.default_rng(0), strip))
    assert 0 < pose.p[1] < 0.12


def test_a_presented_object_may_stand_in_the_near_part_of_the_customers_half() -> None:
    poses = list(GROUND.poses(thing("block"), goal("presented"), [], np.random.default_rng(0)))
    assert all(on_customers_half(pose) for pose in poses)
    assert sum(pose.p[1] < GROUND.upper[1] / 2 for pose in poses) > 0.4 * len(poses)


@pytest.mark.parametrize(("yaw", "shown"), [(180, True), (160, True), (90, False), (0, False)])
def test_a_front_faces_the_customer_within_an_angle(yaw: float, shown: bool) -> None:
    assert faces(Pose.from_yaw([0, 0.2, 0.74], np.radians(yaw)), TOWARDS_CUSTOMER) is shown


def test_a_front_that_looks_up_faces_no_customer() -> None:
    assert not faces(Pose([0, 0.2, 0.74], [np.cos(np.pi / 4), np.sin(np.pi / 4), 0, 0]), TOWARDS_CUSTOMER)


def test_what_is_centred_is_put_down_within_the_limit_of_the_centre() -> None:
    for kind in ("block", "plate"):
        poses = list(GROUND.poses(thing(kind), goal("centred"), [], np.random.default_rng(0)))
        assert poses and all(np.linalg.norm(pose.p[:2]) < THRESHOLDS.centred_m for pose in poses)


def test_a_thing_takes_the_place_that_another_has_left() -> None:
    block, gone = thing("block", (-0.3, -0.1)), PLATE.moved(Pose([0.3, 0.1, TABLE_TOP]))
    ground = replace(GROUND, starts={PLATE.id: PLATE.aabb})
    for others in ([PLATE], [gone]):
        poses = list(ground.poses(block, goal("in_place_of", PLATE.id), others, np.random.default_rng(0)))
        assert poses and all(off_place(block.moved(pose).aabb, PLATE.aabb) < 1e-6 for pose in poses)


def test_a_place_that_a_third_thing_has_taken_is_not_free() -> None:
    block, mug = thing("block", (-0.3, -0.1)), thing("mug", (0.0, 0.05))
    gone = PLATE.moved(Pose([0.3, 0.1, TABLE_TOP]))
    ground = replace(GROUND, starts={PLATE.id: PLATE.aabb})
    assert not list(ground.poses(block, goal("in_place_of", PLATE.id), [gone, mug], np.random.default_rng(0)))


@pytest.mark.parametrize("fruitless", [0, 1, LIMITS.ground_rounds - 1, LIMITS.ground_rounds])
def test_places_are_drawn_in_a_few_rounds_until_one_is_in_reach(
    fruitless: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    block, rounds = thing("block", (-0.3, -0.1)), list[int]()

    def drawn(*_: object) -> list[Pose]:
        rounds.append(len(rounds))
        return [PLATE.pose]

    monkeypatch.setattr(Ground, "_free_poses", drawn)
    monkeypatch.setattr(Ground, "_reached", lambda *_: len(rounds) > fruitless)
    found = list(GROUND.poses(block, goal("on", TABLE), [], np.random.default_rng(0)))
    assert len(rounds) == min(fruitless + 1, LIMITS.ground_rounds)
    assert len(found) == (fruitless < LIMITS.ground_rounds)
