"""Poses, boxes and pinhole cameras.

Conventions: metres, radians, quaternions wxyz. World frame: x right, y away from the robot, z up.
Camera frame (SAPIEN's): x forward, y left, z up. Pixels: ``u`` to the right, ``v`` down, the centre of the
first pixel at (0.5, 0.5). Arrays are float64 with shapes given in comments.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation


@dataclass(frozen=True, eq=False)
class Pose:
    """A rigid transform: maps points of the child frame to the parent frame.

    Poses are equal when their numbers are: ``q`` and ``-q`` are the same rotation, but not the same pose.

    Args:
        p: (3,) translation in metres.
        q: (4,) unit quaternion, wxyz; normalised on construction.
    """

    p: np.ndarray
    q: np.ndarray

    def __init__(self, p: ArrayLike = (0.0, 0.0, 0.0), q: ArrayLike = (1.0, 0.0, 0.0, 0.0)):
        p = np.array(p, dtype=np.float64).reshape(3)
        q = np.array(q, dtype=np.float64).reshape(4)
        norm = math.sqrt(q.dot(q))  # as numpy's, without its checks: planning makes thousands of poses a second
        if not (math.isfinite(sum(p.tolist())) and math.isfinite(norm) and norm > 1e-9):
            raise ValueError(f"not a pose: position {p.tolist()}, quaternion {q.tolist()}")
        q = q / norm
        p.setflags(write=False)
        q.setflags(write=False)
        object.__setattr__(self, "p", p)
        object.__setattr__(self, "q", q)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Pose):
            return NotImplemented
        return np.array_equal(self.p, other.p) and np.array_equal(self.q, other.q)

    def __hash__(self) -> int:
        return hash((*self.p.tolist(), *self.q.tolist()))

    @classmethod
    def from_matrix(cls, matrix: ArrayLike) -> Pose:
        """From a (4, 4) homogeneous matrix."""
        matrix = np.asarray(matrix, dtype=np.float64)
        return cls(matrix[:3, 3], rotation_to_quat(matrix[:3, :3]))

    @classmethod
    def from_yaw(cls, p: ArrayLike, yaw: float) -> Pose:
        """At ``p``, turned by ``yaw`` about the vertical."""
        return cls(p, (np.cos(yaw / 2), 0.0, 0.0, np.sin(yaw / 2)))

    def matrix(self) -> np.ndarray:
        """(4, 4) homogeneous matrix."""
        out = np.eye(4)
        out[:3, :3] = self.rotation()
        out[:3, 3] = self.p
        return out

    def rotation(self) -> np.ndarray:
        """(3, 3) rotation matrix, made once."""
        return self._rotation

    @cached_property
    def _rotation(self) -> np.ndarray:
        rotation = quat_to_rotation(self.q)
        rotation.setflags(write=False)
        return rotation

    def inverse(self) -> Pose:
        """Parent to child."""
        rotation = self.rotation().T
        return Pose(-rotation @ self.p, [self.q[0], -self.q[1], -self.q[2], -self.q[3]])

    def __mul__(self, other: Pose) -> Pose:
        return Pose(self.rotation() @ other.p + self.p, _quat_product(self.q, other.q))

    def apply(self, points: ArrayLike) -> np.ndarray:
        """Transform (..., 3) points."""
        return np.asarray(points, dtype=np.float64) @ self.rotation().T + self.p

    @property
    def yaw(self) -> float:
        """Heading of the child's x axis about the vertical, in (-π, π]."""
        x = self.rotation()[:, 0]
        return float(np.arctan2(x[1], x[0]))


def _quat_product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    w, x, y, z = a.tolist()
    p, q, r, s = b.tolist()
    return np.array(
        [
            w * p - x * q - y * r - z * s,
            w * q + x * p + y * s - z * r,
            w * r - x * s + y * p + z * q,
            w * s + x * r - y * q + z * p,
        ]
    )


def quat_to_rotation(q: Sequence[float] | np.ndarray) -> np.ndarray:
    """(3, 3) rotation of a unit wxyz quaternion (4,).

    Written out, as planning turns thousands of poses a second and scipy's checks cost ten times as much.
    """
    w, x, y, z = np.asarray(q, dtype=np.float64).tolist()
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def rotation_to_quat(rotation: ArrayLike) -> np.ndarray:
    """wxyz quaternion of a (3, 3) rotation, with w ≥ 0."""
    x, y, z, w = Rotation.from_matrix(np.asarray(rotation, dtype=np.float64)).as_quat()
    q = np.array([w, x, y, z])
    return -q if w < 0 else q


