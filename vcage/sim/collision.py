"""What an arm would touch at given joints: its links and what it holds, against objects, table and other arms."""

from __future__ import annotations

import functools
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vcage.base.geometry import Pose
from vcage.schema.asset import PhysicalModel
from vcage.schema.robot import Robot
from vcage.schema.scene import Table
from vcage.sim.bodies import Body
from vcage.sim.joints import part_name, part_names
from vcage.sim.kinematics import ArmKinematics, kinematics_of
from vcage.sim.poses import to_sapien
from vcage.sim.shapes import ConvexShape, box_shape, model_shapes
from vcage.sim.surroundings import THICKNESS

if TYPE_CHECKING:
    import sapien
    from mplib.pymp.collision_detection import fcl

    from vcage.sim.world import World

TOLERANCE = 0.002
"""Overlap that still counts as touching, metres: objects rest on things, and fingers lie against what they hold."""


@dataclass(frozen=True)
class Held:
    """An object between the fingers.

    Args:
        object_id: which.
        model: its geometry.
        in_gripper: object frame in the gripper frame.
        joints: positions of its moving parts; all at 0 when empty.
    """

    object_id: str
    model: PhysicalModel
    in_gripper: Pose
    joints: tuple[float, ...] = ()


@dataclass(frozen=True)
class Contact:
    """Two things that would overlap."""

    moving: str
    other: str


class _Solids:
    """Shapes with poses, as FCL objects, and spheres around them for a quick first look."""

    def __init__(self, items: Iterable[tuple[str, ConvexShape, sapien.Pose]]):
        self.names: list[str] = []
        self.objects: list[fcl.CollisionObject] = []
        centres, radii = [], []
        for name, shape, pose in items:
            frame = pose * shape.local
            self.names.append(name)
            self.objects.append(shape.placed(frame))
            centres.append(frame.to_transformation_matrix() @ [*shape.centre, 1.0])
            radii.append(shape.radius)
        self.centres = np.array(centres).reshape(-1, 4)[:, :3]
        self.radii = np.array(radii)


