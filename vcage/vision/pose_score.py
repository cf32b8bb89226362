"""The score of a known object's template at a pose in a picture, and the best pose nearby.

A pose is the place of the object's origin on the table (x, y, metres), its turn since the source picture
(counter-clockwise from above, radians) and the logarithm of its scale.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from vcage.base.geometry import Camera
from vcage.vision.colour import LabImage
from vcage.vision.object_templates import ObjectTemplate

LIGHTNESS = 0.6
"""Weight of lightness beside hue and chroma: shading changes it when an object turns."""

TERMS = ("colour", "structure", "fill", "border")
WEIGHTS = np.array([1.0, 1.6, 0.8, 1.0])
"""Of the terms of :class:`Fit` in the goodness that is maximised."""


@dataclass(frozen=True)
class ScoreSettings:
    """Scales of the terms of a fit.

    Args:
        colour_cap: largest colour distance that a pixel can cost, Lab units.
        pattern_noise: colour differences inside an object that are noise, Lab units.
        border_contrast: colour distance across an outline that is surely one, Lab units.
        outside_px, inside_px: distance of the compared pixels from the outline, in pixels of the compared size.
        largest_log_scale: image models and perspective change sizes by no more.
    """

    colour_cap: float = 32.0
    pattern_noise: float = 5.0
    border_contrast: float = 10.0
    outside_px: float = 2.5
    inside_px: float = 2.0
    largest_log_scale: float = 0.10


SETTINGS = ScoreSettings()


@dataclass(frozen=True)
class Fit:
    """Poses and the score of an object's template at each; every term lies in [0, 1], 1 is best.

    Args:
        poses: (b, 4).
        terms: (b, 4): likeness of colours; likeness of the pattern once the mean colour is taken away (a masked
            normalised cross-correlation that plain objects pass); share of the inside that is no table; share of the
            outline that is one, by table outside or by a change of colour.
    """

    poses: np.ndarray
    terms: np.ndarray

    @property
    def goodness(self) -> np.ndarray:
        """(b,) in [0, 1]."""
        return self.terms @ WEIGHTS / WEIGHTS.sum()

    def term(self, name: str) -> np.ndarray:
        """(b,) one of :data:`TERMS`."""
        return self.terms[:, TERMS.index(name)]

    def where(self, chosen: np.ndarray) -> Fit:
        """The poses that a mask (b,) or indices choose."""
        return Fit(self.poses[chosen], self.terms[chosen])

    def with_those(self, others: Fit) -> Fit:
        """These and other poses."""
        return Fit(np.concatenate([self.poses, others.poses]), np.concatenate([self.terms, others.terms]))

    def best_first(self) -> Fit:
        """The poses in the order of their goodness, the best first."""
        return self.where(np.argsort(-self.goodness, kind="stable"))


def rotation(angle: np.ndarray) -> np.ndarray:
    """(..., 2, 2) matrix that turns pixel offsets counter-clockwise as seen in the picture (v points down)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([np.stack([c, s], axis=-1), np.stack([-s, c], axis=-1)], axis=-2)


def about_vertical(angle: np.ndarray) -> np.ndarray:
    """(..., 2, 2) matrix that turns x, y counter-clockwise from above."""
    return np.swapaxes(rotation(angle), -1, -2)


def pixels_of(camera: Camera, points: np.ndarray) -> np.ndarray:
    """(..., 2) float32 pixels of world points (..., 3) in front of the camera."""
    matrix = (camera.intrinsics() @ camera.extrinsics()[:3]).astype(np.float32)
    seen = points @ matrix[:, :3].T + matrix[:, 3]
    return seen[..., :2] / np.maximum(seen[..., 2:], np.float32(1e-6))