def rotation_2d(yaw: float) -> np.ndarray:
    """(2, 2) rotation of the plane by ``yaw``, for columns: ``rotation_2d(yaw) @ point``."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s], [s, c]])


def wrap_angle(angle: ArrayLike) -> np.ndarray:
    """Angle(s) brought into [-π, π)."""
    return (np.asarray(angle, dtype=np.float64) + np.pi) % (2 * np.pi) - np.pi


def frame_from_axes(origin: ArrayLike, z: ArrayLike, y: ArrayLike) -> Pose:
    """The pose with z axis ``z`` and with y axis ``y`` made perpendicular to it.

    A gripper frame has z along the approach and y along the closing direction of the fingers.

    Args:
        origin: (3,) of the frame.
        z, y: (3,) axes of any length.
    """
    z = np.asarray(z, dtype=np.float64)
    y = np.asarray(y, dtype=np.float64)
    if np.linalg.norm(z) < 1e-9 or np.linalg.norm(np.cross(y, z)) < 1e-9:
        raise ValueError(f"axes {z.tolist()} and {y.tolist()} span no frame")
    z = z / np.linalg.norm(z)
    y = y - (y @ z) * z
    y = y / np.linalg.norm(y)
    return Pose(origin, rotation_to_quat(np.stack([np.cross(y, z), y, z], axis=1)))


def look_at(eye: ArrayLike, target: ArrayLike, up: ArrayLike = (0.0, 0.0, 1.0)) -> Pose:
    """Pose of a camera at ``eye`` that looks at ``target`` (x forward, y left, z up).

    Args:
        eye: (3,) where it stands.
        target: (3,) point in the middle of the picture.
        up: (3,) direction that is up in the picture.
    """
    eye, target, up = (np.asarray(v, dtype=np.float64) for v in (eye, target, up))
    forward = target - eye
    forward = forward / np.linalg.norm(forward)
    left = np.cross(up, forward)
    if np.linalg.norm(left) < 1e-9:
        raise ValueError("the view direction is parallel to 'up': give another 'up'")
    left = left / np.linalg.norm(left)
    return Pose(eye, rotation_to_quat(np.stack([forward, left, np.cross(forward, left)], axis=1)))


# --- boxes ---------------------------------------------------------------------------------------------


_UPPER = np.array([[i >> 2 & 1, i >> 1 & 1, i & 1] for i in range(8)], dtype=bool)
"""(8, 3) which coordinates of a box's corners are the upper ones."""


def box_corners(lower: ArrayLike, upper: ArrayLike) -> np.ndarray:
    """(8, 3) corners of an axis-aligned box."""
    lower, upper = np.asarray(lower, dtype=np.float64), np.asarray(upper, dtype=np.float64)
    return np.where(_UPPER, upper, lower)


def world_aabb(bounds: ArrayLike, pose: Pose) -> np.ndarray:
    """(2, 3) axis-aligned world box of a local box (2, 3) at ``pose`` (paper, section III-A1)."""
    bounds = np.asarray(bounds, dtype=np.float64)
    corners = pose.apply(box_corners(bounds[0], bounds[1]))
    return np.stack([corners.min(axis=0), corners.max(axis=0)])


def footprint_half_size(size: ArrayLike, yaw: ArrayLike) -> np.ndarray:
    """(..., 2) half size of the axis-aligned rectangle around a ``size`` (..., 2) rectangle turned by ``yaw``."""
    size, yaw = np.asarray(size, dtype=np.float64) / 2, np.asarray(yaw, dtype=np.float64)
    c, s = np.abs(np.cos(yaw)), np.abs(np.sin(yaw))
    return np.stack([c * size[..., 0] + s * size[..., 1], s * size[..., 0] + c * size[..., 1]], axis=-1)


def boxes_overlap(a: ArrayLike, b: ArrayLike, margin: float = 0.0) -> bool:
    """True if two boxes (2, n) come closer than ``margin`` along every axis (touching is not overlap).

    Args:
        a, b: lower and upper corners.
        margin: metres.
    """
    a, b = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    return bool(np.all(a[0] < b[1] + margin) and np.all(b[0] < a[1] + margin))


