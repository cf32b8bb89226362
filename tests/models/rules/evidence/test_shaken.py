"""The critic on what one arm lifts, holds up and shakes, from rendered pictures of the arm that holds it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest

from tests.example_scenes import library, scene_of, thing
from vcage.base.geometry import Pose
from vcage.episodes.question import Asking, cameras, verdict
from vcage.runs.context import StageContext
from vcage.schema.episodes import Verdict
from vcage.schema.goals import Goal
from vcage.sim.cameras import robot_cameras, shoot
from vcage.sim.kinematics import kinematics_of
from vcage.sim.robots import load_robot
from vcage.sim.state import WorldState
from vcage.sim.world import World
from vcage.tasks.hand_poses import hand_poses

CONTEXT = StageContext("offline")
WHO = "aloha_agilex"
UP_M = 0.15

LEFT, UPRIGHT, RIGHT = np.radians([25.0, 0.0, -25.0]).tolist()
"""Leans of a hand, as the robot sees them."""


class Holding:
    """A thing in the left hand of a robot, and pictures of it.

    Args:
        carried: False where it stands below the open hand instead.
        plumb: True where it hangs upright, however the hand leans.
        closed: True where the fingers touch.
        name, at: of what is held, and where it stood on the table, metres.
        up_m: how far it is lifted, metres.
    """

    def __init__(
        self,
        carried: bool = True,
        plumb: bool = False,
        closed: bool = False,
        name: str = "bottle",
        at: tuple[float, float] = (-0.2, -0.05),
        up_m: float = UP_M,
    ):
        self.carried, self.plumb, self.closed, self.up_m = carried, plumb, closed, up_m
        self.held, other = thing(name, at, 0.3), thing("block" if name == "bottle" else "bottle", (0.25, 0.1))
        self.scene = scene_of([self.held, other]).model_copy(update={"robot": WHO})
        models = {o.id: library().asset(o.asset, o.variant).model for o in self.scene.objects}
        self.world = World.of_scene(self.scene, models, load_robot(WHO), render=True)
        self.home = self.world.state()
        self.width, self.joints = next(self._ways())

    def _ways(self) -> Iterator[tuple[float, dict[float, np.ndarray]]]:
        """Distance of the fingers, metres, and joints of the arm at each lean, for each way to hold the thing."""
        arm = kinematics_of(load_robot(WHO).arms["left"])
        for contact in self.held.asset.annotation.carrying_points:
            for grasp in hand_poses(self.held, contact, arm.arm.gripper):
                reached = {lean: arm.ik(self._at(lean) * grasp.pose) for lean in (LEFT, UPRIGHT, RIGHT)}
                if all(joints is not None for joints in reached.values()):
                    yield self.held.asset.grasp_width(contact), reached

    def _at(self, lean: float) -> Pose:
        """Of what was grasped on the table: lifted, and turned about the middle of it."""
        middle = Pose(self.held.aabb.mean(axis=0))
        turn = Pose(q=[np.cos(lean / 2), 0.0, np.sin(lean / 2), 0.0])
        return Pose([0.0, 0.0, self.up_m]) * middle * turn * middle.inverse()

    def judged(self, relation: str, leans: Sequence[float], ends_up: bool = False) -> Verdict:
        """The verdict where the hand leans so at the moment, and later."""
        goal = Goal(subject=self.held.id, relation=relation)
        states = dict(zip(("moment", "later"), map(self._holding, leans), strict=False))
        states |= {"before": self.home, "after": states["moment"] if ends_up else self.home}
        seen = {}
        for when, state in states.items():
            self.world.set_state(state)
            taken_by = cameras(self.scene, [goal])
            seen[when] = {name: shoot(self.world, camera) for name, camera in taken_by.items()}
            seen[when]["cam_left_wrist"] = shoot(self.world, robot_cameras(self.world)["cam_left_wrist"])
        self.world.set_state(replace(self.home, objects={name: Pose([0, 0, -9]) for name in self.home.objects}))
        return verdict(CONTEXT, self.scene, Asking("x", [goal], seen, shoot(self.world, self.scene.top_camera)))

    def _holding(self, lean: float) -> WorldState:
        at = self._at(UPRIGHT if self.plumb else lean) * self.held.pose if self.carried else self.held.pose
        gripper = load_robot(WHO).arms["left"].gripper
        opening = 0.0 if self.closed else self.width / gripper.max_width if self.carried else 1.0
        arm = self.home.joints["left"].copy()
        arm[: len(self.joints[lean])] = self.joints[lean]
        arm[len(self.joints[lean]) :] = gripper.closed + opening * (gripper.open - gripper.closed)
        joints = {**self.home.joints, "left": arm}
        return replace(self.home, objects={**self.home.objects, self.held.id: at}, joints=joints)


@pytest.mark.slow
@pytest.mark.parametrize(("relation", "ends_up"), [("lifted", False), ("held_up", True)])
def test_what_the_hand_holds_in_the_air_is_lifted_or_held_up(relation: str, ends_up: bool) -> None:
    told = Holding().judged(relation, [UPRIGHT], ends_up)
    assert told.accepted and "the camera on the hand sees it between the fingers" in told.reason, told.reason


@pytest.mark.slow
@pytest.mark.parametrize(("relation", "ends_up"), [("lifted", False), ("held_up", True)])
def test_what_stands_below_the_hand_is_neither(relation: str, ends_up: bool) -> None:
    told = Holding(carried=False).judged(relation, [UPRIGHT], ends_up)
    assert not told.accepted, told.reason


@pytest.mark.slow
@pytest.mark.parametrize(("relation", "ends_up"), [("lifted", False), ("held_up", True)])
@pytest.mark.parametrize(
    ("name", "at"), [("bottle", (-0.2, -0.05)), ("block", (-0.2, -0.05)), ("block", (-0.53, 0.17))]
)
def test_what_the_hand_grips_and_does_not_lift_is_neither(
    relation: str, ends_up: bool, name: str, at: tuple[float, float]
) -> None:
    told = Holding(name=name, at=at, up_m=0.0).judged(relation, [UPRIGHT], ends_up)
    assert not told.accepted and re.search("stands where it was|% of the .* is seen", told.reason), told.reason


@pytest.mark.slow
@pytest.mark.parametrize("relation", ["lifted", "shaken"])
def test_a_hand_whose_fingers_touch_holds_nothing(relation: str) -> None:
    told = Holding(carried=False, closed=True).judged(relation, [LEFT, RIGHT])
    assert not told.accepted and "the fingers have closed on nothing" in told.reason, told.reason


@pytest.mark.slow
@pytest.mark.parametrize(
    ("carried", "words"),
    [(True, "sees the .* between the fingers, and its place is empty"), (False, "does not see the red block")],
)
def test_the_hand_alone_tells_of_what_is_held_beside_the_picture_of_the_customer(carried: bool, words: str) -> None:
    told = Holding(carried, name="block", at=(-0.53, 0.17)).judged("held_up", [UPRIGHT], ends_up=True)
    assert told.accepted is carried and re.search(words, told.reason), told.reason


@pytest.mark.slow
def test_what_leans_to_one_side_and_then_to_the_other_was_shaken() -> None:
    told = Holding().judged("shaken", [LEFT, RIGHT])
    assert told.accepted and "the arm swung" in told.reason, told.reason


@pytest.mark.slow
@pytest.mark.parametrize("leans", [(UPRIGHT, UPRIGHT), (LEFT, LEFT)])
def test_what_does_not_swing_was_not_shaken(leans: tuple[float, float]) -> None:
    told = Holding().judged("shaken", leans)
    assert not told.accepted and "has not swung" in told.reason, told.reason


@pytest.mark.slow
def test_what_hangs_upright_in_a_hand_that_leans_was_not_shaken() -> None:
    told = Holding(plumb=True).judged("shaken", [LEFT, RIGHT])
    assert not told.accepted, told.reason
