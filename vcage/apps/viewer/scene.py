"""The 3D scene: the table, the objects on it and the robot, each where it was at each time.

The robot is drawn as the solids that physics knows of its links, where the measured joints put them.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np
import sapien
import trimesh
from numpy.typing import NDArray

from vcage.apps.viewer.rerun_log import Clock, RerunLog, entity, rr, xyzw
from vcage.base.drawing import Colour
from vcage.base.errors import AssetLeftOut, UnknownName, VcageError
from vcage.base.geometry import Pose
from vcage.datasets.episode import EpisodeData
from vcage.objects.library import Library
from vcage.schema.asset import PhysicalModel
from vcage.schema.robot import Arm
from vcage.schema.scene import ObjectRecord, Scene, Table
from vcage.sim.arms import build_arm
from vcage.sim.joints import link_poses
from vcage.sim.kinematics import kinematics_of
from vcage.sim.poses import from_sapien
from vcage.sim.robots import load_robot

logger = logging.getLogger(__name__)

WORLD = "world"


@dataclass(frozen=True)
class DrawingSettings:
    """Sizes and colours of the 3D scene.

    Args:
        table_thickness_m: of the drawn table top; the scene knows only its height.
        table_colour: sRGB.
        axes_m: length of the axes that represent an object without a known model or box.
        robot_colour: sRGB.
    """

    table_thickness_m: float = 0.03
    table_colour: Colour = (150, 120, 90)
    axes_m: float = 0.05
    robot_colour: Colour = (190, 195, 205)


DRAWN = DrawingSettings()


def log_table(log: RerunLog, table: Table) -> None:
    """The table top."""
    half = (*np.array(table.size) / 2, DRAWN.table_thickness_m / 2)
    centre = (*table.centre, table.height - DRAWN.table_thickness_m / 2)
    box = rr.Boxes3D(centers=[centre], half_sizes=[half], colors=[DRAWN.table_colour], fill_mode="solid")
    log.always(entity(WORLD, "table"), box)


def log_objects(log: RerunLog, clock: Clock, episode: EpisodeData, scene: Scene | None) -> None:
    """Every object: its model where the library has it, else its box where the scene knows it, else its axes.

    Args:
        log: where it is written.
        clock: when the episode's frames are.
        episode: whose objects.
        scene: the known facts about them; None for their poses only.
    """
    known = [] if scene is None else [one for one in scene.objects if one.id in episode.object_poses]
    records = {record.id: record for record in known}
    models = _models(known)
    for name, poses in episode.object_poses.items():
        where = entity(WORLD, "objects", name)
        record, model = records.get(name), models.get(name)
        log.poses(where, clock, poses[:, :3], poses[:, 3:])
        if model is not None:
            _log_model(log, clock, where, model, episode.object_joints.get(name))
        elif record is not None:
            log.always(where, _box(record, Pose(poses[0, :3], poses[0, 3:])))
        else:
            log.always(where, rr.Transform3D.from_fields(axis_length=DRAWN.axes_m))


def _models(records: Sequence[ObjectRecord]) -> dict[str, PhysicalModel]:
    """Id → model of the objects that the library has."""
    if not records:
        return {}
    library, models = Library.load(), {}
    for record in records:
        try:
            models[record.id] = library.asset(record.asset, record.variant).model
        except (UnknownName, AssetLeftOut) as error:
            logger.warning("%s is drawn as a box: %s", record.id, error.as_line())
    return models


def _log_model(
    log: RerunLog, clock: Clock, where: str, model: PhysicalModel, joints: NDArray[np.float64] | None
) -> None:
    log.always(where, rr.Asset3D(path=Path(model.visual)))
    moved = [] if joints is None else [link_poses(model, row) for row in joints]
    for link in model.links:
        part = f"{where}/{entity(link.name).lstrip('/')}"
        log.always(part, rr.Asset3D(path=Path(link.visual)))
        if moved:
            log.path(part, clock, [poses[link.name] for poses in moved])


def _box(record: ObjectRecord, first: Pose) -> rr.Boxes3D:
    """The scene's axis-aligned box, fixed to the object as it stood at first."""
    lower, upper = np.array(record.aabb)
    back = first.inverse()
    centre = back.apply((lower + upper) / 2)
    return rr.Boxes3D(
        centers=[centre],
        half_sizes=[(upper - lower) / 2],
        quaternions=[xyzw(back.q)],
        labels=[record.phrase],
    )


# --- the robot -----------------------------------------------------------------------------------------


def log_robot(log: RerunLog, clock: Clock, episode: EpisodeData, name: str) -> None:
    """The arms of the robot of that name; a missing or different robot is left out.

    Args:
        log: where it is written.
        clock: when the episode's frames are.
        episode: with measured joints.
        name: of the robot, as :func:`vcage.sim.robots.load_robot` takes it.
    """
    try:
        robot = load_robot(name)
    except VcageError as error:
        logger.warning("the robot is not drawn: %s", error.as_line())
        return
    for side, arm in robot.arms.items():
        columns = [column for column, state in enumerate(episode.state_names) if state.startswith(f"{side}_")]
        if len(columns) != len(arm.joints) + 1:
            logger.warning("the %s arm is not drawn: %s has other joints than the episode", side, name)
            continue
        _log_arm(log, clock, side, arm, episode.qpos[:, columns])


def _log_arm(log: RerunLog, clock: Clock, side: str, arm: Arm, states: np.ndarray) -> None:
    """An arm at states (T, n + 1): joints, and the opening of the gripper."""
    base, kinematics = arm.base.pose(), kinematics_of(arm)
    poses = [kinematics.base_poses(state[:-1], float(state[-1])) for state in states]
    for link, solid in _solids(arm):
        where = entity(WORLD, "robot", side, link)
        log.always(
            where,
            rr.Mesh3D(
                vertex_positions=solid.vertices,
                triangle_indices=solid.faces,
                vertex_normals=solid.vertex_normals,
                albedo_factor=DRAWN.robot_colour,
            ),
        )
        log.path(where, clock, [base * from_sapien(at[link]) for at in poses])


def _solids(arm: Arm) -> Iterator[tuple[str, trimesh.Trimesh]]:
    """Name of each link that has a body, and the union of its shapes in its own frame."""
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    for link in build_arm(scene, arm, visual_faces=None).links:
        pieces = [_solid(shape) for shape in link.collision_shapes]
        if pieces:
            yield link.name, cast("trimesh.Trimesh", trimesh.util.concatenate(pieces))  # as all pieces are


def _solid(shape: sapien.physx.PhysxCollisionShape) -> trimesh.Trimesh:
    """With flat faces, as their edges are what shows the form."""
    if isinstance(shape, sapien.physx.PhysxCollisionShapeBox):
        mesh = trimesh.creation.box(extents=2 * np.asarray(shape.half_size))
    else:
        hull = cast("sapien.physx.PhysxCollisionShapeConvexMesh", shape)  # a link has no other solids
        mesh = trimesh.Trimesh(np.asarray(hull.vertices) * hull.scale, hull.triangles, process=False)
    mesh.unmerge_vertices()
    mesh.apply_transform(from_sapien(shape.local_pose).matrix())
    return mesh
