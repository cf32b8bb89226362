"""Check 2: placed upright on the table, an object settles at once and stays where it was put."""

from __future__ import annotations

import numpy as np

from vcage.base.geometry import Pose
from vcage.objects.asset import Asset
from vcage.schema.proof import Check
from vcage.schema.scene import Table
from vcage.sim.bodies import Body
from vcage.sim.world import PHYSICS_HZ, World

SETTLE_STEPS = PHYSICS_HZ // 2
WATCH_STEPS = PHYSICS_HZ
"""How long it is watched after it settled, physics steps."""

DRIFT, TILT = 0.002, np.radians(2)
"""Allowed movement: metres, radians."""


def check_rest(asset: Asset, table: Table, yaw: float) -> Check:
    """Stand an asset on the table and watch it."""
    placed = Pose.from_yaw([*table.centre, table.height], yaw)
    world = World(table, {"object": Body(asset.model, placed)})
    report = world.settle(max_steps=SETTLE_STEPS)
    world.step(WATCH_STEPS)
    pose, joints = world.object_pose("object"), world.object_joints("object")
    drift = float(np.linalg.norm(pose.p - placed.p))
    tilt = float(np.arccos(np.clip(pose.rotation()[:, 2] @ placed.rotation()[:, 2], -1, 1)))
    reasons = []
    if not report.settled:
        reasons.append(f"not at rest after {SETTLE_STEPS / PHYSICS_HZ:g} s")
    if drift > DRIFT:
        reasons.append(f"moved {1000 * drift:.1f} mm")
    if tilt > TILT:
        reasons.append(f"tilted {np.degrees(tilt):.1f}°")
    for link, q in zip(asset.model.links, joints, strict=True):
        if abs(q) > 0.03 * (link.joint.upper - link.joint.lower):
            reasons.append(f"{link.name} moved by itself to {q:.3f}")
    measured = {
        "seconds": report.steps / PHYSICS_HZ,
        "drift_mm": round(1000 * drift, 3),
        "tilt_deg": round(np.degrees(tilt), 3),
    }
    return Check(check="rest", passed=not reasons, succeeded=int(not reasons), measured=measured, reasons=reasons)
