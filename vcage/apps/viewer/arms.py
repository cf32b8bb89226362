"""The robot in the 3D scene: the solids that physics knows of its links, where the measured joints put them."""

from __future__ import annotations

import logging
from collections.abc import Iterator

import numpy as np
import sapien
import trimesh

from vcage.apps.viewer.log import Clock, Journal, entity
from vcage.apps.viewer.objects import WORLD
from vcage.apps.viewer.sdk import rr
from vcage.base.errors import VcageError
from vcage.datasets.episode import EpisodeData
from vcage.schema.robot import Arm
from vcage.sim.arms import build_arm
from vcage.sim.kinematics import kinematics_of
from vcage.sim.poses import from_sapien
from vcage.sim.robots import load_robot

logger = logging.getLogger(__name__)

COLOUR = (190, 195, 205)


def log_robot(journal: Journal, clock: Clock, episode: EpisodeData, name: str) -> None:
    """The arms of the robot of that name; one that is not here, or not the one that was recorded, is left out."""
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
        _log_arm(journal, clock, side, arm, episode.qpos[:, columns])


def _log_arm(journal: Journal, clock: Clock, side: str, arm: Arm, states: np.ndarray) -> None:
    """An arm at states (T, n + 1): joints, and the opening of the gripper."""
    base, kinematics = arm.base.pose(), kinematics_of(arm)
    poses = [kinematics.base_poses(state[:-1], float(state[-1])) for state in states]
    for link, solid in _solids(arm):
        where = entity(WORLD, "robot", side, link)
        journal.always(
            where,
            rr.Mesh3D(
                vertex_positions=solid.vertices,
                triangle_indices=solid.faces,
                vertex_normals=solid.vertex_normals,
                albedo_factor=COLOUR,
            ),
        )
        journal.path(where, clock, [base * from_sapien(at[link]) for at in poses])


def _solids(arm: Arm) -> Iterator[tuple[str, trimesh.Trimesh]]:
    """Name of each link that has a body, and the union of its shapes in its own frame."""
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    for link in build_arm(scene, arm, visual_faces=None).links:
        pieces = [_solid(shape) for shape in link.collision_shapes]
        if pieces:
            yield link.name, trimesh.util.concatenate(pieces)


def _solid(shape: sapien.physx.PhysxCollisionShape) -> trimesh.Trimesh:
    """With flat faces, as their edges are what shows the form."""
    if isinstance(shape, sapien.physx.PhysxCollisionShapeBox):
        mesh = trimesh.creation.box(extents=2 * np.asarray(shape.half_size))
    else:
        mesh = trimesh.Trimesh(np.asarray(shape.vertices) * shape.scale, shape.triangles, process=False)
    mesh.unmerge_vertices()
    mesh.apply_transform(from_sapien(shape.local_pose).matrix())
    return mesh
