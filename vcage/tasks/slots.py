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
        functional_point: id of the receptacle's functional point.
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
    spots = place(items, inside, rng, margin=GAP, obstacles=taken)
    return {key: Pose.from_yaw([spot.x, spot.y, opening.floor], spot.yaw) for key, spot in spots.items()}
