"""The process-wide render system with its shaders (``assets/shaders``), materials, and shapes that throw shadows.

The shaders are compiled again whenever the last render system of a process is gone, so one is kept for the life of the
process, and every world draws with the same device.
"""

from __future__ import annotations

import functools
from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

import numpy as np

from vcage.base.commands import vcage_command
from vcage.base.errors import NoRenderer
from vcage.base.files import resource

if TYPE_CHECKING:
    import sapien

MIPMAPS = 6
"""Smaller copies of every texture, so that fine patterns do not shimmer from afar."""


@functools.cache
def _first_system() -> sapien.render.RenderSystem:
    """The render system that holds the compiled shaders; made on first use and never released."""
    from vcage.setup.vulkan import ensure_driver

    ensure_driver()
    import sapien

    sapien.render.set_log_level("error")
    sapien.render.set_camera_shader_dir(str(resource("assets", "shaders")))
    sapien.render.set_picture_format("Color", "r8g8b8a8unorm")
    sapien.render.set_picture_format("Segmentation", "r16g16b16a16uint")
    sapien.render.set_global_config(default_mipmap_levels=MIPMAPS)
    try:
        return sapien.render.RenderSystem()
    except RuntimeError as error:
        raise NoRenderer(
            f"SAPIEN cannot draw: {error}", hint="see what is missing", command=vcage_command("doctor")
        ) from error


def new_render_system(meshes: Collection[str] = ()) -> sapien.render.RenderSystem:
    """A render system of its own for one scene, on the process-wide device.

    Args:
        meshes: files of the objects that the scene will show.

    Raises:
        NoRenderer: no Vulkan driver here can draw.
    """
    device = _first_system().device
    import sapien

    _release_others(meshes)
    return sapien.render.RenderSystem(device)


_kept: set[str] = set()
"""Files of objects that SAPIEN keeps in memory."""


def _release_others(meshes: Collection[str], most: int = 16) -> None:
    """Release the meshes and textures that no scene uses, if they are many.

    SAPIEN keeps what it has loaded, some megabytes for each object, until it is told otherwise.

    Args:
        meshes: files of objects that are about to be shown.
        most: other files to keep. Robots are not counted; with a release they are loaded again, in 0.1 CPU seconds.
    """
    import sapien

    if len(_kept.difference(meshes)) > most:
        sapien.render.clear_cache(models=True, images=True, shaders=False)
        _kept.clear()
    _kept.update(meshes)


def device_name() -> str:
    """The driver's name of the rendering device; ``none`` where nothing can draw."""
    try:
        return _first_system().device.name
    except NoRenderer:
        return "none"


def plain_material(colour: Sequence[float], roughness: float = 0.8) -> sapien.render.RenderMaterial:
    """A material of one colour, linear RGB in [0, 1]."""
    import sapien

    return sapien.render.RenderMaterial(base_color=[*colour, 1.0], roughness=roughness)


def painted_material(picture: np.ndarray) -> sapien.render.RenderMaterial:
    """A material that shows an (H, W, 3) uint8 sRGB picture."""
    import sapien

    material = sapien.render.RenderMaterial(base_color=[1, 1, 1, 1], roughness=0.7)
    material.set_base_color_texture(painted_texture(picture))
    return material


def painted_texture(picture: np.ndarray) -> sapien.render.RenderTexture2D:
    """A texture of an (H, W, 3) uint8 sRGB picture, which repeats."""
    import sapien

    opaque = np.dstack([picture, np.full(picture.shape[:2], 255, np.uint8)])
    return sapien.render.RenderTexture2D(
        np.ascontiguousarray(opaque), "R8G8B8A8Unorm", mipmap_levels=MIPMAPS, srgb=True
    )


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
