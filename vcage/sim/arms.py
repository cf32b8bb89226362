"""Arms in a world: SAPIEN articulations driven by position targets."""

from __future__ import annotations

import functools
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from vcage.base.geometry import Pose
from vcage.schema.robot import Arm
from vcage.sim.drives import PARTS, DriveLayout, on_grid
from vcage.sim.poses import from_sapien, to_sapien
from vcage.sim.robots import package_file
from vcage.sim.trajectory import Trajectory
from vcage.sim.urdf import physics_urdf, render_urdf

if TYPE_CHECKING:
    import sapien


@dataclass(frozen=True)
class WaitSettings:
    """Ends of the waits for an arm; steps are physics steps.

    Args:
        arrived_rad: the arm has arrived when every joint is this near its target.
        arrival_steps: longest wait for that.
        fingers_still_m: the fingers stand still when they move less per step.
        fingers_apart_m: a released object is free when the fingers are this near to their goal.
        least_finger_steps, most_finger_steps: shortest and longest wait for the fingers.
    """

    arrived_rad: float = 0.003
    arrival_steps: int = 125
    fingers_still_m: float = 2e-5
    fingers_apart_m: float = 0.006
    least_finger_steps: int = 25
    most_finger_steps: int = 250


WAITS = WaitSettings()


@dataclass(frozen=True)
class FirmFingerSettings:
    """Physics of an arm whose fingers have a drive of their own.

    Args:
        iterations: of the contact solver in a step. With SAPIEN's 10, the forces of two fingers of 10,000 N/m do not
            balance, and what they hold creeps sideways by a centimetre.
    """

    iterations: int = 100


FIRM_FINGERS = FirmFingerSettings()


@dataclass(frozen=True)
class ContactSettings:
    """Contacts of an arm's links.

    Args:
        offset_m: of a link's shapes. Contacts begin where two shapes are as near as the sum of theirs. With SAPIEN's
            10 mm, a finger and a hand that are 19 mm apart press on each other with 100 N, at points outside of both.
    """

    offset_m: float = 0.002


CONTACTS = ContactSettings()


def build_arm(scene: sapien.Scene, arm: Arm, visual_faces: float | None) -> sapien.physx.PhysxArticulation:
    """Add the arm to the scene at its home, gripper open, gravity compensated.

    Args:
        visual_faces: share of the visual triangles to keep, or None for an arm that is not drawn.
    """
    builder = _builder(arm.model_dump_json(), visual_faces)
    builder.set_scene(scene)
    articulation = builder.build()
    builder.scene = None  # pyrefly: ignore[bad-assignment]  it would keep the scene alive
    articulation.set_root_pose(to_sapien(arm.base.pose()))
    for link in articulation.links:
        link.disable_gravity = True
        for shape in link.collision_shapes:
            shape.contact_offset = CONTACTS.offset_m
    if arm.gripper.stiffness is not None:
        articulation.set_solver_position_iterations(FIRM_FINGERS.iterations)
    return articulation


@functools.lru_cache(maxsize=8)
def _builder(arm_json: str, visual_faces: float | None) -> sapien.ArticulationBuilder:
    """The builder of an arm, read from its files once per process: that takes longer than building."""
    import sapien

    arm = Arm.model_validate_json(arm_json)
    source = package_file(arm.urdf)
    urdf = physics_urdf(source) if visual_faces is None else render_urdf(source, visual_faces)
    loader = sapien.Scene([sapien.physx.PhysxCpuSystem()]).create_urdf_loader()
    loader.fix_root_link = True
    for link in _finger_links(arm, urdf):
        loader.set_link_material(link, arm.gripper.friction, arm.gripper.friction, 0.0)
        loader.set_link_patch_radius(link, arm.gripper.friction_patch)
        loader.set_link_min_patch_radius(link, arm.gripper.friction_patch)
    srdf = None if arm.srdf is None else str(package_file(arm.srdf))
    (builder,), _, _ = loader.parse(str(urdf), srdf_file=srdf)
    return builder


def _finger_links(arm: Arm, urdf: Path) -> list[str]:
    joints = ElementTree.parse(urdf).getroot().iterfind("joint")
    children = [joint.find("child") for joint in joints if joint.attrib["name"] in arm.gripper.joints]
    return [child.attrib["link"] for child in children if child is not None]


def move_together(moves: Sequence[tuple[ArmControl, Trajectory]]) -> None:
    """Let arms of one world follow a trajectory each, at the same time, and wait until all have arrived."""
    (first, _), *_ = moves
    for _ in zip_longest(*(arm.follow(trajectory) for arm, trajectory in moves)):
        first.step()
    for _ in range(WAITS.arrival_steps):
        if all(arm.is_at(trajectory.end) for arm, trajectory in moves):
            break
        first.step()


