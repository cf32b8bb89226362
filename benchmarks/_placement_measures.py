"""Measure a placed scene on the objects' own shapes, not on the rectangles of the placement."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from benchmarks._placement_scenes import BenchmarkScene
from benchmarks._shapes import ROUNDING, box_around, box_depths, pieces_collide
from vcage.base.geometry import Pose
from vcage.objects.asset import Asset
from vcage.schema.asset import ContactPoint, FunctionalPoint
from vcage.sim.bodies import Body
from vcage.sim.kinematics import ArmKinematics
from vcage.sim.world import PHYSICS_HZ, World
from vcage.tasks.grasps import grasp_poses

SECONDS = 2.0
"""Length of the simulation."""

LOST_MM = 20_000.0
"""Drift of what physics flings beyond all numbers: as far as it would have fallen, millimetres."""

HEADINGS = tuple(np.radians(degrees) for degrees in (0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0))
"""Of a gripper that comes down on a functional point, radians."""


# --- geometry ------------------------------------------------------------------------------------------


class TrueShapes:
    """The convex pieces of objects where they stand, all joints at 0.

    Args:
        assets: by id.
        poses: of the placed objects, by id.
    """

    def __init__(self, assets: Mapping[str, Asset], poses: Mapping[str, Pose]):
        self._pieces = {
            name: [pose.apply(piece.vertices) for piece in assets[name].pieces] for name, pose in poses.items()
        }
        self.boxes = {name: box_around(np.concatenate(pieces)) for name, pieces in self._pieces.items()}
        """(2, 3) axis-aligned box around the vertices of all pieces, by id."""

    def within(self, workspace: np.ndarray) -> int:
        """Number of objects in the workspace (2, 2), seen from above."""
        return sum(
            bool(np.all(box[0, :2] >= workspace[0] - ROUNDING) and np.all(box[1, :2] <= workspace[1] + ROUNDING))
            for box in self.boxes.values()
        )

    def meeting(self) -> list[tuple[str, str]]:
        """The pairs whose boxes overlap, the deepest first."""
        names = list(self.boxes)
        boxes = np.array([self.boxes[name] for name in names]).reshape(-1, 2, 3)
        depths = box_depths(boxes, boxes)
        pairs = np.argwhere(np.triu(depths > ROUNDING, k=1))
        return [(names[i], names[j]) for i, j in sorted(pairs.tolist(), key=lambda pair: -depths[pair[0], pair[1]])]

    def collide(self, a: str, b: str) -> bool:
        """True if two pieces of the objects penetrate by more than :data:`~benchmarks._shapes.TOUCHING`."""
        return pieces_collide(self._pieces[a], self._pieces[b])


# --- physics -------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Drift:
    """Motion of an object in :data:`SECONDS` of physics: of its origin, millimetres, and its turn, degrees."""

    mm: float
    degrees: float

    @property
    def stable(self) -> bool:
        """Less than 10 mm and 8°."""
        return self.mm <= 10.0 and self.degrees <= 8.0


def drifts(scene: BenchmarkScene, poses: Mapping[str, Pose]) -> list[Drift]:
    """Motion of every placed object when it is let go where it was put, on a table around the workspace."""
    bodies = {thing.id: Body(thing.asset.model, poses[thing.id]) for thing in scene.things if thing.id in poses}
    world = World(scene.table, bodies)
    world.step(round(SECONDS * PHYSICS_HZ))
    return [_drift(world, name, pose) for name, pose in poses.items()]


def _drift(world: World, name: str, before: Pose) -> Drift:
    try:
        after = world.object_pose(name)
    except ValueError:  # not finite: overlapping objects can be flung apart that hard
        return Drift(LOST_MM, 180.0)
    cosine = min(1.0, abs(float(before.q @ after.q)))
    return Drift(1000 * float(np.linalg.norm(after.p - before.p)), float(np.degrees(2 * np.arccos(cosine))))


# --- reach ---------------------------------------------------------------------------------------------


def reached_points(
    scene: BenchmarkScene, poses: Mapping[str, Pose], kinematics: Mapping[str, ArmKinematics]
) -> tuple[int, int]:
    """Number of the points that a robot needs and some arm reaches, and number of all.

    They are the contact points by which the placed contents are carried, and the functional points of the placed
    receptacles. What is in the way of the arm is not asked.
    """
    answers: list[bool] = []
    for thing in scene.things:
        if thing.id not in poses:
            continue
        pose, notes = poses[thing.id], thing.asset.annotation
        if thing.role == "content":
            answers += [_grasped(pose, point, kinematics.values(), scene.height) for point in notes.carrying_points]
        elif thing.role == "receptacle":
            answers += [_come_down_on(pose, point, kinematics.values()) for point in notes.functional_points]
    return sum(answers), len(answers)


def _grasped(pose: Pose, contact: ContactPoint, arms: Iterable[ArmKinematics], support: float) -> bool:
    """True if an arm reaches a grasp of the contact point and the pose before it."""
    return any(
        _follows(arm, [grasp.pose * Pose([0, 0, -arm.arm.gripper.approach]), grasp.pose])
        for arm in arms
        for grasp in grasp_poses(pose, contact, arm.arm.gripper, support)
    )


def _come_down_on(pose: Pose, point: FunctionalPoint, arms: Iterable[ArmKinematics]) -> bool:
    """True if an arm reaches straight down to above the functional point, at any heading."""
    place, down = pose.apply(point.position), Pose(q=[0, 1, 0, 0])
    return any(
        arm.reachable(Pose.from_yaw(place + [0, 0, arm.arm.gripper.approach], heading) * down)
        for arm in arms
        for heading in HEADINGS
    )


def _follows(arm: ArmKinematics, way: list[Pose]) -> bool:
    q = None
    for pose in way:
        q = arm.ik(pose, seed_q=q)
        if q is None:
            return False
    return True
