"""Trials of the checks by use: a single object before the robot, at random places within its reach."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from vcage.base.errors import InfeasibleScene
from vcage.base.geometry import Pose
from vcage.layout.items import Placement, TableItem, table_item
from vcage.layout.placement.place import place
from vcage.layout.placement.reach import robot_reach
from vcage.layout.placement.reach_map import SETTINGS as REACH
from vcage.objects.asset import Asset
from vcage.schema.asset import ContactPoint
from vcage.schema.base import PoseRecord, box_record
from vcage.schema.proof import CheckName, ProofCheck
from vcage.schema.robot import Robot
from vcage.schema.scene import ObjectRecord, Role, SceneTemplate
from vcage.sim.bodies import Body
from vcage.sim.kinematics import ArmKinematics, kinematics_of
from vcage.sim.world import World
from vcage.tasks.grasps import grasp_poses
from vcage.tasks.scene_objects import SceneObject

OBJECT = "object"
"""Id of the object that is tried."""


@dataclass(frozen=True)
class TrialSettings:
    """Settings of the tries.

    Args:
        max_failures: of the tries: nine of ten must succeed.
        lift_m: height to which an object is lifted.
        max_draws: places that are drawn until an arm reaches one.
        min_down_share: of an approach from above; one that leads down by less comes from the side (more than
            26° off).
        max_facing_rad: turn of an approach from the side away from straight ahead of the robot.
    """

    max_failures: int = 1
    lift_m: float = 0.15
    max_draws: int = 50
    min_down_share: float = 0.9
    max_facing_rad: float = np.radians(30)


SETTINGS = TrialSettings()


class TrialPlaces:
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
        heights = tuple(self.template.table.height + h for h in REACH.grasp_heights_m)
        return robot_reach(self.robot, self._workspace, heights)

    @property
    def _workspace(self) -> np.ndarray:
        return np.array([self.template.workspace.lower, self.template.workspace.upper])

    def for_carrying(self, asset: Asset, contact: ContactPoint, rng: np.random.Generator) -> Pose:
        """Draw a pose on the table from which an arm could pick the asset up at a contact point.

        Any place and heading where the kinematics of an arm reach the grasp and the lifted object, as the search for
        sub-tasks asks for before anything is simulated; an approach from the side must come from where the robot
        stands.

        Args:
            asset: the tested asset.
            contact: by which it is picked up.
            rng: of place and heading.

        Raises:
            InfeasibleScene: no arm reaches the contact point anywhere.
        """
        for _ in range(SETTINGS.max_draws):
            pose = self._random_pose(asset, contact, rng)
            if self._reached(pose, contact):
                return pose
        places = f"{SETTINGS.max_draws} places"
        raise InfeasibleScene(f"no arm reaches contact point {contact.id} of {asset.name} in {places}")

    def _reached(self, pose: Pose, contact: ContactPoint) -> bool:
        for arm in self.kinematics.values():
            for grasp in grasp_poses(pose, contact, arm.arm.gripper, pose.p[2]):
                before = grasp.pose * Pose([0.0, 0.0, -arm.arm.gripper.approach])
                lifted = Pose(grasp.pose.p + [0.0, 0.0, SETTINGS.lift_m], grasp.pose.q)
                if all(arm.reachable(p) for p in (grasp.pose, before, lifted)):
                    return True
        return False

    def _random_pose(self, asset: Asset, contact: ContactPoint, rng: np.random.Generator) -> Pose:
        yaw = float(rng.uniform(-np.pi, np.pi))
        x, y, z = contact.approach
        if -z < SETTINGS.min_down_share:
            yaw = float(np.pi / 2 - np.arctan2(y, x) + rng.uniform(-SETTINGS.max_facing_rad, SETTINGS.max_facing_rad))
        straight = round(yaw / (np.pi / 2)) * np.pi / 2
        item = replace(table_item(asset.name, asset), yaws=(yaw,), allowed=self._reach)
        at = self._placed(item, (straight, straight + np.pi) if -z >= SETTINGS.min_down_share else (straight,), rng)
        return Pose.from_yaw([at.x, at.y, self.template.table.height], at.yaw)

    def for_operating(self, asset: Asset, rng: np.random.Generator) -> Pose:
        """Draw a pose on the table with room for the asset's moving parts and its front towards the robot."""
        item = table_item(asset.name, asset)
        yaw = float(rng.uniform(min(item.yaws), max(item.yaws)))
        at = self._placed(replace(item, yaws=(yaw,)), (0.0,), rng)
        return item.pose(at, self.template.table.height)

    def _placed(self, item: TableItem, straight: tuple[float, ...], rng: np.random.Generator) -> Placement:
        """A place at the item's heading, or at one of ``straight`` where it is too large for that."""
        try:
            return place([item], self._workspace, rng)[item.id]
        except InfeasibleScene:
            return place([replace(item, yaws=straight)], self._workspace, rng)[item.id]


def scene_object(asset: Asset, pose: Pose, object_id: str = OBJECT, role: Role = "content") -> SceneObject:
    """Make the planner's object of an asset.

    Args:
        asset: the asset.
        pose: object frame in the world.
        object_id: its name.
        role: in the scene.
    """
    record = ObjectRecord(
        id=object_id,
        asset=asset.name,
        variant=asset.variant.id,
        phrase=asset.annotation.words.name,
        role=role,
        pose=PoseRecord.of(pose),
        aabb=box_record(asset.bounds, pose),
    )
    return SceneObject(record, asset, pose)


def world_with(asset: Asset, pose: Pose, places: TrialPlaces) -> World:
    """Make a world of table, robot and asset, for physics only.

    Args:
        asset: the asset.
        pose: object frame in the world.
        places: table and robot.
    """
    return World(places.template.table, {OBJECT: Body(asset.model, pose)}, places.robot)


def tried(
    check: CheckName, subject: str, tries: int, trial: Callable[[int], str | None], measured: dict[str, float]
) -> ProofCheck:
    """Try one point or joint.

    Args:
        check: its name.
        subject: the point or joint.
        tries: how often.
        trial: takes the number of a try; returns None for a success, or the reason of its failure.
        measured: other measurements.
    """
    failures = []
    for number in range(tries):
        try:
            reason = trial(number)
        except InfeasibleScene as error:
            reason = error.message
        failures += [] if reason is None else [reason]
    succeeded = tries - len(failures)
    return ProofCheck(
        check=check,
        subject=subject,
        passed=succeeded >= max(1, tries - SETTINGS.max_failures),
        tries=tries,
        succeeded=succeeded,
        measured=measured,
        reasons=list(dict.fromkeys(failures)),
    )