class ArmControl:
    """One arm of a world: its commands and its measured state.

    ``qpos`` and ``command`` have the same layout: the arm's joints in radians, then the gripper's opening from
    0 (closed) to 1 (open).

    Args:
        name: 'left', 'right'.
        arm: its description.
        articulation: its body in a SAPIEN scene.
        step: advances the world by one physics step.

    Attributes:
        layout: of the next.
        drives: commands for the next physics step (:mod:`vcage.sim.drives`); replaced, never written into.
    """

    def __init__(self, name: str, arm: Arm, articulation: sapien.physx.PhysxArticulation, step: Callable[[], None]):
        self.name = name
        self.arm = arm
        self.articulation = articulation
        self.step = step
        order = {joint.name: i for i, joint in enumerate(articulation.active_joints)}
        self._arm_index = np.array([order[j] for j in arm.joints])
        self._finger_index = np.array([order[j] for j in arm.gripper.joints])
        self._joints = [articulation.active_joints[i] for i in self._arm_index]
        self._tool = articulation.find_link_by_name(arm.tool_link)
        self._offset = arm.tool_offset.pose() if arm.tool_offset else Pose()
        fingers = arm.gripper
        for joint in articulation.active_joints:
            stiffness, damping, force = arm.stiffness, arm.damping, arm.force
            if joint.name in fingers.joints:
                stiffness, damping, force = fingers.stiffness or stiffness, fingers.damping or damping, fingers.force
            joint.set_drive_properties(stiffness, damping, force_limit=force, mode="force")
        self.layout = DriveLayout(len(arm.joints), articulation.dof)
        self.drives = np.zeros(self.layout.size)
        self._sent = np.full(self.layout.size, np.nan)
        self.reset()

    # --- actions: these advance the world ---

    def move(self, trajectory: Trajectory) -> None:
        """Follow a trajectory, one target for each physics step, and wait until the arm has arrived.

        As in a robot's own controller, a feed-forward torque for the arm's inertia keeps the arm on its targets while
        it accelerates.
        """
        move_together([(self, trajectory)])

    def follow(self, trajectory: Trajectory) -> Iterator[None]:
        """Command the targets of a trajectory in turn, one for each physics step that the caller makes, and the end."""
        openings = dict(trajectory.openings)
        torques = self._torques(trajectory)
        rows = zip(trajectory.q, trajectory.velocity, torques, strict=True)
        for i, (q, velocity, torque) in enumerate(rows):
            if i in openings:
                self.command_gripper(openings[i])
            self.command_joints(q, velocity)
            self._command("torque", torque)
            yield
        self._command("torque", np.zeros(self.articulation.dof))
        self.command_joints(trajectory.end)

    def stop(self) -> None:
        """Stay at the present targets, wherever on a trajectory they are."""
        self._command("torque", np.zeros(self.articulation.dof))
        self.command_joints(self.command[:-1])

    def is_at(self, q: np.ndarray) -> bool:
        """True if every joint is near (n,) ``q``, rad."""
        return bool(np.abs(self.joints - q).max() < WAITS.arrived_rad)

    def grip(self, opening: float) -> None:
        """Drive the fingers to ``opening`` (0 closed, 1 open) until they stand still, there or against an object."""
        self.command_gripper(opening)
        for count in range(WAITS.most_finger_steps):
            before = self.finger_width
            self.step()
            if count >= WAITS.least_finger_steps and abs(self.finger_width - before) < WAITS.fingers_still_m:
                break

    def release(self, opening: float) -> None:
        """Drive the fingers apart to ``opening`` until they are nearly there; they go on while the arm moves."""
        self.command_gripper(opening)
        for _ in range(WAITS.most_finger_steps):
            if (opening - self.opening) * self.arm.gripper.max_width < WAITS.fingers_apart_m:
                break
            self.step()

    def _torques(self, trajectory: Trajectory) -> np.ndarray:
        """(T, dof) mass matrix × acceleration, N m; that of an empty hand, as the held mass is unknown."""
        joints = np.tile(self.articulation.get_qpos(), (len(trajectory), 1)).astype(np.float64)
        joints[:, self._arm_index] = trajectory.q
        acceleration = np.zeros_like(joints)
        acceleration[:, self._arm_index] = trajectory.acceleration
        mass = self._dynamics.compute_generalized_mass_matrix
        return np.stack([mass(q) @ a for q, a in zip(joints, acceleration, strict=True)])

    @cached_property
    def _dynamics(self) -> sapien.PinocchioModel:
        return self.articulation.create_pinocchio_model()  # pyrefly: ignore[missing-argument]  a wrong stub

    # --- commands ---

    def reset(self, offset: ArrayLike = 0.0) -> None:
        """At home or (n,) ``offset`` from there, rad, open, at rest, immediately."""
        joints, start = np.zeros(self.articulation.dof), np.array(self.arm.home) + np.asarray(offset)
        joints[self._arm_index] = start
        joints[self._finger_index] = self.arm.gripper.open
        self.articulation.set_qpos(joints)
        self.articulation.set_qvel(np.zeros_like(joints))
        self.command_joints(start)
        self.command_gripper(1.0)

    def command_joints(self, q: np.ndarray, velocity: np.ndarray | None = None) -> None:
        """Drive the arm's joints (n,) to ``q``, rad, passing at ``velocity``, rad/s (0 when not given)."""
        self._command("position", q)
        self._command("velocity", np.zeros(len(self._joints)) if velocity is None else velocity)

    def command_gripper(self, opening: float) -> None:
        """Drive the fingers to ``opening``, 0 closed to 1 open."""
        self._command("opening", opening)

    def _command(self, part: str, values: float | np.ndarray) -> None:
        drives = self.drives.copy()
        drives[self.layout.part(part)] = on_grid(part, values)
        self.drives = drives

    def before_step(self) -> None:
        """Send the drives the commands that changed since the last physics step.

        Repeated commands would wake sleeping bodies, and a replay knows the commands of each step alone.
        """
        if self.drives is self._sent:
            return
        new = {part: self.drives[self.layout.part(part)] for part in PARTS}
        differs = self.drives != self._sent
        changed = {part for part in PARTS if differs[self.layout.part(part)].any()}
        self._sent = self.drives
        if changed & {"position", "velocity"}:
            rows = zip(self._joints, new["position"].tolist(), new["velocity"].tolist(), strict=True)
            for joint, target, speed in rows:
                joint.set_drive_target(target)
                joint.set_drive_velocity_target(speed)
        if "torque" in changed:
            self.articulation.set_qf(new["torque"])
        if "opening" in changed:
            position = self._finger_position(float(new["opening"][0]))
            for index in self._finger_index:
                self.articulation.active_joints[index].set_drive_target(position)

    def _finger_position(self, opening: float) -> float:
        """Joint position of the fingers at ``opening``, 0 closed to 1 open, metres."""
        gripper = self.arm.gripper
        return gripper.closed + opening * (gripper.open - gripper.closed)

    def put_fingers(self, opening: float) -> None:
        """Put the fingers at ``opening``, 0 closed to 1 open, for drawing: the next step drives them back."""
        joints = self.articulation.get_qpos()
        joints[self._finger_index] = self._finger_position(opening)
        self.articulation.set_qpos(joints)

    # --- state ---

    @property
    def joints(self) -> np.ndarray:
        """(n,) measured arm joints, rad."""
        return self.articulation.get_qpos()[self._arm_index].astype(np.float64)

    @property
    def opening(self) -> float:
        """Measured opening of the gripper, 0 closed to 1 open."""
        gripper = self.arm.gripper
        position = float(self.articulation.get_qpos()[self._finger_index].mean())
        return (position - gripper.closed) / (gripper.open - gripper.closed)

    @property
    def finger_width(self) -> float:
        """Measured distance between the fingers, metres."""
        return self.opening * self.arm.gripper.max_width

    @property
    def keeps(self) -> bool:
        """True if the fingers are driven together around something."""
        return float(self.drives[self.layout.part("opening")][0]) <= 0.0 and not self.empty

    @property
    def empty(self) -> bool:
        """True if the fingers are so close that nothing is between them."""
        return self.finger_width < self.arm.gripper.empty_width

    @property
    def qpos(self) -> np.ndarray:
        """(n + 1,) measured joints and gripper opening."""
        return np.append(self.joints, self.opening)

    @property
    def qvel(self) -> np.ndarray:
        """(n + 1,) measured velocities in the layout of :attr:`qpos`, per second."""
        speeds = self.articulation.get_qvel()
        gripper = self.arm.gripper
        fingers = float(speeds[self._finger_index].mean()) / (gripper.open - gripper.closed)
        return np.append(speeds[self._arm_index].astype(np.float64), fingers)

    @property
    def command(self) -> np.ndarray:
        """(n + 1,) the present targets."""
        return np.append(self.drives[self.layout.part("position")], self.drives[-1])

    @property
    def tool_pose(self) -> Pose:
        """Measured pose of the gripper frame in the world."""
        return from_sapien(self._tool.entity_pose) * self._offset

    @property
    def fingers(self) -> list[sapien.Entity]:
        """The entities of the finger links."""
        return [self.articulation.active_joints[i].child_link.entity for i in self._finger_index]

    def link_pose(self, name: str) -> Pose:
        """Measured pose of a link in the world."""
        return from_sapien(self.articulation.find_link_by_name(name).entity_pose)
