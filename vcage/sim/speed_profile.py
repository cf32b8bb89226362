"""Time-optimal trajectories: along a path as fast as the joints allow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.ndimage import minimum_filter1d

from vcage.base.errors import VcageError
from vcage.base.imports import left_out
from vcage.schema.robot import Arm
from vcage.sim.trajectory import Trajectory

with left_out("matplotlib", "pyplot"):  # toppra can plot with it; it takes a third of a stage's import time
    from toppra import SplineInterpolator
    from toppra.algorithm import TOPPRA
    from toppra.constraint import DiscretizationType, LinearConstraint


@dataclass(frozen=True)
class ProfileSettings:
    """Grid of the speed profile.

    Args:
        nearest_rad: points of a path that are nearer to the one before are dropped: a bend there would take the arm
            nearly to rest.
        same_rad: points that are no farther apart are the same.
        spacing_s: of the grid points, seconds at full speed.
        least_points, most_points: of the grid. Points of the path that are nearer to each other than the grid's are
            added.
        same_share: share of the grid's spacing below which two of its points are one.
        checks: places between two grid points at which the limits are checked too.
        rounds: the profile is slowed at checked places beyond the limits and optimised again so often. Measured on
            the 12 paths of an episode: 17.1 s so, 20.4 s when each path is slowed as a whole by its worst place, and
            16.6 s without the check.
    """

    nearest_rad: float = 3e-4
    same_rad: float = 1e-6
    spacing_s: float = 0.006
    least_points: int = 30
    most_points: int = 300
    same_share: float = 1e-3
    checks: int = 4
    rounds: int = 2


SETTINGS = ProfileSettings()


class JointLimits(Protocol):
    """Limits of joints: of an arm (:class:`vcage.schema.robot.Arm`), or of several together."""

    @property
    def speeds(self) -> Sequence[float]:
        """(n,) rad/s."""

    @property
    def accelerations(self) -> Sequence[float]:
        """(n,) rad/s²."""

    @property
    def jerks(self) -> Sequence[float]:
        """(n,) rad/s³."""


@dataclass(frozen=True)
class ArmsTogether:
    """The limits of several arms whose joints move as one.

    Args:
        arms: in the order of their joints.
    """

    arms: tuple[Arm, ...]

    @property
    def speeds(self) -> list[float]:
        """(n,) rad/s."""
        return [limit for arm in self.arms for limit in arm.speeds]

    @property
    def accelerations(self) -> list[float]:
        """(n,) rad/s²."""
        return [limit for arm in self.arms for limit in arm.accelerations]

    @property
    def jerks(self) -> list[float]:
        """(n,) rad/s³."""
        return [limit for arm in self.arms for limit in arm.jerks]


def time_optimal(path: np.ndarray, hz: float, arm: JointLimits, speed: float | np.ndarray = 1.0) -> Trajectory:
    """Pass through the points of ``path`` from rest to rest in the shortest time that the joints' limits allow.

    TOPP-RA (Pham and Pham, 2018) finds the fastest profile along a cubic spline within the limits of speed and
    acceleration. A moving average over the time in which the jerk limit lets an acceleration turn into its opposite
    then bounds the jerk (Biagiotti and Melchiorri, 2012), and as a mean it keeps the other two. It cuts a bend by no
    more than a twenty-fourth of acceleration × time².

    Args:
        path: (k, n) joints, rad, k ≥ 1; points that are hardly apart are taken as one.
        hz: samples per second.
        arm: whose joints they are, or arms that move together; its limits hold for each joint.
        speed: share of the speed limit, in (0, 1], at all points or (k,) at each; accelerations keep its square and
            jerks its cube, so that half the speed takes twice as long.

    Raises:
        VcageError: no profile was found.
    """
    path = np.asarray(path, dtype=np.float64)
    kept = _apart(path)
    path, share = path[kept], np.broadcast_to(speed, len(path))[kept]
    if len(path) == 1:
        return Trajectory(path.copy(), np.zeros_like(path), np.zeros_like(path))
    fastest, strongest, hardest = (np.array(limit) for limit in (arm.speeds, arm.accelerations, arm.jerks))
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0) / fastest, axis=1))])
    limits = _Limits(along, share, fastest, strongest)
    profile = _Profile.fastest(SplineInterpolator(along, path, bc_type="natural"), limits)
    window = int(np.ceil(hz * (2 * strongest / hardest).max() / share.min() - 1e-9))
    return _smoothed(path[0], profile.samples(hz, limits), max(1, window))


def _apart(path: np.ndarray) -> list[int]:
    """Indices of the points of a path without those that are too near to the one before; the last is kept."""
    kept = [0]
    for i in range(1, len(path)):
        if np.abs(path[i] - path[kept[-1]]).max() > SETTINGS.nearest_rad:
            kept.append(i)
    end = len(path) - 1
    if kept[-1] != end and np.abs(path[end] - path[kept[-1]]).max() > SETTINGS.same_rad:
        kept[1:] = [*kept[1:-1], end]
    return kept


class _Limits(LinearConstraint):
    """Speed and acceleration of each joint along a path, each divided by its limit: |q″ṡ² + q′s̈| ≤ 1, |q′ṡ| ≤ 1."""

    def __init__(self, along: np.ndarray, share: np.ndarray, speed: np.ndarray, acceleration: np.ndarray):
        super().__init__()
        self.discretization_type = DiscretizationType.Collocation
        self.identical = True
        self.dof = len(speed)
        self._along, self._share, self._speed, self._acceleration = along, share, speed, acceleration
        self.used: np.ndarray | float = 1.0
        """Share of ``share`` that the profile may use at each grid point."""

    def share(self, s: np.ndarray) -> np.ndarray:
        """(N,) of the speed limit."""
        return np.interp(s, self._along, self._share)

    def scaled(
        self, path: SplineInterpolator, s: np.ndarray, share: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(N, n) q′ over ``share`` of the speed limits; q′ and q″ over share² of the acceleration limits."""
        first, second = path(s, 1), path(s, 2)
        strongest = self._acceleration * share[:, None] ** 2
        return first / (self._speed * share[:, None]), first / strongest, second / strongest

    def compute_constraint_params(
        self, path: SplineInterpolator, gridpoints: np.ndarray
    ) -> tuple[np.ndarray | None, ...]:
        """The coefficients of toppra's ``LinearConstraint``: F (a s̈ + b ṡ² + c) ≤ g, and the bounds of ṡ²."""
        # The limits of a grid point hold on the way there, too.
        share = minimum_filter1d(self.share(gridpoints) * self.used, 3, mode="nearest")
        speed, first, second = self.scaled(path, gridpoints, share)
        identity = np.eye(self.dof)
        fastest = np.maximum(np.abs(speed).max(axis=1), 1e-6) ** -2.0
        bound = np.stack([np.zeros_like(fastest), fastest], axis=1)
        return first, second, np.zeros_like(first), np.vstack([identity, -identity]), np.ones(2 * self.dof), None, bound


