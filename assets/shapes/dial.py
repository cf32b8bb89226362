"""Dials and knobs that a hand turns clockwise by their grip."""

from __future__ import annotations

from vcage.schema.asset import Joint


def dial_joint(origin: tuple[float, float, float]) -> Joint:
    """The joint of a dial that lies flat: it turns by 1.6 rad, and stays where it was left."""
    return Joint(
        kind="turn",
        origin=origin,
        axis=(0.0, 0.0, -1.0),
        lower=0.0,
        upper=1.6,
        damping=0.3,
        friction=0.08,
    )