def placed(template: ObjectTemplate, poses: np.ndarray, points: np.ndarray) -> np.ndarray:
    """(b, n, 3) float32 world points of a template's own points (n, 3) at poses (b, 4)."""
    poses = np.asarray(poses, np.float32)
    scale = np.exp(poses[:, 3])[:, None, None]
    flat = points[:, :2].astype(np.float32) @ np.swapaxes(about_vertical(poses[:, 2]), -1, -2) * scale
    up = np.broadcast_to(points[:, 2].astype(np.float32), flat.shape[:2])[..., None] * scale
    return np.concatenate([flat + poses[:, None, :2], up + np.float32(template.origin[2])], axis=-1)


def turned_towards(template: ObjectTemplate, poses: np.ndarray, at: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """(b, n) components towards the camera of the template's directions (n, 2) at world points (b, n, 3)."""
    turned = directions.astype(np.float32) @ np.swapaxes(about_vertical(np.asarray(poses[:, 2], np.float32)), -1, -2)
    return np.einsum("bnk,bnk->bn", turned, template.camera.pose.p[:2].astype(np.float32) - at[..., :2])


def fit(image: LabImage, template: ObjectTemplate, poses: np.ndarray) -> Fit:
    """The score of the object at each of the poses (b, 4)."""
    poses = np.asarray(poses, np.float64).reshape(-1, 4)
    if not len(poses):
        return Fit(poses, np.zeros((0, len(TERMS))))
    surface, rim = template.surface, template.rim
    count, edge = len(surface.points), len(rim.points)
    beside = np.column_stack([rim.normals, np.zeros(edge)]) * (template.step * template.pixel)
    around = [rim.points + SETTINGS.outside_px * beside, rim.points - SETTINGS.inside_px * beside]
    points = placed(template, poses, np.concatenate([surface.points, *around]))
    seen = image.sample(pixels_of(template.camera, points), template.step)
    inside, outer, inner = seen[:, :count], seen[:, count : count + edge], seen[:, count + edge :]
    # Points that turned away from the camera are hidden; the silhouette is the top's or the bottom's outline.
    shown = _shares(turned_towards(template, poses, points[:, :count], surface.facing) >= 0)
    facing = turned_towards(template, poses, points[:, count : count + edge], rim.normals)
    outline = _shares(facing * rim.upper <= 0)
    weights = np.array([LIGHTNESS, 1, 1], np.float32)
    known, found = surface.colours.astype(np.float32) * weights, inside[..., :3] * weights
    away = found - known
    squares = _squares(away)
    colour = 1 - _mean(np.minimum(np.sqrt(squares), SETTINGS.colour_cap), shown) / SETTINGS.colour_cap
    # Variances as mean squares less squared means.
    left, *energy = (
        _mean(squared, shown) - _squares(np.einsum("bnc,bn->bc", np.broadcast_to(values, found.shape), shown))
        for values, squared in ((away, squares), (known, _squares(known)[None]), (found, _squares(found)))
    )
    structure = 1 - left / (energy[0] + energy[1] + 2 * SETTINGS.pattern_noise**2)
    across = (outer[..., :3] - inner[..., :3]) * weights
    change = np.minimum(np.sqrt(_squares(across)) / SETTINGS.border_contrast, 1)
    border = _mean(np.maximum(1 - outer[..., 3], change), outline)
    fill = _mean(inside[..., 3], shown)
    terms = np.stack([colour, np.clip(structure, 0, 1), fill, border], axis=1).astype(np.float64)
    return Fit(poses, terms)


def _squares(values: np.ndarray) -> np.ndarray:
    """(...,) squared lengths of (..., 3)."""
    return np.einsum("...c,...c->...", values, values)


def _mean(values: np.ndarray, shares: np.ndarray) -> np.ndarray:
    """(b,) weighted means of (b, n) or (1, n) values."""
    return np.einsum("bn,bn->b", np.broadcast_to(values, shares.shape), shares)


def _shares(counted: np.ndarray) -> np.ndarray:
    """(b, n) weights of sum 1 of the points that count."""
    weights = counted.astype(np.float32)
    return weights / np.maximum(weights.sum(axis=1, keepdims=True), 1)


_DIRECTIONS = np.concatenate([np.eye(4), -np.eye(4)])


def refine(image: LabImage, template: ObjectTemplate, poses: np.ndarray, steps: np.ndarray, rounds: int) -> Fit:
    """Each of the poses moved to the best one nearby (pattern search, all poses at once).

    Args:
        poses: (b, 4) to start from.
        steps: (4,) first steps along x, y (metres), angle and log scale; halved where no neighbour is better.
        rounds: in each, all eight neighbours of a pose are tried.
    """
    best = fit(image, template, poses)
    if not len(best.poses):
        return best
    poses, terms, goodness = best.poses.copy(), best.terms.copy(), best.goodness.copy()
    scale = np.ones(len(poses))
    for _ in range(rounds):
        tried = poses[:, None] + _DIRECTIONS[None] * (steps * scale[:, None])[:, None]
        tried[..., 3] = np.clip(tried[..., 3], -SETTINGS.largest_log_scale, SETTINGS.largest_log_scale)
        around = fit(image, template, tried.reshape(-1, 4))
        scores = around.goodness.reshape(len(poses), -1)
        k = scores.argmax(axis=1)
        rows = np.arange(len(poses))
        better = scores[rows, k] > goodness + 1e-6
        poses = np.where(better[:, None], tried[rows, k], poses)
        terms = np.where(better[:, None], around.terms.reshape(len(poses), -1, 4)[rows, k], terms)
        goodness = np.where(better, scores[rows, k], goodness)
        scale = np.where(better, scale, scale / 2)
    return Fit(poses, terms)


def mask_at(template: ObjectTemplate, pose: np.ndarray) -> np.ndarray:
    """(H, W) bool, the silhouette of the proxy in the target picture at a pose (4,)."""
    height, width = template.camera.height, template.camera.width
    # Each layer is the picture of the top face, moved by three of its corners.
    corners = template.centre + template.extent * np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5]])
    flat = template.source_camera.unproject(corners, template.origin[2] + template.layers[-1]) - template.origin
    drawn, top = np.zeros((height, width), np.uint8), template.top.astype(np.uint8)
    u, v, w, h = cv2.boundingRect(top)
    ends = np.array([[u, v, 1], [u + w, v, 1], [u, v + h, 1], [u + w, v + h, 1]])
    for layer in template.layers:
        flat[:, 2] = layer
        moved = pixels_of(template.camera, placed(template, pose[None], flat))[0]
        matrix = cv2.getAffineTransform((corners - 0.5).astype(np.float32), (moved - 0.5).astype(np.float32))
        at = ends @ matrix.T
        u0, v0 = np.clip(at.min(axis=0) - 1, 0, [width, height]).astype(int)
        u1, v1 = np.clip(at.max(axis=0) + 2, 0, [width, height]).astype(int)
        if u0 < u1 and v0 < v1:
            matrix[:, 2] -= u0, v0
            size = (int(u1 - u0), int(v1 - v0))
            drawn[v0:v1, u0:u1] |= np.asarray(cv2.warpAffine(top, matrix, size, flags=cv2.INTER_NEAREST), np.uint8)
    return drawn > 0


def from_pixels(template: ObjectTemplate, poses: np.ndarray) -> np.ndarray:
    """(k, 4) poses from (k, 4): the place of the template's centre (u, v, pixels), turn and log scale.

    A silhouette's centroid is close to the picture of the object's middle, so its ray is cut at half the height. The
    offset from there to the object's origin is measured in the source and turns with the object.
    """
    poses = np.reshape(poses, (-1, 4))
    middle = (template.box[0, 2] + template.box[1, 2]) / 2
    offset = template.origin[:2] - template.source_camera.unproject(template.centre, middle)[:2]
    places = template.camera.unproject(poses[:, :2], middle)[:, :2]
    return np.column_stack([places + about_vertical(poses[:, 2]) @ offset, poses[:, 2:]])


def middles(template: ObjectTemplate, poses: np.ndarray) -> np.ndarray:
    """(b, 2) pixels of the middle of the object at poses (b, 4)."""
    middle = template.box.mean(axis=0) - template.origin
    return pixels_of(template.camera, placed(template, poses, middle[None]))[:, 0]
