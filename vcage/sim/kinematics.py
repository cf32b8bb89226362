"""Forward and inverse kinematics of an arm, without physics and without rendering."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vcage.base.geometry import Pose
from vcage.base.memory import remembered
from vcage.schema.robot import Arm
from vcage.sim.arms import build_arm
from vcage.sim.poses import from_sapien, to_sapien
from vcage.sim.shapes import physics_shape

if TYPE_CHECKING:
    import sapien


@dataclass(frozen=True)
class InverseSettings:
    """Tolerances and effort of inverse kinematics.

    Args:
        position_m, rotation_rad: largest error of a solution.
        limit_margin_rad: distance of a solution from the joint limits.
        distinct_rad: solutions that differ by less in every joint are the same.
        iterations: steps of the solver from one seed; for a seed that needs more, the next seed is better.
        variations: of home, tried after the given seed and home.
        cached: answers that an arm stores: a search asks again for the same grasp with every place of the object.
    """

    position_m: float = 5e-4
    rotation_rad: float = 2e-3
    limit_margin_rad: float = 0.01
    distinct_rad: float = 0.1
    iterations: int = 100
    variations: int = 10
    cached: int = 2**16


SETTINGS = InverseSettings()

TILTS = tuple(np.radians(degrees) for degrees in (0.0, 20.0, -20.0, 40.0, -40.0, 60.0, -60.0, 80.0, -80.0))
"""Turns of a hand about its closing axis, none first: arms with short wrists need them far from their base, and high
above the table."""


class ArmKinematics:
    """Kinematics of one arm in the world frame; answers are deterministic.

    Args:
        arm: its description; the gripper frame is ``tool_link`` with ``tool_offset``.
    """

    def __init__(self, arm: Arm):
        import sapien

        self.arm = arm
        # The scene must outlive the articulation from which the model was made.
        self._scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
        articulation = build_arm(self._scene, arm, visual_faces=None)
        self._model = articulation.create_pinocchio_model()  # pyrefly: ignore[missing-argument]  a wrong stub
        self._links = {link.name: i for i, link in enumerate(articulation.links)}
        self.link_shapes = [(x.name, physics_shape(shape)) for x in articulation.links for shape in x.collision_shapes]
        """Link name and collision shape, from the base out."""
        solid = list(dict.fromkeys(name for name, _ in self.link_shapes))
        self.link_ranks = np.array([solid.index(name) for name, _ in self.link_shapes])
        """Rank of each of :attr:`link_shapes`: the number of solid links before its link; 0 is the base."""
        joints = articulation.active_joints
        order = [joint.name for joint in joints]
        self._index = np.array(list(map(order.index, arm.joints)))
        self._fingers = np.array(list(map(order.index, arm.gripper.joints)))
        self._mask = np.isin(np.arange(len(order)), self._index).astype(np.int32)
        self._moved_links = [joints[i].child_link.name for i in self._index]
        self.finger_links = frozenset(joints[i].child_link.name for i in self._fingers)
        """Names of the links that the gripper's joints move."""
        self._base = arm.base.pose()
        self._from_base = self._base.inverse()
        self._offset = arm.tool_offset.pose() if arm.tool_offset else Pose()
        self._to_link = self._offset.inverse()
        limits = np.concatenate([joint.limits for joint in joints])[self._index]
        self.lower, self.upper = limits[:, 0].astype(np.float64), limits[:, 1].astype(np.float64)
        self.home = np.array(arm.home, dtype=np.float64)
        self._seeds = self._variations_of_home()
        first, *_, last = self._base.apply(self._joint_origins(self.home))
        self._shoulder, self._to_wrist = first, self.fk(self.home).inverse().apply(last)
        off = SETTINGS.position_m + SETTINGS.rotation_rad * float(np.linalg.norm(self._to_wrist))
        self._stretch = self._longest_stretch() + off
        self._first = remembered(SETTINGS.cached)(self._first_solution)

    def fk(self, q: Sequence[float] | np.ndarray) -> Pose:
        """Pose of the gripper frame in the world at arm joints ``q`` (n,), rad."""
        self._model.compute_forward_kinematics(self._full(q, 1.0))
        link = self._model.get_link_pose(self._links[self.arm.tool_link])
        return self._base * from_sapien(link) * self._offset

    def base_poses(self, q: Sequence[float] | np.ndarray, opening: float) -> dict[str, sapien.Pose]:
        """Pose of every link in the frame of the arm's base; the gripper ``opening`` from 0 to 1."""
        self._model.compute_forward_kinematics(self._full(q, opening))
        return {name: self._model.get_link_pose(i) for name, i in self._links.items()}

    def base_pose_of_tool(self, q: Sequence[float] | np.ndarray) -> sapien.Pose:
        """Pose of the gripper frame in the frame of the arm's base."""
        self._model.compute_forward_kinematics(self._full(q, 1.0))
        return self._model.get_link_pose(self._links[self.arm.tool_link]) * to_sapien(self._offset)

    def on_hand(self, link: str) -> Pose | None:
        """Pose of a link in the gripper frame; None of one that moves against the gripper.

        Raises:
            KeyError: the arm has no such link.
        """
        poses = []
        for q in (self.home, self.home + 0.1):
            poses.append(from_sapien(self.base_pose_of_tool(q)).inverse() * from_sapien(self.base_poses(q, 0.0)[link]))
        return poses[0] if np.allclose(poses[0].matrix(), poses[1].matrix(), atol=1e-5) else None

    def ik(
        self, pose: Pose, seed_q: np.ndarray | None = None, attempts: int = SETTINGS.variations + 1
    ) -> np.ndarray | None:
        """Joints (n,) within limits that bring the gripper frame to ``pose``, or None.

        Args:
            pose: of the gripper frame in the world.
            seed_q: (n,) first start; the solution nearest to it is usually found. Home is next, then fixed
                variations of home.
            attempts: starts besides ``seed_q``.
        """
        q = self._first(pose, None if seed_q is None else tuple(np.asarray(seed_q).tolist()), attempts)
        return None if q is None else np.array(q)

    def ik_all(self, pose: Pose, seed_q: np.ndarray | None = None) -> list[np.ndarray]:
        """The different solutions from all starts of :meth:`ik`, in that order."""
        found: list[np.ndarray] = []
        for q in self._solutions(pose, seed_q, len(self._seeds)):
            if all(np.abs(q - other).max() > SETTINGS.distinct_rad for other in found):
                found.append(q)
        return found

    def distance(self, q: np.ndarray, pose: Pose) -> float:
        """Distance of ``pose`` from joints ``q`` (n,): the time at full speed, seconds; infinite out of reach."""
        goal = self.ik(pose, q)
        return np.inf if goal is None else float((np.abs(goal - q) / self.arm.speeds).max())

    def reachable(self, pose: Pose, attempts: int = SETTINGS.variations + 1) -> bool:
        """True if :meth:`ik` has a solution."""
        return self.ik(pose, attempts=attempts) is not None

    def too_far(self, pose: Pose) -> bool:
        """True if the arm is too short for ``pose``: a quick first test."""
        return bool(np.linalg.norm(pose.apply(self._to_wrist) - self._shoulder) > self._stretch)

    def within_limits(self, q: np.ndarray) -> bool:
        """True if all joints have the margin to their limits."""
        margin = SETTINGS.limit_margin_rad
        return bool(np.all(q >= self.lower + margin) and np.all(q <= self.upper - margin))

    def _first_solution(self, pose: Pose, seed_q: tuple[float, ...] | None, attempts: int) -> tuple[float, ...] | None:
        q = next(self._solutions(pose, None if seed_q is None else np.array(seed_q), attempts), None)
        return None if q is None else tuple(q.tolist())

    def _solutions(self, pose: Pose, seed_q: np.ndarray | None, attempts: int) -> Iterator[np.ndarray]:
        if self.too_far(pose):
            return  # every descent would take all its steps
        target = to_sapien(self._from_base * pose * self._to_link)
        for seed in ([] if seed_q is None else [np.asarray(seed_q)]) + self._seeds[:attempts]:
            q = self._solve(target, pose, seed)
            if q is not None:
                yield q

    def _solve(self, target: object, pose: Pose, seed: np.ndarray) -> np.ndarray | None:
        """One descent in closed loop (CLIK) from ``seed``; joint angles are brought back by whole turns."""
        full, _, _ = self._model.compute_inverse_kinematics(
            self._links[self.arm.tool_link],
            target,
            initial_qpos=self._full(seed, 1.0),
            active_qmask=self._mask,
            eps=1e-4,
            max_iterations=SETTINGS.iterations,
            dt=0.3,
            damp=1e-6,
        )
        q = self._unwound(np.asarray(full, dtype=np.float64)[self._index])
        return q if self.within_limits(q) and self._arrives(q, pose) else None

    def _arrives(self, q: np.ndarray, pose: Pose) -> bool:
        reached = self.fk(q)
        angle = 2 * np.arccos(min(1.0, abs(float(reached.q @ pose.q))))
        return bool(np.linalg.norm(reached.p - pose.p) < SETTINGS.position_m and angle < SETTINGS.rotation_rad)

    def _unwound(self, q: np.ndarray) -> np.ndarray:
        """Each angle moved by whole turns into its limits where that is possible."""
        turn = 2 * np.pi
        up, down = np.ceil((self.lower - q) / turn), np.ceil((q - self.upper) / turn)
        return q + turn * (up.clip(min=0) - down.clip(min=0))

    def _full(self, q: Sequence[float] | np.ndarray, opening: float) -> np.ndarray:
        gripper = self.arm.gripper
        full = np.zeros(len(self._mask))
        full[self._index] = q
        full[self._fingers] = gripper.closed + opening * (gripper.open - gripper.closed)
        return full

    def _longest_stretch(self) -> float:
        """Largest possible distance of the last joint from the first, metres.

        The sum of the links' lengths, or of pairs of links where that is less. The distance of a pair's ends depends
        on the joint between them alone, and its square is a sine of that joint's angle, given by three angles.
        """
        turns = np.array([0.0, 2.0, 4.0]) * np.pi / 3

        def longest(start: int, end: int) -> float:
            turned = [self._joint_origins(self.home + t * (np.arange(len(self.home)) == start + 1)) for t in turns]
            squares = np.array([np.sum((origins[end] - origins[start]) ** 2) for origins in turned])
            return float(np.sqrt(squares.mean() + abs(squares @ np.exp(1j * turns)) * 2 / 3))

        least = [0.0]
        for end in range(1, len(self.home)):
            least.append(min(least[start] + longest(start, end) for start in range(max(0, end - 2), end)))
        return least[-1]

    def _joint_origins(self, q: np.ndarray) -> np.ndarray:
        """(n, 3) origins of the arm's joints at joints ``q`` (n,), in the frame of its base."""
        poses = self.base_poses(q, 1.0)
        return np.array([poses[name].p for name in self._moved_links])

    def _variations_of_home(self) -> list[np.ndarray]:
        """Home, then fixed points around it: the same for every run, and independent of any other random choice."""
        rng = np.random.default_rng(0)
        spread = rng.uniform(-1.0, 1.0, size=(SETTINGS.variations, len(self.home)))
        return [self.home] + [np.clip(self.home + s, self.lower + 0.05, self.upper - 0.05) for s in spread]


