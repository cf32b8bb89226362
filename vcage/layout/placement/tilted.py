"""The headings and heights that a tilted hand must reach where no arm reaches straight down."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from vcage.objects.asset import Asset
from vcage.schema.scene import Role

YAWS = tuple(np.radians(degrees) for degrees in (0.0, 45.0, 90.0, 135.0))
"""Headings of the gripper that one arm must reach at a point; half a turn on is the same grasp."""

EITHER = ((0, 1), (0, 3), (2, 1), (2, 3))
"""Sets of them, by number, of which one is enough for a hand that may also turn by a quarter."""


@dataclass(frozen=True)
class TiltSettings:
    """Settings of tilted hands.

    Args:
        height_step_m: between the heights of their maps.
        crosswise_cos: largest cosine between two directions that are about a quarter turn apart.
    """

    height_step_m: float = 0.03
    crosswise_cos: float = 0.3


SETTINGS = TiltSettings()


@dataclass(frozen=True)
class Tilted:
    """Demands on a tilted hand where an object stands.

    Args:
        headings: sets of numbers of :data:`YAWS`; all headings of one of the sets.
        higher: how much higher than the lowest grasp it lets go of what it brings, metres.
    """

    headings: tuple[tuple[int, ...], ...] = (tuple(range(len(YAWS))),)
    higher: float = 0.0

    @classmethod
    def of(cls, asset: Asset, role: Role, yaw: float | None = None) -> Tilted:
        """Return what it takes to move an object, or to put something into it.

        A hand may choose its heading where it puts something down, and where it takes what it can close on in two
        directions, such as a block.

        Args:
            asset, role: of the object.
            yaw: its heading, where that is known.
        """
        kind = asset.annotation
        if role == "receptacle":
            rims = [asset.opening(point).rim for point in kind.functional_points if point.link is None]
            # Rounded up, so that things of about one height share a map.
            return cls(
                EITHER, float(np.ceil(max(rims, default=0.0) / SETTINGS.height_step_m - 1e-9)) * SETTINGS.height_step_m
            )
        closings = [np.array(point.closing[:2]) for point in kind.carrying_points]
        if yaw is not None and closings:
            return cls(tuple(sorted({_beside(yaw + float(np.arctan2(y, x))) for x, y in closings})))
        crosswise = any(abs(float(a @ b)) < SETTINGS.crosswise_cos for a, b in itertools.combinations(closings, 2))
        return cls(EITHER) if crosswise else cls()


def _beside(heading: float) -> tuple[int, ...]:
    """Numbers of the :data:`YAWS` to both sides of where the fingers close along, or of the one that it is."""
    turns = (heading - np.pi / 2) % np.pi / (np.pi / len(YAWS))  # at heading 0 they close along y
    sides = {int(np.floor(turns + 1e-6)), int(np.ceil(turns - 1e-6))}
    return tuple(sorted(side % len(YAWS) for side in sides))
