"""Drawings of single objects: from straight above, or small, as a scene's camera sees them at many poses.

The critic and the matcher compare pictures of the table with these.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from vcage.base.geometry import Camera, Pose, look_at
from vcage.base.time_limit import undisturbed
from vcage.schema.asset import PhysicalModel
from vcage.schema.scene import Table
from vcage.sim.appearance import Appearance
from vcage.sim.bodies import Body
from vcage.sim.cameras import FAR, NEAR, depth_picture, observe
from vcage.sim.poses import to_sapien
from vcage.sim.world import World

if TYPE_CHECKING:
    import sapien

REFERENCE_DISTANCE_M = 15.0
"""Distance of the camera of a reference picture from the object's base: the view is parallel to half a percent."""

MARGIN_PX, SIDE_STEP_PX = 4, 32
"""Empty border around an object from above; and the step of the sizes that drawings are rendered in before they are
cut, as each size of camera takes memory of its own."""


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
    """An object, or fingers, alone in a picture of height H and width W: of an object a window, where both are equal.

    Args:
        picture: (H, W, 3) uint8 sRGB.
        covered: (H, W) bool, the silhouette.
        depth: (H, W) float32 metres along the camera's axis; far away beside the silhouette.
    """

    picture: np.ndarray
    covered: np.ndarray
    depth: np.ndarray

    @property
    def nbytes(self) -> int:
        """Memory that it takes."""
        return self.picture.nbytes + self.covered.nbytes + self.depth.nbytes


class Drawer(Protocol):
    """Draws the objects of a scene."""

    def model(self, object_id: str) -> PhysicalModel | None:
        """The model of an object; None for one that cannot be drawn."""

    def draw(self, object_id: str, pose: Pose, camera: Camera, window: Window) -> Drawing:
        """The object alone at a pose, as the camera sees it through the window."""


class ModelDrawer:
    """Draws models in studio light without shadows, one at a time, so that a drawing costs little more than its pixels.

    Args:
        models: by object id.
    """

    def __init__(self, models: Mapping[str, PhysicalModel]):
        self._models = dict(models)
        self._shown: str | None = None

    def model(self, object_id: str) -> PhysicalModel | None:
        """The model of an object; None for an unknown one."""
        return self._models.get(object_id)

    @undisturbed()
    def draw(
        self, object_id: str, pose: Pose, camera: Camera, window: Window, joints: tuple[float, ...] = ()
    ) -> Drawing:
        """The object alone at a pose, as the camera sees it through the window.

        Args:
            object_id: its id.
            pose: object frame in the world.
            camera: that sees it.
            window: the part of its picture that is drawn.
            joints: positions of its moving parts; all at rest when empty.

        Raises:
            NoRenderer: nothing here can draw.
            DamagedFile: a mesh cannot be loaded.
        """
        self._show(object_id)
        self._world.set_object_pose(object_id, pose)
        self._world.set_object_joints(object_id, joints)
        side = -(-window.side // SIDE_STEP_PX) * SIDE_STEP_PX
        component = self._world.camera_component(side, side, 1.0, NEAR, FAR)
        focal, step = camera.focal / window.step, window.step
        middle = (camera.width / 2 - window.left) / step, (camera.height / 2 - window.top) / step
        component.set_perspective_parameters(NEAR, FAR, focal, focal, *middle, 0.0)
        component.entity.set_pose(to_sapien(camera.pose))
        self._world.scene.update_render()
        component.take_picture()
        return drawing_of(component, window.side)

    @functools.cached_property
    def _world(self) -> World:
        bodies = {name: Body(model) for name, model in self._models.items()}
        world = World(Table(), bodies, appearance=Appearance(shadows=False), render=True)
        for entity in world.scene.entities:
            set_visible(entity, False)
        return world

    def _show(self, object_id: str) -> None:
        for name, visible in ((self._shown, False), (object_id, True)):
            if name is not None and self._shown != object_id:
                for entity in self._world.entities(name).values():
                    set_visible(entity, visible)
        self._shown = object_id


def drawing_of(component: sapien.render.RenderCameraComponent, side: int | None = None) -> Drawing:
    """The visible entities in the last picture of a camera, or in its upper left square of ``side`` pixels; read-only,
    for it may be kept."""
    part = np.s_[:side, :side]
    drawn, depth = component.get_picture("Color")[part], np.minimum(depth_picture(component)[part], FAR)
    drawing = Drawing(np.ascontiguousarray(drawn[..., :3]), covered=drawn[..., 3] > 0, depth=depth)
    for layer in (drawing.picture, drawing.covered, drawing.depth):
        layer.setflags(write=False)
    return drawing


def set_visible(entity: sapien.Entity, visible: bool) -> None:
    """Show an entity in pictures, or hide it."""
    import sapien

    component = entity.find_component_by_type(sapien.render.RenderBodyComponent)
    if component is not None:
        component.enable() if visible else component.disable()


def reference_view(
    model: PhysicalModel,
    metres_per_pixel: float = 0.0015,
    appearance: Appearance | None = None,
    joints: tuple[float, ...] = (),
) -> np.ndarray:
    """(h, w, 4) uint8 RGBA of the object from above, its origin in the middle; object x to the right, y up.

    Alpha is 0 beside the object. The scale holds at the object's base.

    Args:
        model: of the object.
        metres_per_pixel: scale.
        appearance: light; the default when not given.
        joints: positions of its moving parts; all at rest when empty.

    Raises:
        NoRenderer: nothing here can draw.
    """
    reach = np.maximum(np.abs(model.lower[:2]), np.abs(model.upper[:2])) + _outreach(model, joints)
    width, height = (2 * (int(np.ceil(r / metres_per_pixel)) + MARGIN_PX) for r in reach)
    fovy = 2 * np.arctan(height * metres_per_pixel / 2 / REFERENCE_DISTANCE_M)
    # The table stands far below: its shadow and colour do not reach the object.
    world = World(Table(height=-2.0), {"object": Body(model, Pose(), joints)}, appearance=appearance, render=True)
    camera = Camera(width, height, fovy, look_at([0, 0, REFERENCE_DISTANCE_M], [0, 0, 0], up=(0, 1, 0)))
    shot = observe(world, camera, near=REFERENCE_DISTANCE_M - 1.0)
    alpha = np.where(shot.segmentation > 0, 255, 0).astype(np.uint8)
    return np.dstack([shot.picture, alpha])


def _outreach(model: PhysicalModel, joints: tuple[float, ...]) -> float:
    """Largest distance of moving parts beyond the object at rest, metres."""
    extent = float(np.linalg.norm(np.subtract(model.upper, model.lower)))
    moved = [(link.joint, position) for link, position in zip(model.links, joints, strict=False) if position]
    return max((abs(position) if joint.kind == "slide" else extent / 2 for joint, position in moved), default=0.0)