def leaning(pose: Pose, tilts: Sequence[float] = TILTS) -> Iterator[Pose]:
    """The gripper poses that close about the same axis as ``pose``, in the order of ``tilts``.

    Each turn about the closing axis comes twice, with the gripper flipped by 180° about its approach.
    """
    for tilt in tilts:
        for flip in (0.0, np.pi):
            yield pose * Pose(q=[np.cos(tilt / 2), 0, np.sin(tilt / 2), 0]) * Pose.from_yaw([0, 0, 0], flip)


def follow(kinematics: ArmKinematics, poses: Sequence[Pose], start: np.ndarray) -> list[np.ndarray] | None:
    """Joint positions (n,) of the poses in order, each solved from the one before; None when one is out of reach."""
    path, q = [], start
    for pose in poses:
        q = kinematics.ik(pose, seed_q=q)
        if q is None:
            return None
        path.append(q)
    return path


@functools.cache
def arm_kinematics(arm_json: str) -> ArmKinematics:
    """The kinematics of the arm whose record is ``arm_json``, made once per process."""
    return ArmKinematics(Arm.model_validate_json(arm_json))


def kinematics_of(arm: Arm) -> ArmKinematics:
    """The kinematics of an arm; equal records share one."""
    return arm_kinematics(arm.model_dump_json())
