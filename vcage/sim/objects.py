"""Objects in a SAPIEN scene, rigid or with moving parts, behind one interface."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from vcage.base.geometry import Pose
from vcage.sim.bodies import Body, build_links, build_rigid
from vcage.sim.joints import joint_positions
from vcage.sim.poses import from_sapien, to_sapien

if TYPE_CHECKING:
    import sapien

REST_SPEED, REST_SPIN = 0.005, 0.05
"""Below these a part counts as at rest: m/s, rad/s."""


class RigidObject:
    """An object without moving parts.

    Attributes:
        entities: SAPIEN entity of each part by name; the body's name is None.
    """

    def __init__(self, scene: sapien.Scene, name: str, body: Body, render: bool):
        import sapien

        entity = build_rigid(name, body.model, render)
        entity.pose = to_sapien(body.pose)
        scene.add_entity(entity)
        self.entities: dict[str | None, sapien.Entity] = {None: entity}
        self._physics = entity.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)

    @property
    def pose(self) -> Pose:
        """Object frame in the world."""
        return from_sapien(self.entities[None].pose)

    @property
    def joints(self) -> np.ndarray:
        """(0,) it has none."""
        return np.zeros(0)

    def set_pose(self, pose: Pose) -> None:
        """Put it somewhere; its velocity stays."""
        self.entities[None].set_pose(to_sapien(pose))

    def set_joints(self, joints: Sequence[float] | np.ndarray) -> None:
        """Accepts no positions only."""
        if len(joints):
            raise ValueError(f"expected 0 joint positions, got {len(joints)}")

    def stop(self) -> None:
        """Take away its velocity."""
        self._physics.set_linear_velocity(np.zeros(3))
        self._physics.set_angular_velocity(np.zeros(3))

    def at_rest(self) -> bool:
        """Whether it moves slower than :data:`REST_SPEED` and :data:`REST_SPIN`."""
        return _slow(self._physics)


class ArticulatedObject:
    """An object with moving parts; its body moves freely.

    Attributes:
        entities: SAPIEN entity of each part by name; the body's name is None.
    """

    def __init__(self, scene: sapien.Scene, name: str, body: Body, render: bool):
        import sapien

        self._model = body.model
        self.entities: dict[str | None, sapien.Entity] = build_links(name, body.model, render)
        kind = sapien.physx.PhysxArticulationLinkComponent
        self._links = {part: entity.find_component_by_type(kind) for part, entity in self.entities.items()}
        self._articulation = self._links[None].articulation
        for entity in self.entities.values():
            scene.add_entity(entity)
        # PhysX numbers the joints of an articulation in its own order.
        order = [joint.name for joint in self._articulation.active_joints]
        self._index = np.array([order.index(link.name) for link in body.model.links])
        self.set_pose(body.pose)
        self.set_joints(body.joints)

    @property
    def pose(self) -> Pose:
        """Frame of the body in the world."""
        return from_sapien(self.entities[None].pose)

    @property
    def joints(self) -> np.ndarray:
        """(n,) position of each of the model's links, metres or radians."""
        return self._articulation.get_qpos()[self._index].astype(np.float64)

    def set_pose(self, pose: Pose) -> None:
        """Put the body somewhere with all its parts; joints and velocities stay."""
        self._articulation.set_root_pose(to_sapien(pose))

    def set_joints(self, joints: Sequence[float] | np.ndarray) -> None:
        """Put the parts at (n,) joint positions; all at 0 when empty."""
        positions = np.zeros(len(self._index))
        positions[self._index] = joint_positions(self._model, joints)
        self._articulation.set_qpos(positions)

    def stop(self) -> None:
        """Take away all velocities."""
        self._articulation.set_root_linear_velocity(np.zeros(3))
        self._articulation.set_root_angular_velocity(np.zeros(3))
        self._articulation.set_qvel(np.zeros(len(self._index)))

    def at_rest(self) -> bool:
        """Whether every part moves slower than :data:`REST_SPEED` and :data:`REST_SPIN`."""
        return all(_slow(link) for link in self._links.values())


def add_object(scene: sapien.Scene, name: str, body: Body, render: bool) -> RigidObject | ArticulatedObject:
    """Put an object into a scene.

    Raises:
        DamagedFile: a mesh cannot be loaded.
    """
    kind = ArticulatedObject if body.model.links else RigidObject
    return kind(scene, name, body, render)


def _slow(body: sapien.physx.PhysxRigidBodyComponent) -> bool:
    slow = np.linalg.norm(body.linear_velocity) < REST_SPEED
    return bool(slow and np.linalg.norm(body.angular_velocity) < REST_SPIN)
