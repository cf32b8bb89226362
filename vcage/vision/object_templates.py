"""What is compared when a known object is looked for: points of its crop in one picture, samples of another."""

from __future__ import annotations

from dataclasses import dataclass, field

import cv2
import numpy as np

from vcage.base.geometry import Camera
from vcage.schema.scene import ObjectRecord
from vcage.vision.colour import to_lab

POINTS = 220
"""Points inside an object that are compared."""

DENSE_POINTS = 700
"""Points that are compared once an object is found."""

RIM_POINTS = 80
"""Points along its outline."""

FINE_EXTENT = 44.0
"""Objects that are larger than this are compared in a smaller picture, pixels."""

RIM_OUT, RIM_IN = 2.5, 2.0
"""How far from the outline the pixels beside it are taken, outwards and inwards, in pixels of the compared size."""


LEAST_TOP = 0.25
"""An object of whose silhouette less is its top is no upright prism; it is taken as flat, at half its height."""

LAYERS = 3
"""Copies of the top face, from the bottom up, that make the outline of the proxy."""

RAY_STEPS = 9
"""Heights at which a ray is tested for meeting the proxy."""


@dataclass(frozen=True)
class View:
    """A picture as it is compared.

    Args:
        lab: (H, W, 3) float32 CIELAB.
        salience: (H, W) float32 in [0, 1], how surely a pixel is no table.
    """

    lab: np.ndarray
    salience: np.ndarray
    _levels: dict[float, np.ndarray] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, picture: np.ndarray, salience: np.ndarray) -> View:
        """From an (H, W, 3) uint8 picture."""
        return cls(to_lab(picture), salience)

    def level(self, step: float) -> np.ndarray:
        """(h, w, 4) Lab and salience, ``step`` times smaller."""
        if step not in self._levels:
            if step == 1:
                self._levels[step] = np.dstack([self.lab, self.salience])
            else:
                height, width = self.salience.shape
                size = (max(1, round(width / step)), max(1, round(height / step)))
                self._levels[step] = cv2.resize(self.level(1), size, interpolation=cv2.INTER_AREA)
        return self._levels[step]

    def sample(self, pixels: np.ndarray, step: float) -> np.ndarray:
        """(..., 4) Lab and salience at pixels (..., 2) of the full picture, taken ``step`` times smaller."""
        flat = np.asarray(pixels, np.float32).reshape(len(pixels), -1, 2)
        level = self.level(step)
        u = flat[..., 0] * np.float32(level.shape[1] / self.lab.shape[1]) - np.float32(0.5)
        v = flat[..., 1] * np.float32(level.shape[0] / self.lab.shape[0]) - np.float32(0.5)
        taken = cv2.remap(level, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return taken.reshape(*np.shape(pixels)[:-1], 4)


@dataclass(frozen=True)
class Crop:
    """A known object as it is looked for: its picture on a proxy of its shape.

    The proxy is the object's footprint drawn up to its height. It says where each pixel of the crop goes when the
    object moves to where the camera sees it from another side, and which are hidden there.

    Args:
        record: the object.
        camera: took the source picture.
        centre: (2,) u, v of the middle of its mask, pixels.
        mask: (H, W) bool, where it is in the source picture.
        top: (H, W) bool, pixels of its top face; all of them when the shape is not known.
        layers: heights above its base at which the top face is drawn to get its outline, metres.
        points: (n, 3) seen points of it, relative to its origin, world axes of the source, metres.
        facing: (n, 2) horizontal directions out of it there; 0 on top.
        colours: (n, 3) Lab there.
        rim: (m, 3) points of the outline of its top and of its bottom.
        normals: (m, 2) horizontal directions out of it there.
        upper: (m,) 1 on the top's outline, -1 on the bottom's, 0 where it is both.
        extent: its longest side, pixels.
        step: how much smaller the pictures are in which it is compared.
        pixel: metres that a pixel covers at half its height.
    """

    record: ObjectRecord
    camera: Camera
    centre: np.ndarray
    mask: np.ndarray
    top: np.ndarray
    layers: np.ndarray
    points: np.ndarray
    facing: np.ndarray
    colours: np.ndarray
    rim: np.ndarray
    normals: np.ndarray
    upper: np.ndarray
    extent: float
    step: float
    pixel: float

    @property
    def area(self) -> int:
        """Pixels."""
        return int(self.mask.sum())


def crop_of(view: View, mask: np.ndarray, camera: Camera, record: ObjectRecord) -> Crop:
    """The crop of the object with this mask (H, W), not empty, in the view of the source picture."""
    v, u = np.nonzero(mask)
    pixels = np.stack([u, v], axis=1) + 0.5
    centre = pixels.mean(axis=0)
    _, sides, _ = cv2.minAreaRect(pixels.astype(np.float32))
    extent = float(max(sides)) + 1
    step = max(1.0, extent / FINE_EXTENT)
    low, high = record.aabb[0][2], record.aabb[1][2]
    origin = np.array([*record.pose.position[:2], low])
    top = _top_face(mask, camera, low, high)
    prism = top.sum() >= LEAST_TOP * mask.sum()
    if not prism:
        top, low, high = mask, (low + high) / 2, (low + high) / 2
    inner = _spread_out(_inner(mask, u, v, step), POINTS)
    points, facing = _on_proxy(inner, mask, camera, low, high)
    edge, normals = _outline(top)
    chosen = np.linspace(0, len(edge) - 1, min(RIM_POINTS // 2, len(edge))).astype(int)
    pixel = float(np.linalg.norm(np.diff(camera.unproject([centre, centre + [1, 0]], (low + high) / 2), axis=0)))
    around = camera.unproject(edge[chosen], high)
    out = camera.unproject(edge[chosen] + normals[chosen], high) - around
    out = out[:, :2] / (np.linalg.norm(out[:, :2], axis=1, keepdims=True) + 1e-9)
    heights = (high, low) if prism else (high,)
    rim = np.concatenate([np.column_stack([around[:, :2], np.full(len(around), z)]) for z in heights])
    return Crop(
        record=record,
        camera=camera,
        centre=centre,
        mask=mask,
        top=top,
        layers=np.linspace(low, high, LAYERS if prism else 1) - origin[2],
        points=points - origin,
        facing=facing,
        colours=view.sample(inner[None], step)[0, :, :3],
        rim=rim - origin,
        normals=np.tile(out, (len(heights), 1)),
        upper=np.repeat([1.0, -1.0], len(around)) if prism else np.zeros(len(around)),
        extent=extent,
        step=step,
        pixel=pixel,
    )


def dense_points(crop: Crop) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(n, 2) source pixels of an object, (n, 3) its points there and (n, 2) directions, as in :class:`Crop`."""
    v, u = np.nonzero(crop.mask)
    base = crop.record.aabb[0][2]
    pixels = _spread_out(_inner(crop.mask, u, v, 1.0), DENSE_POINTS)
    points, facing = _on_proxy(pixels, crop.mask, crop.camera, base + crop.layers[0], base + crop.layers[-1])
    return pixels, points - [*crop.record.pose.position[:2], base], facing


def _inside(mask: np.ndarray, camera: Camera, points: np.ndarray) -> np.ndarray:
    """(...,) bool: which world points (..., 3) are drawn inside a mask."""
    pixels = np.floor(camera.project(points))
    seen = np.all((pixels >= 0) & (pixels < [mask.shape[1], mask.shape[0]]), axis=-1)
    u, v = (np.where(seen, pixels[..., k], 0).astype(int) for k in (0, 1))
    return seen & mask[v, u]


def _top_face(mask: np.ndarray, camera: Camera, low: float, high: float) -> np.ndarray:
    """(H, W) bool: pixels of a silhouette that show the top: straight below them the silhouette goes on.

    For an upright prism the top's and the bottom's pictures lie both in the silhouette, and nothing else's do.
    """
    v, u = np.nonzero(mask)
    below = camera.unproject(np.stack([u, v], axis=1) + 0.5, high)
    below[:, 2] = low
    top = np.zeros_like(mask)
    kept = _inside(mask, camera, below)
    top[v[kept], u[kept]] = True
    return top


def _on_proxy(
    pixels: np.ndarray, mask: np.ndarray, camera: Camera, low: float, high: float
) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) where the rays through pixels (n, 2) meet the proxy, and the directions (n, 2) that it faces there."""
    heights = np.linspace(high, low, RAY_STEPS)
    along = np.stack([camera.unproject(pixels, z) for z in heights])  # (s, n, 3)
    ends = [np.concatenate([along[..., :2], np.full((*along.shape[:2], 1), z)], axis=-1) for z in (low, high)]
    hit = _inside(mask, camera, ends[0]) & _inside(mask, camera, ends[1])
    first = np.where(hit.any(axis=0), hit.argmax(axis=0), RAY_STEPS // 2)
    points = along[first, np.arange(len(pixels))]
    away = points[:, :2] - points[first == 0, :2].mean(axis=0) if (first == 0).any() else points[:, :2] * 0
    away = away / (np.linalg.norm(away, axis=1, keepdims=True) + 1e-9)
    return points, np.where((first == 0)[:, None], 0.0, away)


def _inner(mask: np.ndarray, u: np.ndarray, v: np.ndarray, step: float) -> np.ndarray:
    """(n, 2) pixels of a mask that lie deep enough not to mix with what is around; all when it is thin."""
    window = np.s_[v.min() : v.max() + 1, u.min() : u.max() + 1]
    depth = cv2.distanceTransform(np.pad(mask[window].astype(np.uint8), 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
    deep = depth >= min(step, 0.5 * depth.max())
    rows, columns = np.nonzero(deep)
    return np.stack([columns + u.min(), rows + v.min()], axis=1) + 0.5


def _spread_out(points: np.ndarray, count: int) -> np.ndarray:
    """At most ``count`` of the points, evenly spread: every so many along a grid that is finer than needed."""
    if len(points) <= count:
        return points
    # A stride that shares no factor with the row length would alias; golden-ratio steps do not.
    order = np.argsort((np.arange(len(points)) * 0.6180339887498949) % 1, kind="stable")
    return points[np.sort(order[:count])]


def _outline(mask: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pixels along the outline of a mask and the outward directions there, (m, 2) each."""
    contours, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    contour = max(contours, key=len)[:, 0]
    u0, v0 = contour.min(axis=0) - 6
    u1, v1 = contour.max(axis=0) + 7
    window = np.zeros((v1 - v0, u1 - u0), np.float32)
    cv2.drawContours(window, [contour - [u0, v0]], -1, 1.0, cv2.FILLED)
    soft = cv2.GaussianBlur(window, (0, 0), 1.5)
    at = contour - [u0, v0]
    slopes = [cv2.Sobel(soft, cv2.CV_32F, *order)[at[:, 1], at[:, 0]] for order in ((1, 0), (0, 1))]
    normals = -np.stack(slopes, axis=1)
    return contour + 0.5, normals / (np.linalg.norm(normals, axis=1, keepdims=True) + 1e-9)