def oriented_boxes_overlap(bounds_a: ArrayLike, pose_a: Pose, bounds_b: ArrayLike, pose_b: Pose) -> bool:
    """True if two boxes, (2, 3) in their own frames, overlap at their poses (separating axis theorem).

    Args:
        bounds_a, bounds_b: lower and upper corners.
        pose_a, pose_b: of their frames in the world.
    """
    corners_a = pose_a.apply(box_corners(*np.asarray(bounds_a, dtype=np.float64)))
    corners_b = pose_b.apply(box_corners(*np.asarray(bounds_b, dtype=np.float64)))
    axes_a, axes_b = pose_a.rotation().T, pose_b.rotation().T
    a, b, y, z = axes_a[:, None], axes_b[None], [1, 2, 0], [2, 0, 1]
    crossed = (a[..., y] * b[..., z] - a[..., z] * b[..., y]).reshape(-1, 3)  # numpy's cross has costly checks
    crossed = crossed[np.linalg.norm(crossed, axis=1) > 1e-9]
    axes = np.concatenate([axes_a, axes_b, crossed])  # (≤ 15, 3)
    along_a, along_b = corners_a @ axes.T, corners_b @ axes.T  # (8, n)
    apart = (along_a.max(axis=0) <= along_b.min(axis=0)) | (along_b.max(axis=0) <= along_a.min(axis=0))
    return not bool(apart.any())


# --- cameras -------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Camera:
    """A pinhole camera with square pixels and the principal point in the middle.

    Args:
        width, height: picture size in pixels.
        fovy: vertical field of view, radians.
        pose: camera frame to world frame (x forward, y left, z up).
    """

    width: int
    height: int
    fovy: float
    pose: Pose

    @property
    def focal(self) -> float:
        """Focal length in pixels."""
        return self.height / 2 / np.tan(self.fovy / 2)

    def intrinsics(self) -> np.ndarray:
        """(3, 3) OpenCV intrinsic matrix."""
        return np.array([[self.focal, 0, self.width / 2], [0, self.focal, self.height / 2], [0, 0, 1.0]])

    def extrinsics(self) -> np.ndarray:
        """(4, 4) world frame to OpenCV camera frame (x right, y down, z forward)."""
        to_cv = np.array([[0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1.0]])
        return to_cv @ self.pose.inverse().matrix()

    def project(self, points: ArrayLike) -> np.ndarray:
        """Pixels (..., 2) of world points (..., 3); NaN for points behind the camera."""
        local = self.pose.inverse().apply(points)
        depth = np.where(local[..., 0] > 1e-9, local[..., 0], np.nan)
        u = self.width / 2 - self.focal * local[..., 1] / depth
        v = self.height / 2 - self.focal * local[..., 2] / depth
        return np.stack([u, v], axis=-1)

    def sees(self, points: ArrayLike) -> np.ndarray:
        """(...) bool: whether world points (..., 3) lie within the picture."""
        pixels = self.project(points)
        return np.all((pixels >= 0) & (pixels < [self.width, self.height]), axis=-1)  # false for NaN

    def unproject(self, pixels: ArrayLike, height: ArrayLike) -> np.ndarray:
        """World points (..., 3) where the rays through ``pixels`` (..., 2) meet the plane z = ``height``.

        The inverse of :meth:`project`; NaN where a ray does not meet the plane in front of the camera.
        """
        pixels = np.asarray(pixels, dtype=np.float64)
        height = np.asarray(height, dtype=np.float64)
        left, up = ((size / 2 - pixels[..., k]) / self.focal for k, size in enumerate((self.width, self.height)))
        local = np.stack([np.ones(pixels.shape[:-1]), left, up], axis=-1)
        rays = local @ self.pose.rotation().T
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = (height - self.pose.p[2]) / rays[..., 2]
        distance = np.where(distance > 0, distance, np.nan)
        return self.pose.p + distance[..., None] * rays


def tilt_between(a: Pose, b: Pose) -> float:
    """Angle between the up axes of two poses, radians."""
    return float(np.arccos(np.clip(a.rotation()[:, 2] @ b.rotation()[:, 2], -1.0, 1.0)))
