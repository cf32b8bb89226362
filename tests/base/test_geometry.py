"""Poses, boxes and cameras obey their definitions for any input."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vcage.base.geometry import (
    Camera,
    Pose,
    boxes_overlap,
    footprint_half_size,
    frame_from_axes,
    look_at,
    oriented_boxes_overlap,
    rotation_2d,
    world_aabb,
    wrap_angle,
)

coordinate = st.floats(-2, 2)
vector = st.tuples(coordinate, coordinate, coordinate)
quaternion = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1)
poses = st.builds(Pose, vector, quaternion)
angles = st.floats(-10, 10)


def top_camera(height: float = 1.9) -> Camera:
    return Camera(640, 480, 0.7, look_at([0, 0, height], [0, 0, 0], up=[0, 1, 0]))


@given(vector, quaternion)
def test_poses_of_the_same_numbers_are_equal_and_serve_as_one_key(p, q):
    assert Pose(p, q) == Pose(p, q)
    assert len({Pose(p, q), Pose(p, q)}) == 1


def test_poses_differ_by_position_by_rotation_and_from_other_types():
    assert Pose() != Pose([0, 0, 1e-12])
    assert Pose() != Pose.from_yaw([0, 0, 0], 1e-6)
    assert Pose() != (0, 0, 0)


@given(poses, vector)
def test_inverse_undoes_a_pose(pose, point):
    assert np.allclose(pose.inverse().apply(pose.apply(point)), point, atol=1e-9)


@given(poses, poses, vector)
def test_product_applies_the_right_pose_first(a, b, point):
    assert np.allclose((a * b).apply(point), a.apply(b.apply(point)), atol=1e-9)


@given(poses)
def test_matrix_round_trip_keeps_the_pose(pose):
    again = Pose.from_matrix(pose.matrix())
    assert np.allclose(again.matrix(), pose.matrix(), atol=1e-9)


def test_pose_refuses_a_zero_quaternion():
    with pytest.raises(ValueError, match="not a pose"):
        Pose(q=[0, 0, 0, 0])


@given(vector, angles)
def test_yaw_of_an_upright_pose_is_the_angle_it_was_made_from(p, yaw):
    assert np.isclose(wrap_angle(Pose.from_yaw(p, yaw).yaw - yaw), 0, atol=1e-9)


def test_frame_from_axes_points_z_along_the_approach():
    frame = frame_from_axes([0, 0, 0], z=[0, 0, -1], y=[0, 1, 0])
    assert np.allclose(frame.apply([0, 0, 1]), [0, 0, -1])
    assert np.allclose(frame.apply([0, 1, 0]), [0, 1, 0])


def test_frame_from_parallel_axes_is_refused():
    with pytest.raises(ValueError, match="span no frame"):
        frame_from_axes([0, 0, 0], z=[0, 0, 1], y=[0, 0, -1])


@given(poses)
def test_world_aabb_contains_every_corner(pose):
    bounds = np.array([[-0.1, -0.2, 0.0], [0.1, 0.2, 0.3]])
    lower, upper = world_aabb(bounds, pose)
    inside = pose.apply([[0.1, 0.2, 0.3], [-0.1, -0.2, 0.0], [0, 0, 0.1]])
    assert np.all(inside >= lower - 1e-9) and np.all(inside <= upper + 1e-9)


@given(angles, st.floats(0.01, 1), st.floats(0.01, 1))
def test_footprint_agrees_with_the_world_aabb_of_an_upright_box(yaw, width, depth):
    box = world_aabb([[-width / 2, -depth / 2, 0], [width / 2, depth / 2, 0.1]], Pose.from_yaw([0, 0, 0], yaw))
    assert np.allclose(footprint_half_size([width, depth], yaw), box[1, :2], atol=1e-9)


def test_touching_boxes_do_not_overlap():
    assert not boxes_overlap([[0, 0], [1, 1]], [[1, 0], [2, 1]])
    assert boxes_overlap([[0, 0], [1, 1]], [[1, 0], [2, 1]], margin=0.01)


@given(poses)
def test_a_box_overlaps_itself_at_any_pose(pose):
    bounds = [[-0.1, -0.2, 0.0], [0.1, 0.2, 0.3]]
    assert oriented_boxes_overlap(bounds, pose, bounds, pose)


def test_oriented_boxes_see_a_gap_that_their_aabbs_do_not():
    bounds = np.array([[-0.5, -0.02, 0], [0.5, 0.02, 0.1]])
    a, b = Pose.from_yaw([0, 0, 0], np.pi / 4), Pose.from_yaw([0.2, -0.2, 0], np.pi / 4)
    assert boxes_overlap(world_aabb(bounds, a), world_aabb(bounds, b))
    assert not oriented_boxes_overlap(bounds, a, bounds, b)


@given(st.floats(-0.3, 0.3), st.floats(-0.2, 0.2), st.floats(0, 1))
def test_unproject_inverts_project_at_the_same_height(x, y, z):
    camera = top_camera()
    assert np.allclose(camera.unproject(camera.project([x, y, z]), z), [x, y, z], atol=1e-9)


@given(angles)
def test_the_rotation_of_the_plane_is_that_of_a_turn_about_the_vertical(yaw):
    assert np.allclose(rotation_2d(yaw), Pose.from_yaw([0, 0, 0], yaw).rotation()[:2, :2])


def test_opencv_matrices_agree_with_project():
    camera, point = top_camera(), np.array([0.2, -0.1, 0.3])
    homogeneous = camera.intrinsics() @ (camera.extrinsics() @ np.append(point, 1))[:3]
    assert np.allclose(homogeneous[:2] / homogeneous[2], camera.project(point))


def test_a_point_behind_the_camera_has_no_pixel():
    assert np.isnan(top_camera(1.0).project([0, 0, 2.0])).all()


def test_a_ray_that_misses_the_plane_gives_nan():
    sideways = Camera(64, 48, 0.7, look_at([0, 0, 1], [1, 0, 1]))
    assert np.isnan(sideways.unproject([32.0, 10.0], 0.0)).any()
