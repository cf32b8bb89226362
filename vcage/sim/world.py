"""A SAPIEN scene made from records: the table, objects, and a robot's arms."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from vcage.errors import UnknownName
from vcage.geometry import Pose
from vcage.schema.asset import PhysicalModel
from vcage.schema.robot import Robot
from vcage.schema.scene import Scene, Table
from vcage.sim.appearance import Appearance
from vcage.sim.arms import ArmControl, build_arm
from vcage.sim.bodies import Body, build_body
from vcage.sim.poses import from_sapien, to_sapien
from vcage.sim.render import new_render_system
from vcage.sim.state import SettleReport, WorldState, pack_arrays, unpack_arrays
from vcage.sim.surroundings import add_surroundings, add_table

PHYSICS_HZ = 250
"""Physics steps per second."""

REST_SPEED, REST_SPIN = 0.005, 0.05
"""Below these an object counts as at rest: m/s, rad/s."""

REST_STEPS = 10
"""For so many steps in a row, so that the top of a bounce does not count."""


class World:
    """A table with objects and, if given, a robot.

    The same arguments and the same commands give bit-identical states.

    Args:
        table: where everything stands.
        bodies: objects by id; their order fixes :attr:`segmentation_ids`.
        robot: its arms stand at home, grippers open.
        appearance: of a rendered world.
        render: whether pictures can be taken; without, no rendering device is needed.

    Raises:
        NoRenderer: ``render`` and nothing here can draw.
        DamagedFile: a mesh cannot be loaded.
    """

    def __init__(
        self,
        table: Table,
        bodies: Mapping[str, Body],
        robot: Robot | None = None,
        appearance: Appearance | None = None,
        render: bool = False,
    ):
        systems = [new_render_system()] if render else []
        import sapien

        self.table = table
        self.bodies = dict(bodies)
        self.robot = robot
        self.rendered = render
        self.steps = 0
        self.before_step: list[Callable[[World], None]] = []
        self._cameras: dict[tuple[int, int, float, float, float], object] = {}
        self.scene = sapien.Scene([sapien.physx.PhysxCpuSystem(), *systems])
        self.scene.set_timestep(1 / PHYSICS_HZ)
        add_table(self.scene, table)
        self._entities = {name: build_body(name, body, render) for name, body in bodies.items()}
        for entity in self._entities.values():
            self.scene.add_entity(entity)
        arms = robot.arms if robot else {}
        faces = robot.visual_faces if robot and render else None
        self.arms = {
            name: ArmControl(name, arm, build_arm(self.scene, arm, faces), self.step) for name, arm in arms.items()
        }
        if render:
            add_surroundings(self.scene, table, robot, appearance or Appearance())

    @classmethod
    def of_scene(
        cls,
        scene: Scene,
        models: Mapping[str, PhysicalModel],
        robot: Robot | None = None,
        appearance: Appearance | None = None,
        render: bool = False,
    ) -> World:
        """The world that a scene record describes; ``models`` by object id."""
        bodies = {o.id: Body(models[o.id], o.pose.pose()) for o in scene.objects}
        return cls(scene.table, bodies, robot, appearance, render)

    # --- objects ---

    @property
    def object_ids(self) -> list[str]:
        """Ids of the objects, in the order given."""
        return list(self._entities)

    @property
    def segmentation_ids(self) -> dict[str, int]:
        """Object id → its value in segmentation pictures, from 1; 0 is no object."""
        return {name: i for i, name in enumerate(self._entities, start=1)}

    def entity(self, object_id: str) -> object:
        """The SAPIEN entity of an object.

        Raises:
            UnknownName: there is no such object.
        """
        if object_id not in self._entities:
            raise UnknownName("object", object_id, self._entities)
        return self._entities[object_id]

    def object_pose(self, object_id: str) -> Pose:
        """Pose of the object frame in the world."""
        return from_sapien(self.entity(object_id).pose)

    def object_poses(self) -> dict[str, Pose]:
        """Pose by object id."""
        return {name: from_sapien(entity.pose) for name, entity in self._entities.items()}

    def set_object_pose(self, object_id: str, pose: Pose) -> None:
        """Put an object somewhere, at rest."""
        entity = self.entity(object_id)
        entity.set_pose(to_sapien(pose))
        body = _rigid(entity)
        body.set_linear_velocity(np.zeros(3))
        body.set_angular_velocity(np.zeros(3))

    def fallen(self) -> list[str]:
        """Ids of the objects whose origin is more than 5 cm below the table top."""
        lowest = self.table.height - 0.05
        return [name for name, entity in self._entities.items() if entity.pose.p[2] < lowest]

    def camera_component(self, width: int, height: int, fovy: float, near: float, far: float) -> object:
        """SAPIEN's camera of that size (pixels) and vertical opening (radians), made once; its pose is the caller's."""
        key = (width, height, fovy, near, far)
        if key not in self._cameras:
            self._cameras[key] = self.scene.add_camera(f"camera-{len(self._cameras)}", width, height, fovy, near, far)
        return self._cameras[key]

    # --- time ---

    def step(self, count: int = 1) -> None:
        """Advance physics; every step of a world goes through here, so recorders (``before_step``) miss none."""
        for _ in range(count):
            for notify in self.before_step:
                notify(self)
            self.scene.step()
            self.steps += 1

    def settle(self, max_steps: int = 500) -> SettleReport:
        """Step until all objects are at rest, one falls, or ``max_steps`` are over."""
        before = self.object_poses()
        bodies = [_rigid(entity) for entity in self._entities.values()]
        resting, steps = 0, 0
        while steps < max_steps and resting < REST_STEPS and not self.fallen():
            self.step()
            steps += 1
            resting = resting + 1 if all(_at_rest(body) for body in bodies) else 0
        after, fallen = self.object_poses(), self.fallen()
        return SettleReport(
            steps=steps,
            settled=resting >= REST_STEPS and not fallen,
            drift_m={name: float(np.linalg.norm(after[name].p - before[name].p)) for name in after},
            tilt_rad={name: _angle_between(before[name], after[name]) for name in after},
            fallen=fallen,
        )

    # --- contacts ---

    def touching(self, object_id: str) -> set[str]:
        """What presses on an object: ids of objects, ``table``, or ``<arm>/<link>``."""
        entity = self.entity(object_id)
        names = self._contact_names()
        found = set()
        for contact in self.scene.get_contacts():
            pair = [body.entity for body in contact.bodies]
            if entity in pair and any(np.linalg.norm(point.impulse) > 0 for point in contact.points):
                other = pair[1] if pair[0] == entity else pair[0]
                found.add(names.get(other.per_scene_id, other.name))
        return found

    def holds(self, arm: str, object_id: str) -> bool:
        """Whether all fingers of an arm press on an object."""
        fingers = {f"{arm}/{finger.name}" for finger in self.arms[arm].fingers}
        return fingers <= self.touching(object_id)

    def _contact_names(self) -> dict[int, str]:
        """SAPIEN's entity id → ``<arm>/<link>`` for the links of the arms."""
        links = ((name, link) for name, arm in self.arms.items() for link in arm.articulation.links)
        return {link.entity.per_scene_id: f"{name}/{link.name}" for name, link in links}

    # --- state ---

    def state(self) -> WorldState:
        """Positions of everything that moves."""
        joints = {name: arm.articulation.get_qpos().copy() for name, arm in self.arms.items()}
        return WorldState(self.object_poses(), joints)

    def set_state(self, state: WorldState) -> None:
        """Put everything where ``state`` says, without stepping (for drawing)."""
        for name, pose in state.objects.items():
            self.entity(name).set_pose(to_sapien(pose))
        for name, joints in state.joints.items():
            self.arms[name].articulation.set_qpos(joints)

    def snapshot(self) -> bytes:
        """Everything that physics needs to go on: positions, velocities, drive targets and the step count.

        Going on in the same world after :meth:`restore` is not reproducible, because contact caches survive;
        restore into a fresh world, which is.
        """
        targets = {f"target.{name}": arm.drive_targets() for name, arm in self.arms.items()}
        commands = {f"command.{name}": arm.command for name, arm in self.arms.items()}
        physics = np.frombuffer(self.scene.physx_system.pack(), dtype=np.uint8)
        names = np.array(self.object_ids, dtype=np.str_)
        return pack_arrays({"physics": physics, "steps": np.int64(self.steps), "objects": names, **targets, **commands})

    def restore(self, snapshot: bytes) -> None:
        """Continue from a snapshot of a world with the same objects and robot; call it on a fresh world."""
        arrays = unpack_arrays(snapshot)
        if arrays["objects"].tolist() != self.object_ids:
            raise ValueError(f"the snapshot holds {arrays['objects'].tolist()}, the world {self.object_ids}")
        self.scene.physx_system.unpack(arrays["physics"].tobytes())
        self.steps = int(arrays["steps"])
        for name, arm in self.arms.items():
            arm.set_drive_targets(arrays[f"target.{name}"], arrays[f"command.{name}"])


def _rigid(entity: object) -> object:
    import sapien

    return entity.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)


def _at_rest(body: object) -> bool:
    slow = np.linalg.norm(body.linear_velocity) < REST_SPEED
    return bool(slow and np.linalg.norm(body.angular_velocity) < REST_SPIN)


def _angle_between(a: Pose, b: Pose) -> float:
    """Angle between the up axes of two poses, radians."""
    cosine = float(np.clip(a.rotation()[:, 2] @ b.rotation()[:, 2], -1.0, 1.0))
    return float(np.arccos(cosine))
