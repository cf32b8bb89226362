"""The gripper's way in a place."""

from __future__ import annotations

import contextlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.example_scenes import TABLE_TOP, robot, template, thing
from vcage.base.geometry import Pose, frame_from_axes, oriented_boxes_overlap
from vcage.sim.collision import CollisionScene, Held
from vcage.sim.kinematics import kinematics_of
from vcage.sim.motion import MotionFailed, MotionPlanner
from vcage.sim.robots import load_robot
from vcage.tasks.grasps import GraspPose, approach_opening, grasp_poses, hand_boxes
from vcage.tasks.primitives.place import SETTINGS, Surroundings, old_places
from vcage.tasks.primitives.place_way import SET_DOWN, PlaceWay, largest_drop, place_way, reached_place
from vcage.tasks.scene_objects import Obstacles, SceneObject, SolidBox

GRIPPER = robot().arms["left"].gripper
GOAL = Pose([0.0, 0.0, TABLE_TOP])

neighbours = st.lists(
    st.builds(
        lambda x, y, yaw, width, height: SolidBox(
            np.array([[-width, -0.02, 0.0], [width, 0.02, height]]), Pose.from_yaw([x, y, TABLE_TOP], yaw)
        ),
        st.floats(-0.15, 0.15),
        st.floats(-0.15, 0.15),
        st.floats(-np.pi, np.pi),
        st.floats(0.005, 0.08),
        st.floats(0.005, 0.2),
    ),
    max_size=5,
)
grasp_numbers = st.integers(0, 9)


def grasps_of(target: SceneObject) -> list[GraspPose]:
    contact = target.asset.annotation.contact_point(0)
    return list(grasp_poses(target.pose, contact, GRIPPER, target.box.bottom))


def place_block(number: int, obstacles: list[SolidBox], height: float = TABLE_TOP + 0.25) -> PlaceWay:
    grasp = grasps_of(thing("block", (0.3, 0.0)))[number]
    return place_way(grasp.in_object, GOAL, Obstacles(obstacles), GRIPPER, 0.04, height)


@settings(deadline=None)
@given(neighbours, grasp_numbers)
def test_the_drop_is_enough_for_the_hand_to_clear_every_obstacle(obstacles: list[SolidBox], number: int):
    way = place_block(number, obstacles)
    for part in hand_boxes(GRIPPER, approach_opening(0.04, GRIPPER)):
        for obstacle in obstacles:
            assert not oriented_boxes_overlap(part, way.release, obstacle.bounds, obstacle.pose)


@settings(deadline=None)
@given(neighbours, grasp_numbers)
def test_the_object_falls_by_the_drop(obstacles: list[SolidBox], number: int):
    way = place_block(number, obstacles)
    held = grasps_of(thing("block", (0.3, 0.0)))[number].in_object
    assert (way.release * held.inverse()).p[2] - GOAL.p[2] == pytest.approx(way.drop)
    np.testing.assert_allclose((way.release * held.inverse()).p[:2], GOAL.p[:2], atol=1e-9)


@settings(deadline=None)
@given(neighbours, grasp_numbers)
def test_the_hand_comes_from_above_and_leaves_upwards(obstacles: list[SolidBox], number: int):
    way = place_block(number, obstacles)
    for other in (way.above, way.after):
        np.testing.assert_allclose(other.p[:2], way.release.p[:2], atol=1e-9)
        assert other.p[2] > way.release.p[2]


def test_a_hand_draws_back_no_higher_than_its_arm_reaches():
    """As with a tilted hand far from the base: it comes from low, and cannot go up by its whole approach."""
    arm = kinematics_of(load_robot("aloha_agilex").arms["left"])
    release = frame_from_axes([-0.3, -0.1, TABLE_TOP + 0.06], [0, 0, -1], [-1, 0, 0])
    above, after = (Pose(release.p + [0, 0, up], release.q) for up in (0.03, 0.6))
    reached = reached_place(arm, PlaceWay(above, release, after, drop=0.0), arm.home)
    assert reached is not None
    assert reached[0].after == above
    assert len(reached[1]) == 3
    assert reached_place(arm, PlaceWay(after, release, after, drop=0.0), arm.home) is None


@pytest.mark.parametrize("raises", [(), SETTINGS.raises_m])
def test_an_object_with_a_height_limit_has_no_higher_paths(raises):
    arm, block = kinematics_of(robot().arms["left"]), thing("block", (-0.2, 0.0))
    around = Surroundings("table", Obstacles([]), (TABLE_TOP + 0.1,), raises)
    held = grasps_of(block)[0].in_object
    drops = {round(way.drop - SET_DOWN, 6) for way in around.ways(arm, held, 0.04, [block.pose], arm.home)}
    assert drops == {0.0, *raises}


@pytest.mark.parametrize(
    ("name", "drop_m"), [("dustbin", 0.105), ("tall_drawer_cabinet", 0.075), ("bowl", 0.075), ("plate", 0.075)]
)
def test_a_thing_may_fall_farther_between_the_walls_of_a_deep_receptacle(name, drop_m):
    assert largest_drop(thing(name), 0) == pytest.approx(drop_m, abs=0.002)


def test_a_place_at_the_very_end_of_an_arms_reach_is_not_enough():
    """A grip that turns out some millimetres otherwise would not get there."""
    arm, block = kinematics_of(robot().arms["left"]), thing("block", (-0.3, 0.0))
    held = grasps_of(block)[0].in_object
    ends = [Pose([x, 0.0, TABLE_TOP]) for x in np.arange(0.1, 0.6, 0.001)]
    planner = MotionPlanner(CollisionScene(robot(), "left", template().table, {}))
    carried = Held("block", block.asset.model, held.inverse())
    around = Surroundings("table", Obstacles([]), (TABLE_TOP + 0.03,), ())

    def enough(pose: Pose) -> bool:
        with contextlib.suppress(MotionFailed):
            around.check(planner, arm.home, carried, 0.04, [pose])
            return True
        return False

    last = next(pose for pose in reversed(ends) if enough(pose))
    assert last != ends[-1]
    assert arm.reachable(Pose(last.p + [0.99 * SETTINGS.slack_m, 0, SET_DOWN], last.q) * held)


def test_without_obstacles_an_object_is_set_down_gently():
    assert place_block(0, []).drop == SET_DOWN


def test_an_obstacle_beside_the_hand_costs_no_height():
    far = SolidBox(np.array([[-0.02, -0.02, 0.0], [0.02, 0.02, 0.2]]), Pose([0.5, 0.0, TABLE_TOP]))
    assert place_block(0, [far]).drop == SET_DOWN


def test_an_object_is_put_back_as_it_stood_or_turned_by_a_few_degrees():
    stood = Pose.from_yaw([0.1, -0.2, TABLE_TOP], 0.7)
    first, *turned = old_places(stood)
    assert first == stood
    assert all(np.allclose(pose.p, stood.p) for pose in turned)
    assert [round(float(np.degrees(pose.yaw - stood.yaw))) for pose in turned] == [2, -2, 5, -5]