class CollisionScene:
    """Everything around one arm.

    Args:
        robot: whose arm it is.
        arm: its name.
        table: a solid slab.
        bodies: objects by id; their parts are obstacles named ``<id>`` (the body) and ``<id>/<link>``.
        joints: where the other arms are, (n,) by name; at home where not given.
    """

    def __init__(
        self,
        robot: Robot,
        arm: str,
        table: Table,
        bodies: Mapping[str, Body],
        joints: Mapping[str, np.ndarray] | None = None,
    ):
        import sapien

        self.kinematics = kinematics_of(robot.arms[arm])
        self._to_base = to_sapien(robot.arms[arm].base.pose().inverse())
        slab = sapien.Pose([*table.centre, table.height - THICKNESS / 2])
        items = [("table", box_shape([*table.size, THICKNESS]), slab)]
        for name, body in bodies.items():
            pose, shapes = to_sapien(body.pose), model_shapes(body.model, body.joints)
            items += [(part_name(name, part), shape, pose * local) for part, shape, local in shapes]
        for other, record in robot.arms.items():
            if other != arm:
                items += _links_of(other, kinematics_of(record), (joints or {}).get(other))
        self._obstacles = _Solids((name, shape, self._to_base * pose) for name, shape, pose in items)

    @classmethod
    def of_world(cls, world: World, arm: str, changed: Mapping[str, Body] | None = None) -> CollisionScene:
        """The surroundings of an arm as they are in the world now.

        Args:
            world: with a robot.
            arm: its name.
            changed: objects, by id, that are planned around as they shall be.

        Raises:
            ValueError: the world has no robot.
        """
        if world.robot is None:
            raise ValueError("this world has no robot")
        bodies = {name: world.body(name) for name in world.object_ids} | dict(changed or {})
        others = {name: control.joints for name, control in world.arms.items() if name != arm}
        return cls(world.robot, arm, world.table, bodies, others)

    def first_contact(
        self,
        q: np.ndarray,
        opening: float = 1.0,
        held: Held | None = None,
        ignore: Collection[str] = (),
        fingers_may_touch: Collection[str] = (),
    ) -> Contact | None:
        """What would overlap by more than :data:`TOLERANCE` with the arm at ``q``, or None.

        Args:
            q: (n,) arm joints, rad.
            opening: of the gripper, 0 closed to 1 open.
            held: what the gripper holds.
            ignore: names of obstacles that may be touched: ``<id>`` for an object's body, ``<id>/<link>`` for a
                moving part, ``table``, or ``<arm>/<link>``.
            fingers_may_touch: names of obstacles that the fingers may touch, and no other link.
        """
        poses = self.kinematics.base_poses(q, opening)
        parts = [(link, shape, poses[link]) for link, shape in self.kinematics.link_shapes]
        ranks = self.kinematics.link_ranks
        if held is not None:
            pose = self.kinematics.base_pose_of_tool(q) * to_sapien(held.in_gripper)
            shapes = model_shapes(held.model, held.joints)
            carried = [(held.object_id, shape, pose * local) for _, shape, local in shapes]
            parts, ranks = parts + carried, np.append(ranks, np.full(len(carried), ranks.max()))
        moving = _Solids(parts)
        skip = {*ignore, *part_names(held.object_id, held.model)} if held else set(ignore)
        return self._with_obstacles(moving, ranks, skip, fingers_may_touch) or self._with_itself(moving, ranks)

    def _with_obstacles(
        self, moving: _Solids, ranks: np.ndarray, skip: Collection[str], fingers_may_touch: Collection[str]
    ) -> Contact | None:
        fingers = self.kinematics.finger_links
        near = _spheres_meet(moving, self._obstacles) & (ranks > 0)[:, None]  # the base never moves
        for i, j in np.argwhere(near):
            name = self._obstacles.names[j]
            if name in fingers_may_touch and moving.names[i] in fingers:
                continue
            if name not in skip and overlap(moving.objects[i], self._obstacles.objects[j]):
                return Contact(moving.names[i], name)
        return None

    def _with_itself(self, moving: _Solids, ranks: np.ndarray) -> Contact | None:
        apart = ranks[:, None] - ranks[None] >= self.kinematics.arm.self_collision_gap
        near = _spheres_meet(moving, moving) & apart
        for i, j in np.argwhere(near):
            if overlap(moving.objects[i], moving.objects[j]):
                return Contact(moving.names[i], moving.names[j])
        return None


def overlap(a: fcl.CollisionObject, b: fcl.CollisionObject) -> bool:
    """Whether two solids overlap by more than :data:`TOLERANCE`."""
    from mplib.pymp.collision_detection import fcl

    result = fcl.collide(a, b, _first_contact_only())
    return result.is_collision() and abs(result.get_contact(0).penetration_depth) > TOLERANCE


@functools.cache
def _first_contact_only() -> fcl.CollisionRequest:
    from mplib.pymp.collision_detection import fcl

    return fcl.CollisionRequest(num_max_contacts=1, enable_contact=True)


def _spheres_meet(a: _Solids, b: _Solids) -> np.ndarray:
    """(len(a), len(b)) whether the spheres around two shapes meet."""
    apart = np.linalg.norm(a.centres[:, None] - b.centres[None], axis=2)
    return apart < a.radii[:, None] + b.radii[None]


def _links_of(
    arm: str, kinematics: ArmKinematics, joints: np.ndarray | None
) -> list[tuple[str, ConvexShape, sapien.Pose]]:
    base = to_sapien(kinematics.arm.base.pose())
    poses = kinematics.base_poses(kinematics.home if joints is None else joints, 1.0)
    return [(f"{arm}/{link}", shape, base * poses[link]) for link, shape in kinematics.link_shapes]
