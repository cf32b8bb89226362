"""Deterministic motion planning: straight lines of the gripper, and free moves around obstacles.

mplib's planners cannot be seeded (the same query may fail in one run and succeed in the next), so paths are made
here: inverse kinematics along lines, each solution from the one before; joint interpolation; and, where neither
is free, a bidirectional random tree with a fixed seed.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from vcage.base.errors import VcageError
from vcage.base.geometry import Pose
from vcage.sim.collision import CollisionScene, Contact
from vcage.sim.paths import OPEN_HAND, JointPath, Leg, Load, stretches
from vcage.sim.rrt import connect
from vcage.sim.speed_profile import time_optimal
from vcage.sim.trajectory import Trajectory
from vcage.sim.world import PHYSICS_HZ


@dataclass(frozen=True)
class MotionSettings:
    """Resolution and alternatives of planning.

    Args:
        line_step_m, line_step_rad: spacing of the poses along a line.
        largest_jump_rad: change of a joint between neighbouring poses of a line; a larger one is another branch.
        joint_step_rad: spacing of collision checks in joint space.
        coarse_stride: every n-th point along a segment is checked first.
        rises_m: heights above start and goal of the raised paths.
        raised_goals: joint goals to which raised paths and random trees are tried.
    """

    line_step_m: float = 0.01
    line_step_rad: float = 0.06
    largest_jump_rad: float = 0.25
    joint_step_rad: float = 0.05
    coarse_stride: int = 8
    rises_m: tuple[float, ...] = (0.08, 0.16, 0.24)
    raised_goals: int = 2


SETTINGS = MotionSettings()


class MotionFailed(VcageError):
    """No path was found; the message names the move and the obstacle."""

    code = "motion_failed"


class MotionPlanner:
    """Plans for one arm in surroundings that stand still.

    Args:
        scene: the surroundings and the kinematics of the arm.
    """

    def __init__(self, scene: CollisionScene):
        self.scene = scene
        self.kinematics = scene.kinematics

    def fastest(self, path: JointPath) -> Trajectory:
        """The path at the arm's full speed, with a stop only at a corner that cannot be bent."""
        done: list[Trajectory] = []
        for stretch in stretches(path, lambda q, load: self._touches(q, load) is None):
            part = time_optimal(stretch.points, PHYSICS_HZ, self.kinematics.arm, stretch.speed)
            # The step nearest to the point.
            steps = [(int(np.abs(part.q - stretch.points[i]).max(axis=1).argmin()), o) for i, o in stretch.opens]
            done.append(replace(part, openings=tuple(steps)))
        return functools.reduce(Trajectory.then, done)

    def line(self, q: np.ndarray, pose: Pose, load: Load = OPEN_HAND) -> JointPath:
        """Move the gripper frame straight to ``pose``, turning evenly on the way.

        Args:
            q: (n,) joints at the start, rad.

        Raises:
            MotionFailed: a joint limit or an obstacle stops it.
        """
        return _path(self._line(q, pose, load), load)

    def follow(self, q: np.ndarray, poses: Sequence[Pose], load: Load = OPEN_HAND) -> JointPath:
        """Take the gripper frame through ``poses`` in one motion, straight from each to the next.

        Args:
            q: (n,) joints at the start, rad.

        Raises:
            MotionFailed: a joint limit or an obstacle stops it.
        """
        path = np.array([q], dtype=np.float64)
        for i, pose in enumerate(poses, start=1):
            try:
                path = np.concatenate([path, self._line(path[-1], pose, load)[1:]])
            except MotionFailed as error:
                raise MotionFailed(f"at pose {i} of {len(poses)}: {error.message}") from error
        return _path(path, load)

    def move(
        self,
        q: np.ndarray,
        goal: Pose | np.ndarray,
        load: Load = OPEN_HAND,
        then: Sequence[Pose] = (),
        search: bool = True,
    ) -> JointPath:
        """Move to a gripper pose or to joints, by any free path.

        Args:
            q: (n,) joints at the start, rad.
            goal: pose of the gripper frame, or (n,) joints.
            then: poses that straight lines must reach from there in turn, obstacles aside; joint goals from which
                they do not are left out.
            search: True to grow a random tree where no simple path is free.

        Raises:
            MotionFailed: no free path was found.
        """
        reasons: list[str] = []
        for way in self._ways(q, goal, load, then, search):
            try:
                return way()
            except MotionFailed as error:
                reasons.append(error.message)
        where = f"to {np.round(goal.p, 3).tolist()}" if isinstance(goal, Pose) else "to the given joints"
        why = "; ".join(dict.fromkeys(reasons)) or "no joint angles reach it"
        raise MotionFailed(f"the {self.kinematics.arm.tool_link} cannot move {where}: {why}")

    def continues(self, q: np.ndarray, poses: Sequence[Pose]) -> bool:
        """True if straight lines lead from ``q`` through ``poses``, obstacles aside."""
        for pose in poses:
            for step in _poses_between(self.kinematics.fk(q), pose):
                solution = self.kinematics.ik(step, q, attempts=0)
                if solution is None or np.abs(solution - q).max() > SETTINGS.largest_jump_rad:
                    return False
                q = solution
        return True

    # --- alternatives ---

    def _ways(
        self, q: np.ndarray, goal: Pose | np.ndarray, load: Load, then: Sequence[Pose], search: bool
    ) -> Iterator[Callable[[], JointPath]]:
        """Planners of the alternatives, the simplest first."""
        if isinstance(goal, Pose):
            near = self.kinematics.ik(goal, q, attempts=0)
            if near is not None and self.continues(near, then):
                yield lambda: _path(self._straight(q, near, load), load)
            yield lambda: _path(self._line(q, goal, load, then), load)
            goals = sorted(self.kinematics.ik_all(goal, q), key=lambda g: float(np.abs(g - q).max()))
            goals = [g for g in goals if self.continues(g, then)]
            goals = [g for g in goals if self._touches(g, load) is None] or goals
        else:
            goals = [np.asarray(goal, dtype=np.float64)]
        for g in goals:
            yield lambda g=g: _path(self._straight(q, g, load), load)
        for rise in SETTINGS.rises_m:
            for g in goals[: SETTINGS.raised_goals]:
                yield lambda g=g, rise=rise: self._raised(q, g, rise, load)
        for g in goals[: SETTINGS.raised_goals] if search else ():
            yield lambda g=g: self._around(q, g, load)

    def _raised(self, q: np.ndarray, goal: np.ndarray, rise: float, load: Load) -> JointPath:
        """Straight up, across in joint space, straight down."""
        up = [0.0, 0.0, rise]
        here, there = self.kinematics.fk(q), self.kinematics.fk(goal)
        first = self._line(q, Pose(here.p + up, here.q), load)
        last = self._line(goal, Pose(there.p + up, there.q), load)[::-1]
        across = self._straight(first[-1], last[0], load)
        return JointPath(tuple(Leg(points, load) for points in (first, across, last)))

    def _around(self, q: np.ndarray, goal: np.ndarray, load: Load) -> JointPath:
        """A path found by a random tree with a fixed seed."""
        for end in (q, goal):
            self.check(end, load)
        beside = self._beside(q, goal, load)
        path = connect(
            q,
            goal,
            free=lambda a, b: all(self._touches(x, load, beside) is None for x in _coarse_first(_between(a, b)[1:])),
            lower=self.kinematics.lower,
            upper=self.kinematics.upper,
            rng=np.random.default_rng(0),
        )
        if path is None:
            raise MotionFailed("no way around the obstacles was found")
        return JointPath(tuple(Leg(_between(a, b), load) for a, b in itertools.pairwise(path)))

    def _straight(self, q: np.ndarray, goal: np.ndarray, load: Load) -> np.ndarray:
        """(k, n) evenly spaced points of a straight line in joint space."""
        path, beside = _between(q, goal), self._beside(q, goal, load)
        for point in path[1:]:
            self.check(point, load, beside)
        return path

    def _line(self, q: np.ndarray, pose: Pose, load: Load, then: Sequence[Pose] = ()) -> np.ndarray:
        """(k, n) joints along a straight line of the gripper frame."""
        path = [np.asarray(q, dtype=np.float64)]
        start = self.kinematics.fk(q)
        poses = _poses_between(start, pose)
        for i, step in enumerate(poses, start=1):
            solution = self.kinematics.ik(step, path[-1], attempts=0)
            if solution is None or np.abs(solution - path[-1]).max() > SETTINGS.largest_jump_rad:
                share = f"{100 * i / len(poses):.0f} %"
                raise MotionFailed(f"the arm cannot follow the straight line to its end (joint limit at {share})")
            self.check(solution, load)
            path.append(solution)
        if not self.continues(path[-1], then):
            raise MotionFailed("the arm gets there, but could not go on from there")
        return np.array(path)

    # --- checks ---

    def _beside(self, q: np.ndarray, goal: np.ndarray, load: Load) -> frozenset[str]:
        """Names of what the arm is near to at one of the ends of a way."""
        return self.scene.beside(q, load.opening, load.held) | self.scene.beside(goal, load.opening, load.held)

    def _touches(self, q: np.ndarray, load: Load, beside: Collection[str] | None = None) -> Contact | None:
        return self.scene.first_contact(q, load.opening, load.held, load.ignore, load.fingers_may_touch, beside)

    def check(self, q: np.ndarray, load: Load, beside: Collection[str] | None = None) -> None:
        """Require that the arm touches nothing at joints ``q`` (n,).

        Args:
            beside: names of what it may be near to, away from all else; not given, it may be near to all.

        Raises:
            MotionFailed: it touches something; names it.
        """
        contact = self._touches(q, load, beside)
        if contact is not None:
            raise MotionFailed(f"{contact.moving} would touch {contact.other}")


