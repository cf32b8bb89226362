"""Contacts of an arm and its load on their way: any but the allowed ones ends the attempt."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Literal

import numpy as np

from vcage.base.geometry import Pose
from vcage.sim.world import PHYSICS_HZ, World

By = Literal["load", "fingers", "hand"]
"""The toucher: the held object or what lies in it, the fingers, or any link of the arm."""


@dataclass(frozen=True)
class TouchSettings:
    """When a contact counts, and which pairs may touch.

    Args:
        every_steps: physics steps between two looks; a contact that harms lasts longer than five (20 ms).
        least_force_n: weaker contacts are grazes, newtons. Ordinary successful runs of the paper's tasks have none.
        beside_m: objects with boxes closer than this may touch, metres.
        near_m: an allowance around a point holds while the gripper is this near to it, seen from above, metres.
    """

    every_steps: int = 5
    least_force_n: float = 1.0
    beside_m: float = 0.003
    near_m: float = 0.03


SETTINGS = TouchSettings()


@dataclass(frozen=True)
class Allowance:
    """An allowed contact on a motion, or on the part of it that is near a point.

    Args:
        by: the touching side; the fingers may touch everything the hand may.
        others: ids of objects, ``table``, or the name of another arm.
        around: where the gripper is then; anywhere when None.
    """

    by: By
    others: frozenset[str]
    around: Pose | None = None

    def allows(self, by: By, other: str, gripper: Pose) -> bool:
        """Check if something may touch ``other`` while the gripper is at a pose."""
        if other not in self.others or by not in ((self.by, "fingers") if self.by == "hand" else (self.by,)):
            return False
        return self.around is None or float(np.linalg.norm((gripper.p - self.around.p)[:2])) <= SETTINGS.near_m


def at_rest(gripper: Pose, object_id: str, beside: Iterable[str]) -> list[Allowance]:
    """Return the contacts that are allowed where an object is taken or put down.

    Args:
        gripper: its pose there.
        object_id: the object to take or put down: the whole hand may touch it.
        beside: its containers, supports and neighbours then: it and the fingers may touch them.
    """
    others = frozenset(beside)
    return [
        Allowance("hand", frozenset([object_id]), gripper),
        Allowance("fingers", others, gripper),
        Allowance("load", others, gripper),
    ]


class Touched(Exception):
    """An arm or its load presses on something it may not touch.

    Args:
        by: what touches.
        name: id of the object, or the name of the arm.
        other: id of an object, ``table``, or the name of another arm.
    """

    def __init__(self, by: By, name: str, other: str):
        super().__init__(by, name, other)
        self.by = by
        self.name = name
        self.other = other


@contextmanager
def only_touching(
    world: World, arm: str, load: str | None, allowed: Sequence[Allowance], contents: Collection[str] = ()
) -> Iterator[None]:
    """Watch the contacts of an arm and its load while the block inside runs.

    Args:
        world: where it moves.
        arm: its name.
        load: id of the held or pushed object, if any.
        allowed: the allowed contacts.
        contents: ids of the load's contents: they may touch the hand and each other, and everything the load may.

    Raises:
        Touched: something else is touched.
    """
    fingers = {finger.name for finger in world.arms[arm].fingers}
    loads = set() if load is None else {load, *contents}
    ours = {arm, *loads}

    def look(world: World) -> None:
        if world.steps % SETTINGS.every_steps:
            return
        for mine, other, impulse in world.presses(ours):
            if impulse * PHYSICS_HZ < SETTINGS.least_force_n:
                continue
            owner, _, link = mine.partition("/")
            by: By = "load" if owner in loads else "fingers" if link in fingers else "hand"
            other = other.partition("/")[0]
            if other in ours:
                continue
            if not any(a.allows(by, other, world.arms[arm].tool_pose) for a in allowed):
                raise Touched(by, owner, other)

    world.before_step.append(look)
    try:
        yield
    finally:
        world.before_step.remove(look)
