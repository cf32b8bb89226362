"""Where on the table an object is tried: at random, where the robot may be asked to use it."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose
from vcage.layout.items import Placement, TableItem, table_item
from vcage.layout.placement.place import place
from vcage.layout.placement.reach import GRASP_HEIGHTS, robot_reach
from vcage.objects.asset import Asset
from vcage.schema.asset import ContactPoint
from vcage.schema.robot import Robot
from vcage.schema.scene import SceneTemplate
from vcage.sim.kinematics import ArmKinematics, kinematics_of
from vcage.tasks.grasps import grasp_poses
from vcage.tasks.waypoints import APPROACH

LIFT = 0.15
"""How high an object is lifted, metres."""

DRAWS = 50
"""Places that are drawn until an arm reaches one."""

SIDEWAYS = 0.9
"""An approach that leads down by less than this share comes from the side (more than 26° off)."""

FACING = np.radians(30)
"""How far such an approach may turn from straight away from the robot, radians."""


class Places:
    """Random places on the table of a scene.

    Args:
        template: table, workspace.
        robot: whose arms must reach.
    """

    def __init__(self, template: SceneTemplate, robot: Robot):
        self.template = template
        self.robot = robot

    @cached_property
    def kinematics(self) -> dict[str, ArmKinematics]:
        """By arm."""
        return {name: kinematics_of(arm) for name, arm in self.robot.arms.items()}

    @cached_property
    def _reach(self) -> np.ndarray:
        heights = tuple(self.template.table.height + h for h in GRASP_HEIGHTS)
        return robot_reach(self.robot, self._workspace, heights)

    @property
    def _workspace(self) -> np.ndarray:
        return np.array([self.template.workspace.lower, self.template.workspace.upper])

    def for_carrying(self, asset: Asset, contact: ContactPoint, rng: np.random.Generator) -> Pose:
        """A pose on the table from which the asset may have to be picked up at a contact point.

        Any place and heading where the kinematics of an arm reach the grasp and the lifted object, as the search for
        sub-tasks asks for before anything is simulated; an approach from the side must come from where the robot
        stands.

        Raises:
            InfeasibleScene: no arm reaches the contact point anywhere.
        """
        for _ in range(DRAWS):
            pose = self._drawn(asset, contact, rng)
            if self._reached(pose, contact):
                return pose
        raise InfeasibleScene(f"no arm reaches contact point {contact.id} of {asset.name} in {DRAWS} places")

    def _reached(self, pose: Pose, contact: ContactPoint) -> bool:
        for arm in self.kinematics.values():
            for grasp in grasp_poses(pose, contact, arm.arm.gripper, pose.p[2]):
                before = grasp.pose * Pose([0.0, 0.0, -APPROACH])
                lifted = Pose(grasp.pose.p + [0.0, 0.0, LIFT], grasp.pose.q)
                if all(arm.reachable(p) for p in (grasp.pose, before, lifted)):
                    return True
        return False

    def _drawn(self, asset: Asset, contact: ContactPoint, rng: np.random.Generator) -> Pose:
        yaw = float(rng.uniform(-np.pi, np.pi))
        x, y, z = contact.approach
        if -z < SIDEWAYS:
            yaw = float(np.pi / 2 - np.arctan2(y, x) + rng.uniform(-FACING, FACING))
        straight = round(yaw / (np.pi / 2)) * np.pi / 2
        item = table_item(asset.name, asset, yaws=(yaw,), allowed=self._reach)
        spot = self._spot(item, (straight, straight + np.pi) if -z >= SIDEWAYS else (straight,), rng)
        return Pose.from_yaw([spot.x, spot.y, self.template.table.height], spot.yaw)

    def for_operating(self, asset: Asset, rng: np.random.Generator) -> Pose:
        """A pose on the table where the asset's moving parts have room and its front faces the robot."""
        item = table_item(asset.name, asset)
        yaw = float(rng.uniform(min(item.yaws), max(item.yaws)))
        spot = self._spot(replace(item, yaws=(yaw,)), (0.0,), rng)
        return item.pose(spot, self.template.table.height)

    def _spot(self, item: TableItem, straight: tuple[float, ...], rng: np.random.Generator) -> Placement:
        """A place at the item's heading, or at one of ``straight`` where it is too large for that."""
        try:
            return place([item], self._workspace, rng)[item.id]
        except InfeasibleScene:
            return place([replace(item, yaws=straight)], self._workspace, rng)[item.id]
