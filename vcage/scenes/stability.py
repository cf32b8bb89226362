"""Limits on what settling may do to objects, and the figures of it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from vcage.sim.state import SettleReport


@dataclass(frozen=True)
class StabilityLimits:
    """The most that settling may move an object that stays where it was put."""

    drift_m: float = 0.005
    tilt_rad: float = math.radians(4)


STABILITY = StabilityLimits()


def moved_objects(report: SettleReport) -> list[str]:
    """Ids of the objects that did not stay where they were put."""
    return [
        name
        for name, drift in report.drift_m.items()
        if drift > STABILITY.drift_m or report.tilt_rad[name] > STABILITY.tilt_rad
    ]


def settle_checks(report: SettleReport) -> dict[str, float]:
    """Steps and largest motion of settling, for the checks of a scene."""
    return {
        "settle_steps": report.steps,
        "largest_drift_mm": round(1000 * max(report.drift_m.values()), 3),
        "largest_tilt_deg": round(float(np.degrees(max(report.tilt_rad.values()))), 3),
    }
