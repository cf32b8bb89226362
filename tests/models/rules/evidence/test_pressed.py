"""The critic on presses: from above, and as the camera on the pressing hand sees them."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from tests.example_scenes import library, scene_of, thing
from vcage.base.geometry import Pose
from vcage.episodes.question import TOP, Asking, verdict
from vcage.models.rules.evidence.pressed import PressEvidence
from vcage.runs.context import StageContext
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.sim.cameras import robot_cameras, shoot
from vcage.sim.joints import joint_positions
from vcage.sim.kinematics import kinematics_of
from vcage.sim.robots import load_robot
from vcage.sim.world import World
from vcage.tasks.primitives.handles import Handle, operating_ways
from vcage.tasks.scene_objects import SceneObject

CONTEXT = StageContext("offline")


def pressed(subject: SceneObject, who: str, away: tuple[float, float] = (0.0, 0.0), blind: bool = False) -> Verdict:
    """The verdict on a press by the left arm of a robot.

    Args:
        subject: whose button is pressed, where it stood when the arm came.
        who: name of the robot.
        away: by which it stands elsewhere in all pictures, metres.
        blind: True where the camera on the hand sees nothing.
    """
    scene = scene_of([subject, thing("block", (0.25, 0.1))]).model_copy(update={"robot": who})
    models = {o.id: library().asset(o.asset, o.variant).model for o in scene.objects}
    world = World.of_scene(scene, models, load_robot(who), render=True)
    home, pressing = world.state(), world.state()
    joints = _pressing_joints(subject, who)
    pressing.joints["left"][:] = 0.0  # the fingers are closed
    pressing.joints["left"][: len(joints)] = joints
    stands = {**home.objects, subject.id: Pose(subject.pose.p + [*away, 0.0], subject.pose.q)}
    seen = {}
    for when, state in {"before": home, "moment": pressing, "after": home}.items():
        world.set_state(replace(state, objects=stands))
        seen[when] = {TOP: shoot(world, scene.top_camera)}
    world.set_state(replace(pressing, objects=stands))
    seen["moment"]["cam_left_wrist"] = shoot(world, robot_cameras(world)["cam_left_wrist"])
    if blind:
        seen["moment"]["cam_left_wrist"] = np.full_like(seen["moment"]["cam_left_wrist"], 20)
    world.set_state(replace(home, objects={name: Pose([0, 0, -9]) for name in stands}))
    goal = Goal(subject=subject.id, relation="pressed", part="button")
    return verdict(CONTEXT, scene, Asking("x", [goal], seen, shoot(world, scene.top_camera)))


def _pressing_joints(subject: SceneObject, who: str) -> np.ndarray:
    """(n,) joints of the left arm while its fingers push a button in."""
    model = subject.asset.model
    contact = next(c for c in subject.asset.annotation.contact_points if c.use == "press")
    handle = Handle(contact, model, subject.pose, joint_positions(model, ()), 0.0)
    arm = kinematics_of(load_robot(who).arms["left"])
    ways = operating_ways(handle, handle.link.joint.far_end, arm.arm.gripper, subject.box.bottom)
    return next(q for way in ways if (q := arm.ik(way.motion[way.pushed - 1])) is not None)


@pytest.mark.parametrize(
    ("touched", "around", "beside", "accepted", "why"),
    [
        (0.9, 0.9, np.inf, True, "90 % of the button of the bell is under the hand"),
        (0.9, 0.9, 1.3, True, "90 % of the button of the bell is under the hand"),
        (0.9, 0.9, 0.7, False, "the camera on the hand sees it beside the finger tips"),
        (0.1, 0.7, 0.7, False, "the camera on the hand sees it beside the finger tips"),
        (0.1, 0.1, np.inf, False, "10 % of the button of the bell is under the hand"),
    ],
)
def test_a_button_must_be_under_the_hand_and_not_beside_its_tips(
    touched: float, around: float, beside: float, accepted: bool, why: str
) -> None:
    goal = Goal(subject="bell", relation="pressed", part="button")
    told = PressEvidence(touched, around, beside, np.ones((1, 1), bool)).verdict(goal, "bell")
    assert told.accepted is accepted and why in told.reason


@pytest.mark.slow
@pytest.mark.parametrize("who", ["aloha_agilex", "dual_panda"])
@pytest.mark.parametrize("name", ["service_bell", "switch", "stapler_electric", "alarm_clock"])
def test_a_button_at_the_finger_tips_counts_as_pressed(who: str, name: str) -> None:
    told = pressed(thing(name, (-0.2, -0.05), 0.4), who)
    assert told.accepted, told.reason


@pytest.mark.slow
@pytest.mark.parametrize("away", [(0.0, 0.045), (0.05, 0.0), (-0.05, 0.02)])
@pytest.mark.parametrize("name", ["service_bell", "alarm_clock"])
def test_a_button_beside_the_finger_tips_does_not_count_as_pressed(name: str, away: tuple[float, float]) -> None:
    told = pressed(thing(name, (-0.2, -0.05), 0.4), "aloha_agilex", away)
    assert not told.accepted, told.reason


@pytest.mark.slow
def test_the_camera_on_the_hand_tells_where_the_hand_hides_the_button_from_above() -> None:
    bell, away = thing("service_bell", (-0.2, -0.05)), (0.0, -0.05)
    told = pressed(bell, "aloha_agilex", away)
    assert not told.accepted and "beside the finger tips" in told.reason


@pytest.mark.slow
def test_a_camera_that_sees_nothing_refuses_no_press() -> None:
    told = pressed(thing("service_bell", (-0.2, -0.05)), "aloha_agilex", blind=True)
    assert told.accepted, told.reason


def covered(subject: SceneObject, radius_px: int, beside_px: int = 0, colour: int | None = None) -> Verdict:
    """The verdict where a disc hides a button, or what is beside it, from above.

    Args:
        subject: whose button it is.
        radius_px, beside_px: of the disc, and of its middle from that of the button, to the right.
        colour: grey value of the disc; the button's own colour where it is not given.
    """
    scene = scene_of([subject])
    world = CONTEXT.drawn_world(scene)
    seen = shoot(world, scene.top_camera)
    world.set_object_pose(subject.id, Pose([0, 0, -9]))
    button = subject.pose.apply(next(c for c in subject.asset.annotation.contact_points if c.use == "press").position)
    u, v = np.round(scene.top_camera.camera().project(button[None])[0]).astype(int).tolist()
    moment = seen.copy()
    cv2.circle(moment, (u + beside_px, v), radius_px, seen[v, u].tolist() if colour is None else [colour] * 3, -1)
    goal = Goal(subject=subject.id, relation="pressed", part="button")
    pictures = {"before": {TOP: seen}, "after": {TOP: seen}, "moment": {TOP: moment}}
    return verdict(CONTEXT, scene, Asking("x", [goal], pictures, shoot(world, scene.top_camera)))


@pytest.mark.slow
@pytest.mark.parametrize(("beside_px", "accepted"), [(0, True), (34, False)])
def test_a_hand_that_has_the_colour_of_a_button_hides_what_is_around_it(beside_px: int, accepted: bool) -> None:
    told = covered(thing("switch", (-0.05, 0.05), 0.2, variant="white"), 20, beside_px)
    assert told.accepted == accepted, told.reason


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "variant"), [("stapler_electric", "white"), ("switch", "black"), ("service_bell", "red")]
)
def test_fingers_in_the_middle_of_a_button_are_on_it(name: str, variant: str) -> None:
    told = covered(thing(name, (0.0, 0.03), variant=variant), 6, colour=90)
    assert told.accepted, told.reason
