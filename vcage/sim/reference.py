"""What an asset looks like from straight above, alone: the critic's and the matcher's reference."""

from __future__ import annotations

import numpy as np

from vcage.base.geometry import Camera, Pose, look_at
from vcage.schema.asset import PhysicalModel
from vcage.schema.scene import Table
from vcage.sim.appearance import Appearance
from vcage.sim.bodies import Body
from vcage.sim.cameras import observe
from vcage.sim.world import World

DISTANCE = 15.0
"""Metres from the camera to the object's base: far enough that the view is parallel to half a percent."""

MARGIN = 4
"""Empty pixels around the object."""


def reference_view(
    model: PhysicalModel, metres_per_pixel: float = 0.0015, appearance: Appearance | None = None
) -> np.ndarray:
    """(h, w, 4) uint8 RGBA of the object from above, its origin in the middle; object x to the right, y up.

    Alpha is 0 where the object is not. The scale holds at the object's base.

    Raises:
        NoRenderer: nothing here can draw.
    """
    reach = np.maximum(np.abs(model.lower[:2]), np.abs(model.upper[:2]))
    width, height = (2 * (int(np.ceil(r / metres_per_pixel)) + MARGIN) for r in reach)
    fovy = 2 * np.arctan(height * metres_per_pixel / 2 / DISTANCE)
    # The table stands far below: no shadow and no colour of it reach the object.
    world = World(Table(height=-2.0), {"object": Body(model, Pose())}, appearance=appearance, render=True)
    camera = Camera(width, height, fovy, look_at([0, 0, DISTANCE], [0, 0, 0], up=(0, 1, 0)))
    shot = observe(world, camera, near=DISTANCE - 1.0)
    alpha = np.where(shot.segmentation > 0, 255, 0).astype(np.uint8)
    return np.dstack([shot.picture, alpha])
