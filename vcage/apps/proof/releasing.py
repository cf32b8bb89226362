"""Checks 2 and 4, without a robot: an object stays where it stands, and a probe stays where it is released."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from vcage.apps.proof.trials import OBJECT, scene_object, tried
from vcage.base.files import atomic_folder, cache_path
from vcage.base.geometry import Pose, tilt_between
from vcage.objects.asset import Asset
from vcage.objects.model import read_model, write_model
from vcage.objects.modelling import solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint
from vcage.objects.openings import Opening
from vcage.schema.asset import Annotation, FunctionalPoint, Variant, Words
from vcage.schema.proof import ProofCheck
from vcage.schema.scene import Table
from vcage.sim.bodies import Body
from vcage.sim.joints import link_poses
from vcage.sim.world import PHYSICS_HZ, World
from vcage.tasks.state import place_complaint


@dataclass(frozen=True)
class ReleaseSettings:
    """Settings of checks 2 and 4.

    Args:
        settle_steps: physics steps in which an object must come to rest.
        watch_steps: physics steps for which it is watched after it settled.
        max_drift_m: allowed movement meanwhile.
        max_tilt_rad: allowed turn meanwhile.
        max_probe_m: edge of the probe, a cube.
        min_probe_m: edge of the probe, a cube.
        probe_share: of the room, at most, that the probe's edge takes.
        release_height_m: above the rim, or above the surface.
        scatter_m: distance of the release from the point, at most, along each axis.
        max_tip_rad: tilt of the object under the probe.
    """

    settle_steps: int = PHYSICS_HZ // 2
    watch_steps: int = PHYSICS_HZ
    max_drift_m: float = 0.002
    max_tilt_rad: float = np.radians(2)
    max_probe_m: float = 0.03
    min_probe_m: float = 0.012
    probe_share: float = 0.6
    release_height_m: float = 0.005
    scatter_m: float = 0.01
    max_tip_rad: float = np.radians(5)


SETTINGS = ReleaseSettings()

PROBE = "probe"


def check_rest(asset: Asset, table: Table, yaw: float) -> ProofCheck:
    """Stand an asset on the table and watch it.

    Args:
        asset: the tested asset.
        table: that it stands on.
        yaw: its heading, radians.
    """
    placed = Pose.from_yaw([*table.centre, table.height], yaw)
    world = World(table, {OBJECT: Body(asset.model, placed)})
    report = world.settle(max_steps=SETTINGS.settle_steps)
    world.step(SETTINGS.watch_steps)
    pose, joints = world.object_pose(OBJECT), world.object_joints(OBJECT)
    drift = float(np.linalg.norm(pose.p - placed.p))
    tilt = tilt_between(pose, placed)
    reasons = []
    if not report.settled:
        reasons.append(f"not at rest after {SETTINGS.settle_steps / PHYSICS_HZ:g} s")
    if drift > SETTINGS.max_drift_m:
        reasons.append(f"moved {1000 * drift:.1f} mm")
    if tilt > SETTINGS.max_tilt_rad:
        reasons.append(f"tilted {np.degrees(tilt):.1f}°")
    for link, q in zip(asset.model.links, joints, strict=True):
        if abs(q) > 0.03 * (link.joint.upper - link.joint.lower):
            reasons.append(f"{link.name} moved by itself to {q:.3f}")
    measured = {
        "seconds": report.steps / PHYSICS_HZ,
        "drift_mm": round(1000 * drift, 3),
        "tilt_deg": round(np.degrees(tilt), 3),
    }
    return ProofCheck(check="rest", passed=not reasons, succeeded=int(not reasons), measured=measured, reasons=reasons)


def check_functional(asset: Asset, point: FunctionalPoint, table: Table, tries: int, seed: int) -> ProofCheck:
    """Release probes over a functional point; the parts that cover it are opened first.

    Args:
        asset: the tested asset.
        point: of the asset.
        table: that it stands on.
        tries: how often.
        seed: of all places.
    """
    subject = f"{point.id} {point.name}"
    try:
        opening = asset.opening(point)
    except ValueError as error:
        return ProofCheck(check="functional_point", subject=subject, passed=False, tries=0, reasons=[str(error)])
    rng = np.random.default_rng([seed, 1000 + point.id])
    edge = float(np.clip(SETTINGS.probe_share * min(opening.size), SETTINGS.min_probe_m, SETTINGS.max_probe_m))

    def trial(_number: int) -> str | None:
        return _try(asset, point, opening, probe_cube(round(edge, 3)), table, rng)

    measured = {"room_x_cm": 100 * opening.size[0], "room_y_cm": 100 * opening.size[1], "depth_cm": 100 * opening.depth}
    measured |= {"probe_mm": 1000 * edge}
    rounded = {name: round(value, 2) for name, value in measured.items()}
    return tried("functional_point", subject, tries, trial, rounded)


def _try(
    asset: Asset, point: FunctionalPoint, opening: Opening, cube: Asset, table: Table, rng: np.random.Generator
) -> str | None:
    joints = _out_of_the_way(asset, point)
    standing = Pose.from_yaw([*table.centre, table.height], rng.uniform(-np.pi, np.pi))
    carrier = standing * link_poses(asset.model, joints)[point.link]
    start = carrier * _release(point, opening, cube, rng)
    bodies = {OBJECT: Body(asset.model, standing, joints), PROBE: Body(cube.model, start)}
    world = World(table, bodies)
    world.settle(max_steps=2 * PHYSICS_HZ)
    now = world.object_pose(OBJECT)
    tilt = tilt_between(now, Pose())
    if tilt > SETTINGS.max_tip_rad:
        return f"the object tipped by {np.degrees(tilt):.0f}°"
    receptacle = scene_object(asset, now, role="receptacle").moved(now, tuple(world.object_joints(OBJECT).tolist()))
    return place_complaint(scene_object(cube, world.object_pose(PROBE), PROBE), receptacle, point)


def _out_of_the_way(asset: Asset, point: FunctionalPoint) -> tuple[float, ...]:
    """Return joint positions in which nothing covers the point.

    A drawer that holds is pulled out alone; before the body's inside everything is opened; a surface is at rest.
    """
    if point.link is not None:
        opened = {point.link}
    else:
        opened = {link.name for link in asset.model.links} if point.holds == "in" else set()
    return tuple(link.joint.far_end if link.name in opened else 0.0 for link in asset.model.links)


def _release(point: FunctionalPoint, opening: Opening, cube: Asset, rng: np.random.Generator) -> Pose:
    """Return the pose of release of the probe, in the frame of the part that receives it."""
    half = np.array(opening.size) / 2 - cube.footprint * np.sqrt(2) / 2
    spread = np.clip(half, 0.0, SETTINGS.scatter_m)
    x, y = np.clip(point.position[:2], opening.centre - np.maximum(half, 0), opening.centre + np.maximum(half, 0))
    x, y = np.array([x, y]) + rng.uniform(-spread, spread)
    height = opening.floor if point.sideways else max(opening.floor, opening.rim)
    return Pose.from_yaw([x, y, height + SETTINGS.release_height_m], rng.uniform(-np.pi, np.pi))


@functools.cache
def probe_cube(edge: float) -> Asset:
    """A wooden cube of that edge, metres."""
    folder = cache_path("probes", f"cube-{1000 * edge:.0f}-1")
    if not folder.is_dir():
        cube = solids.box((edge, edge, edge))
        wood = paint(cube, np.full((8, 8, 3), 170, dtype=np.uint8), tiled(0.1))
        with atomic_folder(folder) as part:
            write_model(BuiltObject([wood], [cube], mass=600 * edge**3, friction=0.6), part)
    words = Words(name="probe", plural="probes", description="A wooden cube.", category="probe")
    variant = Variant(id="plain", colour="grey")
    return Asset(Annotation(name=PROBE, words=words, variants=[variant]), variant, read_model(folder))
