"""The table and the objects on it in the 3D scene, each where it was at each time."""

from __future__ import annotations

import logging
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vcage.apps.viewer.log import Clock, Journal, entity, xyzw
from vcage.apps.viewer.sdk import rr
from vcage.base.errors import AssetLeftOut, UnknownName
from vcage.base.geometry import Pose
from vcage.datasets.episode import EpisodeData
from vcage.objects.library import Library
from vcage.schema.asset import PhysicalModel
from vcage.schema.scene import ObjectRecord, Scene, Table
from vcage.sim.joints import link_poses

logger = logging.getLogger(__name__)

WORLD = "world"

TABLE_THICKNESS = 0.03
"""Of the drawn table top, metres; the scene knows only its height."""

TABLE_COLOUR = (150, 120, 90)

AXES = 0.05
"""Length of the axes that stand for an object of which nothing else is known, metres."""


def log_table(journal: Journal, table: Table) -> None:
    """The table top."""
    half = (*np.array(table.size) / 2, TABLE_THICKNESS / 2)
    centre = (*table.centre, table.height - TABLE_THICKNESS / 2)
    box = rr.Boxes3D(centers=[centre], half_sizes=[half], colors=[TABLE_COLOUR], fill_mode="solid")
    journal.always(entity(WORLD, "table"), box)


def log_objects(journal: Journal, clock: Clock, episode: EpisodeData, scene: Scene | None) -> None:
    """Every object: its model where the library has it, else its box where the scene knows it, else its axes."""
    records = {} if scene is None else {record.id: record for record in scene.objects}
    library = Library.load() if records else None
    for name, poses in episode.object_poses.items():
        where = entity(WORLD, "objects", name)
        record = records.get(name)
        model = None if record is None else _model(library, record)
        journal.poses(where, clock, poses[:, :3], poses[:, 3:])
        if model is not None:
            _log_model(journal, clock, where, model, episode.object_joints.get(name))
        elif record is not None:
            journal.always(where, _box(record, Pose(poses[0, :3], poses[0, 3:])))
        else:
            journal.always(where, rr.Transform3D.from_fields(axis_length=AXES))


def _model(library: Library, record: ObjectRecord) -> PhysicalModel | None:
    try:
        return library.asset(record.asset, record.variant).model
    except (UnknownName, AssetLeftOut) as error:
        logger.warning("%s is drawn as a box: %s", record.id, error.as_line())
        return None


def _log_model(
    journal: Journal, clock: Clock, where: str, model: PhysicalModel, joints: NDArray[np.float64] | None
) -> None:
    journal.always(where, rr.Asset3D(path=Path(model.visual)))
    moved = [] if joints is None else [link_poses(model, row) for row in joints]
    for link in model.links:
        part = f"{where}/{entity(link.name).lstrip('/')}"
        journal.always(part, rr.Asset3D(path=Path(link.visual)))
        if moved:
            journal.path(part, clock, [poses[link.name] for poses in moved])


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
