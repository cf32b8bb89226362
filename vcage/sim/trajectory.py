"""From the points of a joint path to a timed, smooth command for every physics step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from vcage.schema.robot import Arm


@dataclass(frozen=True)
class Trajectory:
    """Joint targets, one for each physics step, at rest at both ends.

    Args:
        q: (T, n) positions, rad.
        velocity: (T, n) rad/s.
    """

    q: np.ndarray
    velocity: np.ndarray

    def __len__(self) -> int:
        return len(self.q)

    @property
    def end(self) -> np.ndarray:
        """(n,) joints at the end."""
        return self.q[-1]

    def then(self, other: Trajectory) -> Trajectory:
        """This one, and the other after it."""
        return Trajectory(np.concatenate([self.q, other.q]), np.concatenate([self.velocity, other.velocity]))


def minimum_jerk(path: np.ndarray, hz: float, arm: Arm, speed: float = 1.0) -> Trajectory:
    """Pass through the points of ``path`` from rest to rest, with a minimum-jerk profile along it.

    The profile is the quintic of Flash and Hogan (1985) over a cubic spline; its duration is the shortest that
    keeps every joint within the arm's speed and acceleration.

    Args:
        path: (k, n) joints, rad, k ≥ 1; points that repeat the one before are dropped.
        hz: samples per second.
        arm: whose joints they are.
        speed: share of the speed limit, in (0, 1].
    """
    path = np.asarray(path, dtype=np.float64)
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    path = path[np.concatenate([[True], steps > 1e-6])]
    if len(path) == 1:
        return Trajectory(path.copy(), np.zeros_like(path))
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    curve = CubicSpline(along / along[-1], path, bc_type="natural")
    duration = _duration(curve, arm) / speed
    count = max(2, int(np.ceil(duration * hz)))
    t = np.arange(1, count + 1) / count
    s, ds, _ = _minimum_jerk(t)
    return Trajectory(curve(s), curve(s, 1) * (ds / (count / hz))[:, None])


def _minimum_jerk(t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position and its first two derivatives of 10t³ − 15t⁴ + 6t⁵ for t in [0, 1]."""
    position = t**3 * (10 - 15 * t + 6 * t**2)
    return position, 30 * t**2 * (1 - t) ** 2, 60 * t * (1 - 3 * t + 2 * t**2)


def _duration(curve: CubicSpline, arm: Arm) -> float:
    """Shortest duration in seconds that keeps the limits: on a grid, and at the points of the path, where they peak."""
    fine = np.linspace(0, 1, 4001)
    at_points = np.interp(curve.x, _minimum_jerk(fine)[0], fine)  # the times at which they are passed
    s, ds, dds = _minimum_jerk(np.concatenate([np.linspace(0, 1, 200), at_points]))
    first, second = curve(s, 1), curve(s, 2)
    speed = np.abs(first * ds[:, None]).max()
    acceleration = np.abs(second * (ds**2)[:, None] + first * dds[:, None]).max()
    return float(max(speed / arm.max_speed, np.sqrt(acceleration / arm.max_acceleration)))