@dataclass(frozen=True)
class _Profile:
    """Speed along a path: constant acceleration between the points of a grid.

    Args:
        path: over s.
        s, speed: (N,) grid, and ds/dt there.
    """

    path: SplineInterpolator
    s: np.ndarray
    speed: np.ndarray

    @classmethod
    def fastest(cls, path: SplineInterpolator, limits: _Limits) -> _Profile:
        """The fastest profile within limits, from rest to rest.

        Raises:
            VcageError: there is none.
        """
        s = _grid(np.asarray(path.ss_waypoints))
        profile = cls._on(path, s, limits)
        for _ in range(SETTINGS.rounds):
            excess = np.maximum(profile.excess(limits), 1.0)
            if excess.max() == 1.0:
                break
            limits.used = limits.used / np.maximum(np.append(excess, 1.0), np.append(1.0, excess))
            profile = cls._on(path, s, limits)
        return profile

    @classmethod
    def _on(cls, path: SplineInterpolator, s: np.ndarray, limits: _Limits) -> _Profile:
        _, speed, _ = TOPPRA([limits], path, gridpoints=s, solver_wrapper="seidel").compute_parameterization(0, 0)
        if speed is None or not np.all(np.isfinite(speed)):
            raise VcageError("no profile of speed was found for a path")
        return cls(path, s, speed)

    def samples(self, hz: float, limits: _Limits) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(T, n) positions, velocities and accelerations, slowed by the largest remaining excess."""
        times = self._times()
        slower = max(1.0, float(self.excess(limits).max()))
        count = max(2, int(np.ceil(slower * times[-1] * hz)))
        slower = count / hz / times[-1]
        s, ds, dds = self._at(np.arange(1, count + 1) / count * times[-1], times)
        first, second = self.path(s, 1), self.path(s, 2)
        velocity = first * ds[:, None] / slower
        acceleration = (second * ds[:, None] ** 2 + first * dds[:, None]) / slower**2
        return self.path(s), velocity, acceleration

    def excess(self, limits: _Limits) -> np.ndarray:
        """(N − 1,) factor by which it is too fast between two grid points; at most 1 where all limits hold."""
        times = self._times()
        t = times[:-1, None] + np.diff(times)[:, None] * np.linspace(0.0, 0.999, SETTINGS.checks + 2)
        s, ds, dds = self._at(t.ravel(), times)
        speed, first, second = limits.scaled(self.path, s, limits.share(s))
        strength = np.abs(second * ds[:, None] ** 2 + first * dds[:, None]).max(axis=1)
        return np.maximum(np.abs(speed * ds[:, None]).max(axis=1), np.sqrt(strength)).reshape(t.shape).max(axis=1)

    def _times(self) -> np.ndarray:
        """(N,) times at the grid points."""
        return np.concatenate([[0.0], np.cumsum(2 * np.diff(self.s) / (self.speed[1:] + self.speed[:-1]))])

    def _at(self, t: np.ndarray, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """s and its two derivatives at times."""
        change = np.diff(self.speed) / np.diff(times)
        i = np.clip(np.searchsorted(times, t, side="right") - 1, 0, len(change) - 1)
        dt = t - times[i]
        return self.s[i] + dt * (self.speed[i] + dt * change[i] / 2), self.speed[i] + dt * change[i], change[i]


def _grid(along: np.ndarray) -> np.ndarray:
    """(N,) grid of a path: even, with the points of the path where they are nearer to each other than the grid's.

    The acceleration of a cubic spline is largest at its points, and an even grid would miss what is between two.
    """
    count = np.clip(np.ceil(along[-1] / SETTINGS.spacing_s), SETTINGS.least_points, SETTINGS.most_points)
    even = np.linspace(0.0, along[-1], int(count) + 1)
    short = np.diff(along) < even[1]
    near = along[np.append(short, False) | np.append(False, short)]
    grid = np.unique(np.concatenate([even, near]))
    kept = np.append(np.diff(grid) > SETTINGS.same_share * even[1], True)
    kept[0] = True  # the profile begins at the beginning
    return grid[kept]


def _smoothed(start: np.ndarray, samples: tuple[np.ndarray, np.ndarray, np.ndarray], window: int) -> Trajectory:
    """The moving average over the last ``window`` samples, until all is at rest."""
    means = []
    for values, before, after in zip(samples, (start, 0.0, 0.0), (samples[0][-1], 0.0, 0.0), strict=True):
        rows = [np.broadcast_to(x, (window - 1, len(start))) for x in (before, after)]
        padded = np.concatenate([np.zeros((1, len(start))), rows[0], values, rows[1]]).cumsum(axis=0)
        means.append((padded[window:] - padded[:-window]) / window)
    q, velocity, acceleration = means
    velocity[-1] = acceleration[-1] = 0.0
    return Trajectory(q, velocity, acceleration)
