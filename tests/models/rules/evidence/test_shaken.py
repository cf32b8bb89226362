"""The critic on what one arm lifts, holds up and shakes, from rendered pictures of the arm that holds it."""

from __future__ import annotations

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
    """A bottle in the left hand of a robot, and pictures of it.

    Args:
        carried: False where the bottle stands below the hand instead.
        plumb: True where the bottle hangs upright, however the hand leans.
    """

    def __init__(self, carried: bool = True, plumb: bool = False):
        self.carried, self.plumb = carried, plumb
        self.bottle = thing("bottle", (-0.2, -0.05), 0.3)
        self.scene = scene_of([self.bottle, thing("block", (0.25, 0.1))]).model_copy(update={"robot": WHO})
        models = {o.id: library().asset(o.asset, o.variant).model for o in self.scene.objects}
        self.world = World.of_scene(self.scene, models, load_robot(WHO), render=True)
        self.home = self.world.state()
        self.joints = next(self._ways())

    def _ways(self) -> Iterator[dict[float, np.ndarray]]:
        """Joints of the arm at each lean, for each way to hold the bottle."""
        arm = kinematics_of(load_robot(WHO).arms["left"])
        for contact in self.bottle.asset.annotation.carrying_points:
            for grasp in hand_poses(self.bottle, contact, arm.arm.gripper):
                reached = {lean: arm.ik(self._at(lean) * grasp.pose) for lean in (LEFT, UPRIGHT, RIGHT)}
                if all(joints is not None for joints in reached.values()):
                    yield reached

    def _at(self, lean: float) -> Pose:
        """Of what was grasped on the table: lifted, and turned about the middle of the bottle."""
        middle = Pose(self.bottle.aabb.mean(axis=0))
        turn = Pose(q=[np.cos(lean / 2), 0.0, np.sin(lean / 2), 0.0])
        return Pose([0.0, 0.0, UP_M]) * middle * turn * middle.inverse()

    def judged(self, relation: str, leans: Sequence[float], ends_up: bool = False) -> Verdict:
        """The verdict where the hand leans so at the moment, and later."""
        goal = Goal(subject=self.bottle.id, relation=relation)
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
        at = self._at(UPRIGHT if self.plumb else lean) * self.bottle.pose if self.carried else self.bottle.pose
        fingers = self.home.joints["left"].copy()
        fingers[: len(self.joints[lean])] = self.joints[lean]
        joints = {**self.home.joints, "left": fingers}
        return replace(self.home, objects={**self.home.objects, self.bottle.id: at}, joints=joints)


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
