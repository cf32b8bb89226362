"""What settling may do to objects that were put somewhere, and what was measured of it."""

from __future__ import annotations

import numpy as np

from vcage.sim.state import SettleReport

MAX_DRIFT, MAX_TILT = 0.005, np.radians(4)
"""What settling may move an object by: metres, radians."""


def moved_objects(report: SettleReport) -> list[str]:
    """Ids of the objects that did not stay where they were put."""
    return [key for key in report.drift_m if report.drift_m[key] > MAX_DRIFT or report.tilt_rad[key] > MAX_TILT]


def settle_checks(report: SettleReport) -> dict[str, float]:
    """How long it took and how far it went, for the checks of a scene."""
    return {
        "settle_steps": report.steps,
        "largest_drift_mm": round(1000 * max(report.drift_m.values()), 3),
        "largest_tilt_deg": round(float(np.degrees(max(report.tilt_rad.values()))), 3),
    }
