"""One asset from the front, the right, the back and above, with its points drawn as frames.

The camera stands so far away that one scale holds for all pictures and all depths.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from vcage.base.geometry import Camera, Pose, frame_from_axes, look_at, world_aabb
from vcage.objects.asset import Asset
from vcage.schema.scene import Table
from vcage.sim.appearance import Appearance
from vcage.sim.bodies import Body
from vcage.sim.cameras import observe
from vcage.sim.joints import link_poses
from vcage.sim.world import World


@dataclass(frozen=True)
class ViewSettings:
    """Settings of the pictures.

    Args:
        metres_per_px: scale of every picture.
        distance_m: from the camera to the object.
        margin_m: empty space around the object.
        axis_m: length of a drawn axis.
        slant_rad: downward angle of the side views.
    """

    metres_per_px: float = 0.0006
    distance_m: float = 15.0
    margin_m: float = 0.03
    axis_m: float = 0.02
    slant_rad: float = np.radians(22)


VIEWS = ViewSettings()

AXIS_COLOURS = ((220, 50, 47), (40, 160, 60), (38, 100, 230))
"""x red, y green, z blue."""

SIDES = {"front": (0.0, -1.0), "right": (1.0, 0.0), "back": (0.0, 1.0)}


@dataclass(frozen=True)
class Mark:
    """A point of the annotation to draw: a frame in the world, and its label."""

    label: str
    frame: Pose


def portrait(asset: Asset, *, opened: bool = False, points: bool = True) -> dict[str, np.ndarray]:
    """Pictures (H, W, 3) of an asset from the front, the right, the back and above.

    Args:
        opened: every joint at the far end of its range, not at rest.
        points: draw the points of the annotation.

    Raises:
        NoRenderer: nothing here can draw.
    """
    joints = tuple(link.joint.far_end if opened else 0.0 for link in asset.model.links)
    # A table so large that it fills the background of the object.
    table = Table(size=(8.0, 8.0))
    # Lit from the front left, so that fronts and their labels are bright.
    look = Appearance(table_colour=(0.30, 0.35, 0.40), light_direction=(0.35, 0.55, -1.0))
    standing = Pose([0.0, 0.0, table.height])
    world = World(table, {"object": Body(asset.model, standing, joints)}, appearance=look, render=True)
    bounds = world_aabb(_bounds(asset, joints), standing)
    marks = _marks(asset, standing, joints) if points else []
    cameras = _cameras(bounds)
    return {
        name: _with_marks(observe(world, camera, near=VIEWS.distance_m - 1.5).picture, camera, marks)
        for name, camera in cameras.items()
    }


def _bounds(asset: Asset, joints: tuple[float, ...]) -> np.ndarray:
    """(2, 3) bounding box at these joint positions, object frame."""
    poses = link_poses(asset.model, joints)
    corners = [pose.apply(piece.vertices) for link, pose in poses.items() for piece in asset.pieces_of(link)]
    points = np.concatenate([*corners, asset.bounds] if not any(joints) else corners)
    return np.stack([points.min(axis=0), points.max(axis=0)])


def _cameras(bounds: np.ndarray) -> dict[str, Camera]:
    """Cameras by view, each just wide enough for the box (2, 3) in the world."""
    middle, size = bounds.mean(axis=0), bounds[1] - bounds[0]
    cameras = {}
    for name, (x, y) in SIDES.items():
        direction = np.array([x * np.cos(VIEWS.slant_rad), y * np.cos(VIEWS.slant_rad), np.sin(VIEWS.slant_rad)])
        across, deep = (size[0], size[1]) if x == 0 else (size[1], size[0])
        tall = size[2] * np.cos(VIEWS.slant_rad) + deep * np.sin(VIEWS.slant_rad)
        cameras[name] = _camera(across, tall, look_at(middle + VIEWS.distance_m * direction, middle))
    above = look_at(middle + [0, 0, VIEWS.distance_m], middle, up=(0, 1, 0))
    cameras["above"] = _camera(size[0], size[1], above)
    return cameras


def _camera(width: float, height: float, pose: Pose) -> Camera:
    columns, rows = (2 * int(np.ceil((x + 2 * VIEWS.margin_m) / VIEWS.metres_per_px / 2)) for x in (width, height))
    return Camera(columns, rows, 2 * np.arctan(rows * VIEWS.metres_per_px / 2 / VIEWS.distance_m), pose)


# --- points ------------------------------------------------------------------------------------------------


def _marks(asset: Asset, standing: Pose, joints: tuple[float, ...]) -> list[Mark]:
    """Contact points as gripper frames (z approach, y closing), functional points as frames whose z leads out."""
    links = link_poses(asset.model, joints)
    marks = []
    for contact in asset.annotation.contact_points:
        frame = frame_from_axes(contact.position, contact.approach, contact.closing)
        marks.append(Mark(f"c{contact.id}", standing * links[contact.link] * frame))
    for point in asset.annotation.functional_points:
        side = (1.0, 0.0, 0.0) if abs(point.axis[0]) < 0.9 else (0.0, 1.0, 0.0)
        frame = frame_from_axes(point.position, point.axis, side)
        marks.append(Mark(f"{point.holds}{point.id}", standing * links[point.link] * frame))
    return marks


def _with_marks(picture: np.ndarray, camera: Camera, marks: list[Mark]) -> np.ndarray:
    out = picture.copy()
    for mark in marks:
        ends = camera.project(mark.frame.apply([[0, 0, 0], *(VIEWS.axis_m * np.eye(3))]))
        origin, *tips = (tuple(round(float(x)) for x in end) for end in ends)
        for tip, colour in zip(tips, AXIS_COLOURS, strict=True):
            cv2.line(out, origin, tip, (255, 255, 255), 4, cv2.LINE_AA)
            cv2.line(out, origin, tip, colour, 2, cv2.LINE_AA)
        corner = origin[0] + 4, origin[1] - 5
        for colour, width in (((255, 255, 255), 3), ((20, 20, 20), 1)):
            cv2.putText(out, mark.label, corner, cv2.FONT_HERSHEY_SIMPLEX, 0.36, colour, width, cv2.LINE_AA)
    return out
