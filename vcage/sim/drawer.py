"""Small pictures of single objects as a scene's camera would see them: for comparing with a picture at many poses."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from vcage.base.geometry import Camera, Pose
from vcage.schema.asset import PhysicalModel
from vcage.schema.scene import Table
from vcage.sim.appearance import Appearance
from vcage.sim.bodies import Body
from vcage.sim.cameras import FAR, NEAR
from vcage.sim.poses import to_sapien
from vcage.sim.world import World

if TYPE_CHECKING:
    import sapien


@dataclass(frozen=True)
class Window:
    """A square part of a camera's picture, drawn smaller than the camera takes it.

    Args:
        left, top: its corner, pixels of the camera; may lie outside the picture.
        side: pixels of the drawing along each side.
        step: pixels of the camera that a pixel of the drawing covers along each side.
    """

    left: int
    top: int
    side: int
    step: int


@dataclass(frozen=True)
class Drawing:
    """An object alone, seen through a window.

    Args:
        picture: (side, side, 3) uint8 sRGB.
        covered: (side, side) bool, where it is.
        depth: (side, side) float32 metres along the camera's axis; far behind it where it is not.
    """

    picture: np.ndarray
    covered: np.ndarray
    depth: np.ndarray


class Drawer(Protocol):
    """Draws the objects of a scene."""

    def model(self, object_id: str) -> PhysicalModel | None:
        """What an object looks like; None for one that cannot be drawn."""

    def draw(self, object_id: str, pose: Pose, camera: Camera, window: Window) -> Drawing:
        """The object alone at a pose, as the camera sees it through the window."""


class ModelDrawer:
    """Draws models in studio light without shadows, one at a time: so a drawing costs little more than its pixels.

    Args:
        models: by object id.
    """

    def __init__(self, models: Mapping[str, PhysicalModel]):
        self._models = dict(models)
        self._shown: str | None = None

    def model(self, object_id: str) -> PhysicalModel | None:
        """What an object looks like; None for one that has no model here."""
        return self._models.get(object_id)

    def draw(self, object_id: str, pose: Pose, camera: Camera, window: Window) -> Drawing:
        """The object alone at a pose, as the camera sees it through the window.

        Raises:
            NoRenderer: nothing here can draw.
            DamagedFile: a mesh cannot be loaded.
        """
        self._show(object_id)
        self._world.set_object_pose(object_id, pose)
        component = self._world.camera_component(window.side, window.side, camera.fovy, NEAR, FAR, shaders="minimal")
        focal, step = camera.focal / window.step, window.step
        middle = (camera.width / 2 - window.left) / step, (camera.height / 2 - window.top) / step
        component.set_perspective_parameters(NEAR, FAR, focal, focal, *middle, 0.0)
        component.entity.set_pose(to_sapien(camera.pose))
        self._world.scene.update_render()
        component.take_picture()
        buffer = component.get_picture("GbufferDepth")
        depth = NEAR * FAR / (FAR - buffer * (FAR - NEAR))
        picture = np.ascontiguousarray(component.get_picture("Color")[..., :3])
        return Drawing(picture, covered=buffer < 1, depth=depth)

    @functools.cached_property
    def _world(self) -> World:
        bodies = {name: Body(model) for name, model in self._models.items()}
        world = World(Table(), bodies, appearance=Appearance(shadows=False), render=True)
        for entity in world.scene.entities:
            _set_visible(entity, False)
        return world

    def _show(self, object_id: str) -> None:
        for name, visible in ((self._shown, False), (object_id, True)):
            if name is not None and self._shown != object_id:
                for entity in self._world.entities(name).values():
                    _set_visible(entity, visible)
        self._shown = object_id


def _set_visible(entity: sapien.Entity, visible: bool) -> None:
    import sapien

    component = entity.find_component_by_type(sapien.render.RenderBodyComponent)
    if component is not None:
        component.enable() if visible else component.disable()
