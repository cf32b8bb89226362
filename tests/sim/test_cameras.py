from __future__ import annotations

import numpy as np
import pytest

from vcage.base.geometry import Camera, look_at
from vcage.sim.cameras import observe, robot_cameras, shoot
from vcage.sim.world import World


@pytest.fixture
def shown(rendered, world):
    rendered.set_state(world.state())
    return rendered


def test_the_top_view_shows_every_object_where_the_camera_model_says(shown, template, bodies):
    camera = template.top_camera.camera()
    shot = observe(shown, camera)
    for name, body in bodies.items():
        middle = body.pose.apply((np.array(body.model.lower) + body.model.upper) / 2 * [0, 0, 1])
        u, v = camera.project(middle)
        assert shot.segmentation[int(v), int(u)] == shown.segmentation_ids[name]


def test_an_oblique_camera_agrees_with_the_camera_model(shown, bodies):
    camera = Camera(320, 240, 0.9, look_at([0.5, -0.6, 1.4], [0, 0, 0.74]))
    ids = observe(shown, camera).segmentation
    v, u = np.nonzero(ids == shown.segmentation_ids["cube"])
    corners = camera.project(
        bodies["cube"].pose.apply([[x, y, z] for x in (-0.02, 0.02) for y in (-0.02, 0.02) for z in (0, 0.04)])
    )
    assert abs(u.min() - corners[:, 0].min()) < 1.5 and abs(u.max() + 1 - corners[:, 0].max()) < 1.5
    assert abs(v.min() - corners[:, 1].min()) < 1.5 and abs(v.max() + 1 - corners[:, 1].max()) < 1.5


def test_segmentation_holds_the_objects_and_nothing_else(shown, template):
    ids = observe(shown, template.top_camera).segmentation
    assert ids.dtype == np.int32
    assert set(np.unique(ids)) == {0, *shown.segmentation_ids.values()}


def test_depth_is_the_distance_along_the_optical_axis(shown, template):
    camera = template.top_camera.camera()
    depth = observe(shown, camera).depth
    u, v = camera.project([0.4, 0.0, template.table.height]).astype(int)
    assert depth[v, u] == pytest.approx(camera.pose.p[2] - template.table.height, abs=1e-3)


def test_pictures_are_rgb_bright_and_not_burnt(shown, template):
    picture = shoot(shown, template.top_camera)
    assert picture.shape == (480, 640, 3) and picture.dtype == np.uint8
    assert 60 < picture.mean() < 200
    assert (picture == 255).mean() < 0.01
    cube = picture[observe(shown, template.top_camera).segmentation == shown.segmentation_ids["cube"]].mean(axis=0)
    assert cube[0] > 2 * cube[1] and cube[0] > 2 * cube[2]


def test_the_same_state_gives_the_same_picture(shown, template):
    assert np.array_equal(shoot(shown, template.top_camera), shoot(shown, template.top_camera))


def test_wrist_cameras_move_with_their_arm(world):
    before = robot_cameras(world)
    arm = world.arms["right"]
    arm.command_joints(arm.joints + 0.2 * np.eye(7)[0])
    world.step(150)
    after = robot_cameras(world)
    assert np.linalg.norm(after["cam_right_wrist"].pose.p - before["cam_right_wrist"].pose.p) > 0.02
    assert np.allclose(after["cam_left_wrist"].pose.p, before["cam_left_wrist"].pose.p, atol=1e-4)
    assert np.array_equal(after["cam_high"].pose.p, before["cam_high"].pose.p)


def test_wrist_cameras_see_the_finger_tips(world):
    for side, arm in world.arms.items():
        camera = robot_cameras(world)[f"cam_{side}_wrist"]
        u, v = camera.project(arm.tool_pose.p)
        assert 0 < u < camera.width and 0 < v < camera.height


def test_a_world_without_rendering_says_so_when_asked_for_a_picture(template):
    with pytest.raises(ValueError, match="render=True"):
        shoot(World(template.table, {}), template.top_camera)
