"""Where in a receptacle each of the objects goes that a task puts there.

The exact free-region placement of the scene (:mod:`vcage.layout.placement.place`) is used again, with the opening as
the workspace: what fits together gets places side by side, and what does not is refused by name.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vcage.base.geometry import Pose, world_aabb
from vcage.layout.items import TableItem
from vcage.layout.placement.place import place
from vcage.schema.subtasks import Subtask
from vcage.tasks.scene_objects import SceneObject

GAP = 0.006
"""Metres kept between contents, and between contents and wall."""


def allocate(
    receptacle: SceneObject,
    functional_point: int,
    contents: Sequence[SceneObject],
    rng: np.random.Generator,
    present: Sequence[SceneObject] = (),
) -> dict[str, Pose]:
    """A place for each of ``contents`` in the receptacle: object frame in the *receptacle's* frame, by id.

    Args:
        receptacle: where they go.
        functional_point: id of the receptacle's functional point.
        contents: what goes there.
        rng: of all choices.
        present: what already lies there.

    Raises:
        InfeasibleScene: they do not fit together; names them and the area that is missing.
    """
    opening = receptacle.asset.opening(receptacle.asset.annotation.functional_point(functional_point))
    centre, half = np.array(opening.centre), np.array(opening.size) / 2 - GAP
    inside = np.stack([centre - half, centre + half])
    to_receptacle = receptacle.pose.inverse()
    taken = [world_aabb(o.asset.bounds, to_receptacle * o.pose)[:, :2] for o in present]
    items = [TableItem(id=o.id, size=tuple(o.asset.size), yaws=(0.0, np.pi / 2)) for o in contents]
    places = place(items, inside, rng, margin=GAP, obstacles=taken)
    return {key: Pose.from_yaw([at.x, at.y, opening.floor], at.yaw) for key, at in places.items()}


def slots_for_chain(
    chain: Sequence[Subtask], objects: Sequence[SceneObject], rng: np.random.Generator
) -> dict[str, Pose]:
    """A slot for each object that the chain moves, in its receptacle's frame, so that all fit together.

    Args:
        chain: the sub-tasks.
        objects: of the scene.
        rng: of all choices.

    Raises:
        InfeasibleScene: the contents of one receptacle do not fit together.
    """
    by_id = {o.id: o for o in objects}
    groups: dict[tuple[str, int], list[SceneObject]] = {}
    for subtask in chain:
        groups.setdefault((subtask.receptacle, subtask.functional_point), []).append(by_id[subtask.object])
    slots: dict[str, Pose] = {}
    for (receptacle, point), contents in groups.items():
        moved = {o.id for o in contents}
        present = lying_in(by_id[receptacle], [o for o in objects if o.id not in moved])
        slots |= allocate(by_id[receptacle], point, contents, rng, present)
    return slots


def lying_in(receptacle: SceneObject, objects: Sequence[SceneObject]) -> list[SceneObject]:
    """What lies in or on the receptacle from the start."""
    return [o for o in objects if o.record.container == receptacle.id]
