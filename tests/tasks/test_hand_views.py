"""Views of a camera on a hand that presses or holds something."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import thing
from vcage.sim.robots import load_robot
from vcage.tasks.hand_views import finger_views, grasp_views, press_views

BELL = thing("service_bell", (-0.2, -0.05), 0.3)


@pytest.mark.parametrize("who", ["aloha_agilex", "dual_panda"])
def test_a_camera_on_the_hand_sees_the_button_between_the_finger_tips(who: str) -> None:
    button = BELL.pose.apply(BELL.asset.annotation.contact_point(0).position)
    views = list(press_views(BELL, "button", load_robot(who), "cam_left_wrist"))
    assert views
    for view in views:
        nearest = view.fingers[np.argsort(np.linalg.norm(view.fingers - button, axis=1))[:8]]
        assert np.linalg.norm(nearest.mean(axis=0) - button) < 0.01
        u, v = view.camera.project(button)
        assert 0 < u < view.camera.width and 0 < v < view.camera.height


@pytest.mark.parametrize(("part", "camera"), [("button", "cam_high"), ("dome", "cam_left_wrist")])
def test_no_view_is_told_of_a_camera_beside_the_hands_or_of_what_is_not_pressed(part: str, camera: str) -> None:
    assert not list(press_views(BELL, part, load_robot("aloha_agilex"), camera))


@pytest.mark.parametrize("who", ["aloha_agilex", "dual_panda"])
def test_a_camera_on_the_hand_sees_what_is_held_between_the_fingers(who: str) -> None:
    mug = thing("mug", (-0.2, -0.05), 0.3)
    held = [mug.pose.apply(contact.position) for contact in mug.asset.annotation.carrying_points]
    views = list(grasp_views(mug, load_robot(who), "cam_left_wrist"))
    assert len(views) > len(held)
    for view in views:
        assert min(np.linalg.norm(view.gripper.p - at) for at in held) < 0.03
        fingers = np.split(view.fingers, 2)
        between = (fingers[0].mean(axis=0) + fingers[1].mean(axis=0)) / 2
        along = (between - view.gripper.p) @ view.gripper.rotation()
        assert np.allclose(along[:2], 0.0, atol=1e-6), "the gripper frame is not between the fingers"


def test_each_of_two_hands_holds_an_object_away_from_its_middle() -> None:
    pin = thing("rolling_pin", (0.0, 0.0), 0.3)
    robot = load_robot("aloha_agilex")

    def nearest(with_both: bool) -> float:
        views = grasp_views(pin, robot, "cam_left_wrist", with_both)
        return min(abs(float((pin.pose.inverse() * view.gripper).p[0])) for view in views)

    assert nearest(with_both=False) < 0.02 < 0.03 < nearest(with_both=True)


def test_no_fingers_are_drawn_for_a_camera_beside_the_hands() -> None:
    assert finger_views(load_robot("aloha_agilex"), "cam_high") == ()


def test_nothing_is_held_before_a_camera_beside_the_hands() -> None:
    assert not list(grasp_views(BELL, load_robot("aloha_agilex"), "cam_high"))
