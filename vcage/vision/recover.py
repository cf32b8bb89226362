"""From a pose in the picture to the place of the object in the world."""

from __future__ import annotations

import numpy as np

from vcage.base.geometry import wrap_angle
from vcage.schema.scene import ObjectRecord


def smallest_turn(angle: float, order: int) -> float:
    """The smallest of the turns that look the same on an object of n-fold symmetry (0: round), radians."""
    if order == 0:
        return 0.0
    period = 2 * np.pi / max(order, 1)
    return float((angle + period / 2) % period - period / 2)


def heading_of(record: ObjectRecord, turned: float) -> float:
    """Heading in the world of an object that turned so far since the source picture, radians."""
    return float(wrap_angle(record.pose.pose().yaw + turned))
