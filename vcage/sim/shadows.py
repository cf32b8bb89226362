"""Shapes that are visible without throwing a shadow, and invisible shapes of few triangles that throw it."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import sapien

SEEN = "seen"
"""Name of visible shapes whose shadow is thrown by others."""

UNSEEN = (0.0, 0.0, 0.0, 0.0)
"""Colour, RGBA, of shapes that only throw a shadow: the renderer leaves out fully transparent shapes."""


@functools.cache
def unseen_material() -> sapien.render.RenderMaterial:
    """The material of shapes that only throw a shadow."""
    import sapien

    return sapien.render.RenderMaterial(base_color=list(UNSEEN))


def keep_one_shadow(scene: sapien.Scene) -> None:
    """Disable the shadows of the shapes called :data:`SEEN`.

    Args:
        scene: with all its shapes. A shape that is removed and added again throws its own shadow again.
    """
    for body in scene.render_system.render_bodies:
        # SAPIEN has this switch only on the engine's own node, which a scene makes.
        for shape, node in zip(body.render_shapes, body._internal_node.children, strict=True):
            if shape.name == SEEN:
                node.cast_shadow = False  # pyrefly: ignore[missing-attribute]  these nodes are objects
