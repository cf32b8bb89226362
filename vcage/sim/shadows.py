"""What is drawn apart from what throws the shadow, which needs a fraction of the triangles."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import sapien

SEEN = "seen"
"""Name of the shapes that are only drawn, because others throw their shadow."""

UNSEEN = (0.0, 0.0, 0.0, 0.0)
"""Colour, RGBA, of what throws a shadow and is not drawn: what can be seen through entirely is left out."""


@functools.cache
def unseen_material() -> sapien.render.RenderMaterial:
    """The material of what throws a shadow and is not drawn."""
    import sapien

    return sapien.render.RenderMaterial(base_color=list(UNSEEN))


def keep_one_shadow(scene: sapien.Scene) -> None:
    """Take away the shadows of the shapes called :data:`SEEN`, which others throw.

    Args:
        scene: with all that is drawn in it. What is taken out of it and put back throws its own shadow again.
    """
    for body in scene.render_system.render_bodies:
        # SAPIEN offers what the engine can do for a shape with the engine's own node only, which a scene makes
        for shape, node in zip(body.render_shapes, body._internal_node.children, strict=True):
            if shape.name == SEEN:
                node.cast_shadow = False  # pyrefly: ignore[missing-attribute]  these nodes are objects
