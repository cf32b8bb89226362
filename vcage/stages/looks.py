"""What an episode looks like. A stand-in: the two functions that draw a look and make it seen are to take its place."""

from __future__ import annotations

import numpy as np

from vcage.schema.randomisation import Light, Look, Randomisation, Surface
from vcage.schema.scene import Scene
from vcage.sim.appearance import Appearance
from vcage.stages.context import StageContext
from vcage.stages.photographs import episode_light


def drawn_look(
    ranges: Randomisation, scene: Scene, context: StageContext, rng: np.random.Generator
) -> tuple[Look, Appearance]:
    """What is recorded of the look, and how it is rendered."""
    seen = context.appearance(scene.table.texture) if ranges.name == "none" else episode_light(rng)
    light = Light(direction=(0.0, 0.0, -1.0), colour=seen.light_colour, shadows=seen.shadows)
    table = Surface(texture=None, colour=seen.table_colour)
    return Look(lights=[light], ambient=seen.ambient, surfaces={"table": table}), seen
