"""Joint paths before timing: consecutive legs, and the bends that join them without a stop."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vcage.sim.collision import Held


@dataclass(frozen=True)
class Load:
    """The state of the hand while it moves.

    Args:
        opening: of the gripper, 0 closed to 1 open.
        held: the object in it.
        ignore: obstacles that may be touched (see :meth:`CollisionScene.first_contact`).
        fingers_may_touch: obstacles that the fingers may touch, and nothing else of the arm.
        speed: share of the speed limit.
    """

    opening: float = 1.0
    held: Held | None = None
    ignore: Collection[str] = ()
    speed: float = 1.0
    fingers_may_touch: Collection[str] = ()

    def above(self, clearance: float) -> Load:
        """The same load with a clearance below the held object, metres."""
        return self if self.held is None else replace(self, held=replace(self.held, clearance=clearance))


OPEN_HAND = Load()
"""An empty hand that may touch nothing."""


@dataclass(frozen=True)
class Leg:
    """A free piece of a path.

    Args:
        points: (k, n) joints, rad, k ≥ 1, so near to each other that no obstacle fits between them.
        load: state of the hand.
        opens: command for the gripper at the start of the leg, 0 closed to 1 open; None for no command.
    """

    points: np.ndarray
    load: Load
    opens: float | None = None


@dataclass(frozen=True)
class JointPath:
    """Legs, each beginning at the end of the one before."""

    legs: tuple[Leg, ...]

    @property
    def end(self) -> np.ndarray:
        """(n,) joints at the end."""
        return self.legs[-1].points[-1]

    def then(self, other: JointPath) -> JointPath:
        """The concatenation of this path and another."""
        return JointPath((*self.legs, *other.legs))

    def points(self) -> np.ndarray:
        """(k, n) of all legs."""
        return np.concatenate([leg.points for leg in self.legs])


@dataclass(frozen=True)
class Stretch:
    """A part of a path that is passed without a stop.

    Args:
        points: (k, n) joints, rad.
        speed: (k,) share of the speed limit at each.
        opens: (index of a point, opening) commands for the gripper.
    """

    points: np.ndarray
    speed: np.ndarray
    opens: tuple[tuple[int, float], ...]


def stretches(path: JointPath, free: Callable[[np.ndarray, Load], bool]) -> Iterator[Stretch]:
    """The parts of a path between stops: corners are bent if the bend is free, and are stops otherwise.

    Args:
        path: its legs are free.
        free: True for joints (n,) that are free with the load of a leg.
    """
    legs = [leg for leg in path.legs if _length(leg.points) > 1e-6] or [path.legs[-1]]
    points, speed, opens = legs[0].points, _speeds(legs[0]), _commands(legs[0], 0)
    for before, after in itertools.pairwise(legs):
        bent = _bent(points, before, after, free)
        if bent is None:
            yield Stretch(points, speed, opens)
            points, speed, opens = after.points, _speeds(after), _commands(after, 0)
            continue
        head, bend, tail = bent
        slower = np.full(len(bend), min(before.load.speed, after.load.speed))
        opens += _commands(after, len(head) + len(bend))
        points = np.concatenate([head, bend, tail])
        speed = np.concatenate([speed[: len(head)], slower, np.full(len(tail), after.load.speed)])
    yield Stretch(points, speed, opens)


def _bent(
    points: np.ndarray,
    before: Leg,
    after: Leg,
    free: Callable[[np.ndarray, Load], bool],
    shares: Sequence[float] = (0.5, 0.25, 0.12),
) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """The remaining points of both legs and the widest free bend between them: (head, bend, tail).

    Args:
        shares: of the shorter leg that the bend may take, the widest first.
    """
    alike = replace(after.load, speed=before.load.speed) == before.load
    loads = [before.load] if alike else [before.load, after.load]
    # Of a leg between two bends, each may take half.
    shorter = min(_length(before.points), _length(after.points))
    for share in shares:
        head, start = _without_end(points, share * shorter)
        tail, end = _without_end(after.points[::-1], share * shorter)
        bend = _bend(start, after.points[0], end)
        if all(free(q, load) for load in loads for q in bend):
            return head, bend, tail[::-1]
    return None


def _bend(start: np.ndarray, corner: np.ndarray, end: np.ndarray, count: int = 7) -> np.ndarray:
    """(count, n) points of the parabola that touches both legs."""
    t = np.linspace(0, 1, count)[:, None]
    return (1 - t) ** 2 * start + 2 * t * (1 - t) * corner + t**2 * end


def _without_end(points: np.ndarray, length: float) -> tuple[np.ndarray, np.ndarray]:
    """The points without the last ``length`` of the way, and the point of the cut."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)[::-1]
    passed = np.cumsum(steps)
    cut = min(int(np.searchsorted(passed, length)), len(steps) - 1)
    share = (passed[cut] - length) / steps[cut]
    last = len(points) - 2 - cut
    head = points[: last + 1] if share > 1e-6 else points[:last]
    return head, points[last] + max(share, 0.0) * (points[last + 1] - points[last])


def _length(points: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def _speeds(leg: Leg) -> np.ndarray:
    return np.full(len(leg.points), leg.load.speed)


def _commands(leg: Leg, index: int) -> tuple[tuple[int, float], ...]:
    return () if leg.opens is None else ((index, leg.opens),)
