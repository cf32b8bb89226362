"""Pictures of a world: colour, segmentation and depth, from fixed cameras and cameras on links."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import cv2
import numpy as np

from vcage.base.channels import DEPTH, RGB, SEGMENTATION
from vcage.base.geometry import Camera, Pose, look_at, rotation_to_quat
from vcage.base.time_limit import undisturbed
from vcage.schema.base import CameraRecord
from vcage.schema.randomisation import CameraShift
from vcage.schema.robot import Robot, RobotCamera
from vcage.sim.channels import ExtraChannels, millimetres
from vcage.sim.poses import to_sapien
from vcage.sim.world import World

if TYPE_CHECKING:
    import sapien

NEAR, FAR = 0.01, 20.0
"""Clipping planes of every camera, metres."""


@dataclass(frozen=True)
class Shot:
    """The pictures of a camera.

    Args:
        picture: (H, W, 3) uint8 sRGB.
        segmentation: (H, W) int32, values of :attr:`World.segmentation_ids`, 0 beside objects.
        depth: (H, W) float32, metres along the optical axis; infinite where nothing was drawn.
    """

    picture: np.ndarray
    segmentation: np.ndarray
    depth: np.ndarray


@undisturbed()
def shoot(world: World, camera: Camera | CameraRecord) -> np.ndarray:
    """(H, W, 3) uint8 picture of a world made with ``render=True``."""
    return _colour(world, take(world, camera))


@undisturbed()
def shoot_channels(world: World, camera: Camera | CameraRecord, extra: ExtraChannels) -> dict[str, np.ndarray]:
    """Take the pictures of one moment: channel → picture.

    ``rgb`` is that of :func:`shoot`, ``depth`` (H, W) uint16 millimetres, ``segmentation`` (H, W) uint8 ids.

    Args:
        world: made with ``render=True``.
        camera: that takes them.
        extra: channels besides colour, made for this world.
    """
    component = take(world, camera)
    pictures = {RGB: _colour(world, component)}
    if extra.depth:
        pictures[DEPTH] = millimetres(depth_picture(component))
    if extra.masks is not None:
        pictures[SEGMENTATION] = extra.masks.ids(component.get_picture("Segmentation")[..., 1])
    return pictures


@undisturbed()
def observe(world: World, camera: Camera | CameraRecord, near: float = NEAR) -> Shot:
    """Colour, segmentation and depth of the same moment.

    Args:
        near: nearest drawn distance, metres; a far camera needs a far near plane for an exact depth.
    """
    component = take(world, camera, near)
    return Shot(
        picture=_colour(world, component),
        segmentation=_object_ids(world, component.get_picture("Segmentation")[..., 1]),
        depth=depth_picture(component),
    )


def depth_picture(component: sapien.render.RenderCameraComponent) -> np.ndarray:
    """(H, W) float32, metres along the optical axis in the last picture; infinite where nothing was drawn."""
    buffer, near, far = component.get_picture("GbufferDepth"), component.near, component.far
    depth = near * far / (far - buffer * (far - near))
    return np.where(buffer < 1, depth, np.inf).astype(np.float32)


def robot_cameras(world: World) -> dict[str, Camera]:
    """The cameras of the world's robot by name at their present poses, shifted by the world's appearance."""
    cameras, shifts = world.robot.cameras if world.robot else {}, world.appearance.cameras
    return {name: placed(camera, shifts.get(name), _carrier(world, camera)) for name, camera in cameras.items()}


def overview(robot: Robot) -> Camera | None:
    """The first fixed camera of a robot's file; None without one."""
    return next((placed(camera) for camera in robot.cameras.values() if camera.arm is None), None)


def placed(camera: RobotCamera, shift: CameraShift | None = None, carrier: Pose | None = None) -> Camera:
    """A camera of a robot in the world.

    Args:
        camera: of the robot's file.
        shift: from the pose in the file.
        carrier: pose of the link that carries it; None for a fixed one.
    """
    mounted, on = _mounted(camera), carrier or Pose()
    if shift is None:
        return Camera(camera.width, camera.height, camera.fovy, on * mounted)
    turned = Pose(mounted.p + np.array(shift.shift), (mounted * _turn(shift)).q)
    return Camera(camera.width, camera.height, camera.fovy * shift.fovy, on * turned)


def _carrier(world: World, camera: RobotCamera) -> Pose | None:
    return world.arms[camera.arm].link_pose(camera.link) if camera.arm and camera.link else None


def _turn(shift: CameraShift) -> Pose:
    """The rotation about the camera's own axes: the three angles are a rotation vector."""
    rotation, _ = cv2.Rodrigues(np.radians(np.array(shift.turn_deg, dtype=np.float64)))
    return Pose(q=rotation_to_quat(rotation))


@functools.cache
def _mounted(camera: RobotCamera) -> Pose:
    """Pose of a camera on its carrier."""
    position = np.asarray(camera.position)
    return look_at(position, position + np.asarray(camera.forward), camera.up)


def take(world: World, camera: Camera | CameraRecord, near: float = NEAR) -> sapien.render.RenderCameraComponent:
    """The world's camera component of that size and opening, after it took the picture."""
    if not world.rendered:
        raise ValueError("this world was made without render=True")
    if isinstance(camera, CameraRecord):
        camera = camera.camera()
    component = world.camera_component(camera.width, camera.height, camera.fovy, near, FAR)
    component.entity.set_pose(to_sapien(camera.pose))
    world.scene.update_render()
    component.take_picture()
    return component


def _colour(world: World, component: sapien.render.RenderCameraComponent) -> np.ndarray:
    """(H, W, 3) uint8 picture, with a sky as bright as the ambient light where nothing was drawn."""
    sky = np.round(255 * np.clip([*world.appearance.ambient, 1], 0, 1) ** (1 / 2.2)).astype(np.uint8)
    drawn = component.get_picture("Color")
    # Pixels of four bytes, and OpenCV: with masks and strides numpy takes thirty times as long.
    pixels = drawn.view(np.uint32)
    np.putmask(pixels, pixels == 0, sky.view(np.uint32))
    return cv2.cvtColor(drawn, cv2.COLOR_RGBA2RGB)


def _object_ids(world: World, entities: np.ndarray) -> np.ndarray:
    """SAPIEN's per-scene entity ids → our object values; all parts of an object have its value."""
    table = np.zeros(int(entities.max()) + 1, dtype=np.int32)
    for name, value in world.segmentation_ids.items():
        for entity in world.entities(name).values():
            if entity.per_scene_id < len(table):
                table[entity.per_scene_id] = value
    return table[entities]