def _path(points: np.ndarray, load: Load) -> JointPath:
    return JointPath((Leg(points, load),))


def _poses_between(start: Pose, end: Pose) -> list[Pose]:
    """Poses on the straight line from ``start`` (left out) to ``end``."""
    turn = Rotation.from_quat(np.roll([start.q, end.q], -1, axis=1))
    angle = (turn[0].inv() * turn[1]).magnitude()
    steps = max(float(np.linalg.norm(end.p - start.p)) / SETTINGS.line_step_m, angle / SETTINGS.line_step_rad)
    count = max(1, int(np.ceil(steps)))
    shares = np.arange(1, count + 1) / count
    quaternions = np.roll(Slerp([0, 1], turn)(shares).as_quat(), 1, axis=1)
    points = start.p + shares[:, None] * (end.p - start.p)
    return [Pose(p, q) for p, q in zip(points, quaternions, strict=True)]


def _coarse_first(points: np.ndarray) -> np.ndarray:
    """(k, n) the same points, every n-th first: collisions are found sooner."""
    stride = SETTINGS.coarse_stride
    return np.concatenate([points[start::stride] for start in range(stride)])


def _between(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(k, n) points from ``a`` to ``b``, spaced for collision checks."""
    count = max(1, int(np.ceil(np.abs(b - a).max() / SETTINGS.joint_step_rad)))
    return a + np.linspace(0, 1, count + 1)[:, None] * (b - a)
