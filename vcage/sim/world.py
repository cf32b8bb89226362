"""A SAPIEN scene made from records: the table, objects, and the arms of a robot."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from vcage.base.errors import UnknownName
from vcage.base.geometry import Pose, tilt_between
from vcage.schema.asset import PhysicalModel
from vcage.schema.robot import Robot
from vcage.schema.scene import Scene, Table
from vcage.sim.appearance import Appearance
from vcage.sim.arms import ArmControl, build_arm
from vcage.sim.bodies import ArticulatedObject, Body, RigidObject, add_object, seen_meshes
from vcage.sim.contacts import ContactNames, FingerContacts, pack_contacts, unpack_contacts
from vcage.sim.render import keep_one_shadow, new_render_system
from vcage.sim.state import SettleReport, WorldState, pack_arrays, require_joints, unpack_arrays
from vcage.sim.surroundings import add_surroundings, add_table
from vcage.sim.tints import tint_entities

if TYPE_CHECKING:
    import sapien

PHYSICS_HZ = 250
"""Physics steps per second."""

REST_STEPS = 10
"""Steps in a row that all objects must rest, so that the top of a bounce does not count."""

FALLEN_M = 0.05
"""An object whose origin is further below the table top has fallen."""


def _physics_system() -> sapien.physx.PhysxCpuSystem:
    """PhysX that finds all contacts of two shapes anew in each step.

    Its persistent manifolds report thin hulls 2 cm apart as 3 cm deep in each other, and throw them apart.
    """
    import sapien

    config = sapien.physx.get_scene_config()
    was, config.enable_pcm = config.enable_pcm, False
    sapien.physx.set_scene_config(config)
    system = sapien.physx.PhysxCpuSystem()
    config.enable_pcm = was  # the configuration is the process's, and other scenes of a user keep theirs
    sapien.physx.set_scene_config(config)
    return system


class World:
    """A table with objects and, if given, a robot.

    The same arguments and the same commands give bit-identical states.

    Example:
        >>> world = World.of_scene(scene, StageContext().physical_models(scene))
        >>> world.settle().drift_m

    Args:
        table: carries everything.
        bodies: objects by id; their order fixes :attr:`segmentation_ids`.
        robot: its arms stand at home, grippers open.
        appearance: of a rendered world.
        render: allow pictures; without, no rendering device is needed.

    Raises:
        NoRenderer: ``render`` is set and nothing here can draw.
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
        systems = [new_render_system(seen_meshes(body.model for body in bodies.values()))] if render else []
        import sapien

        self.table = table
        self.appearance = appearance or Appearance()
        self.bodies = dict(bodies)
        self.robot = robot
        self.rendered = render
        self.steps = 0
        self.before_step: list[Callable[[World], None]] = []
        self._cameras: dict[tuple[int, int, float, float, float], sapien.render.RenderCameraComponent] = {}
        self._physics = _physics_system()
        self.scene = sapien.Scene([self._physics, *systems])
        self.scene.set_timestep(1 / PHYSICS_HZ)
        add_table(self.scene, table)
        self._objects = {name: add_object(self.scene, name, body, render) for name, body in bodies.items()}
        if render:
            for name, tint in self.appearance.tints.items():
                tint_entities(self.entities(name).values(), tint)
        arms = robot.arms if robot else {}
        faces = robot.visual_faces if robot and render else None
        self.arms = {
            name: ArmControl(name, arm, build_arm(self.scene, arm, faces), self.step) for name, arm in arms.items()
        }
        self._contact_names = ContactNames(self._objects, self.arms)
        self._restored_contacts: dict[str, FingerContacts] | None = None
        if render:
            add_surroundings(self.scene, table, robot, self.appearance)
            keep_one_shadow(self.scene)

    @classmethod
    def of_scene(
        cls,
        scene: Scene,
        models: Mapping[str, PhysicalModel],
        robot: Robot | None = None,
        appearance: Appearance | None = None,
        render: bool = False,
    ) -> World:
        """The world of a scene record; ``models`` are by object id, the rest is as for the world."""
        bodies = {o.id: Body(models[o.id], o.pose.pose(), o.joints) for o in scene.objects}
        return cls(scene.table, bodies, robot, appearance, render)

    # --- objects ---

    @property
    def object_ids(self) -> list[str]:
        """Ids of the objects, in the order given."""
        return list(self._objects)

    @property
    def segmentation_ids(self) -> dict[str, int]:
        """Object id → its value in segmentation pictures, from 1; 0 is no object."""
        return {name: i for i, name in enumerate(self._objects, start=1)}

    def entities(self, object_id: str) -> dict[str | None, sapien.Entity]:
        """The SAPIEN entity of each part of an object by the part's name; the body's name is None.

        Raises:
            UnknownName: there is no such object.
        """
        return self._object(object_id).entities

    def object_pose(self, object_id: str) -> Pose:
        """Pose of the object frame in the world."""
        return self._object(object_id).pose

    def object_poses(self) -> dict[str, Pose]:
        """Pose by object id."""
        return {name: thing.pose for name, thing in self._objects.items()}

    def set_object_pose(self, object_id: str, pose: Pose) -> None:
        """Move an object to a pose with all its parts, at rest; its joints stay."""
        thing = self._object(object_id)
        thing.set_pose(pose)
        thing.stop()

    def set_object_joints(self, object_id: str, joints: Sequence[float]) -> None:
        """Set the (n,) joint positions of an object, at rest; all to 0 when empty."""
        self._object(object_id).set_joints(joints)

    def object_joints(self, object_id: str) -> np.ndarray:
        """(n,) position of each moving part in the order of its model's links, metres or radians; (0,) without."""
        return self._object(object_id).joints

    def body(self, object_id: str) -> Body:
        """The present pose and joints of an object."""
        thing = self._object(object_id)
        return Body(self.bodies[object_id].model, thing.pose, tuple(thing.joints.tolist()))

    def fallen(self) -> list[str]:
        """Ids of the objects whose origin is more than :data:`FALLEN_M` below the table top."""
        lowest = self.table.height - FALLEN_M
        return [name for name, thing in self._objects.items() if thing.entities[None].pose.p[2] < lowest]

    @property
    def keeping(self) -> set[str]:
        """Names of the arms that hold something."""
        return {name for name, control in self.arms.items() if control.keeps}

    def _object(self, object_id: str) -> RigidObject | ArticulatedObject:
        if object_id not in self._objects:
            raise UnknownName("object", object_id, self._objects)
        return self._objects[object_id]

    def camera_component(
        self, width: int, height: int, fovy: float, near: float, far: float
    ) -> sapien.render.RenderCameraComponent:
        """SAPIEN's camera of a size in pixels, made once; the caller sets its pose.

        Args:
            width, height: pixels.
            fovy: vertical opening, radians.
            near, far: clipping planes, metres.
        """
        key = (width, height, fovy, near, far)
        if key not in self._cameras:
            self._cameras[key] = self.scene.add_camera(f"camera-{len(self._cameras)}", *key)
        return self._cameras[key]

    # --- time ---

    def step(self, count: int = 1) -> None:
        """Advance physics. Every step of a world goes through here, so recorders (``before_step``) miss none."""
        for _ in range(count):
            for notify in self.before_step:
                notify(self)
            for arm in self.arms.values():
                arm.before_step()
            self.scene.step()
            self.steps += 1
            self._restored_contacts = None

    def at_rest(self, object_id: str) -> bool:
        """True if an object hardly moves now.

        Raises:
            UnknownName: there is no such object.
        """
        return self._object(object_id).at_rest()

    def settle(self, max_steps: int = 500) -> SettleReport:
        """Step until all objects are at rest, one falls, or ``max_steps`` have passed."""
        before = self.object_poses()
        resting, steps = 0, 0
        while steps < max_steps and resting < REST_STEPS and not self.fallen():
            self.step()
            steps += 1
            resting = resting + 1 if all(thing.at_rest() for thing in self._objects.values()) else 0
        after, fallen = self.object_poses(), self.fallen()
        return SettleReport(
            steps=steps,
            settled=resting >= REST_STEPS and not fallen,
            drift_m={name: float(np.linalg.norm(after[name].p - before[name].p)) for name in after},
            tilt_rad={name: tilt_between(before[name], after[name]) for name in after},
            fallen=fallen,
        )

    # --- contacts ---

    def touching(self, name: str) -> set[str]:
        """Names of things that press on an object or on one part of it: other ids, ``table``, or ``<arm>/<link>``.

        Args:
            name: an object's id, or ``<id>/<link>`` for a moving part alone.

        Raises:
            UnknownName: there is no such object or part.
        """
        return set(self._contact_names.impulses(name, self.scene.get_contacts()))

    def presses(self, names: Collection[str]) -> Iterator[tuple[str, str, float]]:
        """Yield the pressing contacts of objects (ids) or arms (names): (own name, other's, last impulse in N s).

        An arm's own name is ``<arm>/<link>``.
        """
        return self._contact_names.presses(names, self.scene.get_contacts())

    def borne_by(self, object_id: str) -> dict[str, float]:
        """Share of an object's weight that each other thing bears, by the upward impulses of the last step.

        Raises:
            UnknownName: there is no such object.
        """
        given = self._contact_names.impulses(object_id, self.scene.get_contacts())
        upward = {name: max(0.0, float(impulse[2])) for name, impulse in given.items()}
        total = sum(upward.values())
        return {name: share / total for name, share in upward.items()} if total else {}

    def holds(self, arm: str, name: str) -> bool:
        """True if all fingers of an arm press on an object, or on one moving part of it (``<id>/<link>``)."""
        fingers = {f"{arm}/{finger.name}" for finger in self.arms[arm].fingers}
        return fingers <= self.touching(name)

    def finger_contacts(self) -> dict[str, FingerContacts]:
        """Forces on the fingers of each arm in the last step; in the last one before the snapshot once restored."""
        if self._restored_contacts is not None:
            return self._restored_contacts
        return self._contact_names.on_fingers(self.scene.get_contacts(), 1 / PHYSICS_HZ)

    # --- state ---

    def state(self) -> WorldState:
        """Positions of all moving things."""
        joints = {name: arm.articulation.get_qpos().copy() for name, arm in self.arms.items()}
        return WorldState(self.object_poses(), joints, self.joints_of_objects())

    def joints_of_objects(self) -> dict[str, np.ndarray]:
        """(n,) joint positions of each object that has moving parts, by id."""
        return {name: thing.joints for name, thing in self._objects.items() if len(thing.joints)}

    def set_state(self, state: WorldState) -> None:
        """Set all positions without stepping, for drawing.

        Raises:
            DamagedFile: the state has other joints than the world.
            UnknownName: it has an object that the world does not have.
        """
        require_joints(state.object_joints, self.joints_of_objects())
        require_joints(state.joints, {name: arm.articulation.get_qpos() for name, arm in self.arms.items()})
        for name, pose in state.objects.items():
            self._object(name).set_pose(pose)
        for name, joints in state.object_joints.items():
            self._object(name).set_joints(joints)
        for name, joints in state.joints.items():
            self.arms[name].articulation.set_qpos(joints)

    def snapshot(self) -> bytes:
        """All that is needed to continue: positions, velocities, drive targets, finger contacts and the step count.

        Restore it into a new world: in the same world contact caches survive, and the result is not reproducible.
        """
        drives = {f"drives.{name}": arm.drives for name, arm in self.arms.items()}
        physics = np.frombuffer(self._physics.pack(), dtype=np.uint8)
        names = np.array(self.object_ids, dtype=np.str_)
        facts = {"physics": physics, "steps": np.array(self.steps), "objects": names}
        return pack_arrays({**facts, **drives, **pack_contacts(self.finger_contacts())})

    def restore(self, snapshot: bytes) -> None:
        """Continue from a snapshot of a world with the same objects and robot; call it on a new world."""
        arrays = unpack_arrays(snapshot)
        if arrays["objects"].tolist() != self.object_ids:
            raise ValueError(f"the snapshot holds {arrays['objects'].tolist()}, the world {self.object_ids}")
        self._physics.unpack(arrays["physics"].tobytes())
        self.steps = int(arrays["steps"])
        for name, arm in self.arms.items():
            arm.drives = arrays[f"drives.{name}"]
        self._restored_contacts = unpack_contacts(arrays, self.arms)
