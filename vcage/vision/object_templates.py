"""What is compared when a known object is looked for: points on a proxy of its shape, coloured by a picture of it.

The picture is either the scene's own source picture, in which the object's mask is known, or the library's reference
picture of the object from straight above.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from vcage.base.errors import InputFileError
from vcage.base.geometry import Camera, look_at
from vcage.vision.colour import LabImage
from vcage.vision.protocols import Reference

POINTS = 220
"""Points inside an object that are compared."""

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

REFERENCE_DISTANCE = 15.0
"""Metres from the camera of a reference picture to the object's base: the view is parallel to half a percent."""


@dataclass(frozen=True)
class Surface:
    """Seen points of an object.

    Args:
        points: (n, 3) relative to its origin, world axes of the source, metres.
        facing: (n, 2) horizontal directions out of it there; 0 on top.
        colours: (n, 3) Lab there.
    """

    points: np.ndarray
    facing: np.ndarray
    colours: np.ndarray


@dataclass(frozen=True)
class Rim:
    """The outline of an object's top and of its bottom.

    Args:
        points: (m, 3) relative to its origin, world axes of the source, metres.
        normals: (m, 2) horizontal directions out of it there.
        upper: (m,) 1 on the top's outline, -1 on the bottom's, 0 where it is both.
    """

    points: np.ndarray
    normals: np.ndarray
    upper: np.ndarray


@dataclass(frozen=True)
class ObjectTemplate:
    """A known object as it is looked for: its picture on a proxy of its shape.

    The proxy is the object's footprint drawn up to its height. It says where each pixel of the picture goes when the
    object moves to where the camera sees it from another side, and which are hidden there.

    Args:
        source: the picture of the object.
        source_camera: took it; one of its pixels covers as much of the object as one of ``camera``'s.
        camera: takes the pictures in which the object is looked for.
        mask: (H, W) bool, where the object is in the source.
        top: (H, W) bool, pixels of its top face; all of them when the shape is not known.
        centre: (2,) u, v of the middle of its mask, pixels.
        box: (2, 3) its bounding box when the source was taken, world, metres.
        origin: (3,) its origin then; z is the bottom of the box.
        layers: heights above its base at which the top face is drawn to get its outline, metres.
        surface, rim: what of it is compared.
        extent: its longest side, pixels.
        step: how much smaller the pictures are in which it is compared.
        pixel: metres that a pixel covers at half its height.
        shell: points that lie deeper inside the mask than this share of the deepest are not compared; 1 compares all.
    """

    source: LabImage
    source_camera: Camera
    camera: Camera
    mask: np.ndarray
    top: np.ndarray
    centre: np.ndarray
    box: np.ndarray
    origin: np.ndarray
    layers: np.ndarray
    surface: Surface
    rim: Rim
    extent: float
    step: float
    pixel: float
    shell: float

    @property
    def area(self) -> int:
        """Pixels."""
        return int(self.mask.sum())


def template_of(
    source: LabImage,
    mask: np.ndarray,
    source_camera: Camera,
    box: np.ndarray,
    origin: np.ndarray,
    *,
    camera: Camera | None = None,
    shell: float = 1.0,
) -> ObjectTemplate:
    """The template of an object that a picture shows.

    Args:
        source: the picture.
        mask: (H, W) bool, not empty, where it shows the object.
        source_camera: took the picture.
        box: (2, 3) the object's world box there, metres.
        origin: (2,) x, y of its origin there.
        camera: takes the pictures in which it is looked for; None for the same.
        shell: see :class:`ObjectTemplate`.
    """
    centre, extent = _middle_and_extent(mask)
    step = max(1.0, extent / FINE_EXTENT)
    base = np.array([*origin, box[0, 2]])
    top, low, high = _top_and_heights(mask, source_camera, *box[:, 2].tolist())
    seen = _inner(mask, step, shell)
    points, facing = _on_proxy(seen, mask, source_camera, low, high)
    return ObjectTemplate(
        source=source,
        source_camera=source_camera,
        camera=camera or source_camera,
        mask=mask,
        top=top,
        centre=centre,
        box=box,
        origin=base,
        layers=np.linspace(low, high, LAYERS if low < high else 1) - base[2],
        surface=Surface(points - base, facing, source.sample(seen[None], step)[0, :, :3]),
        rim=_rim(top, source_camera, low, high, base),
        extent=extent,
        step=step,
        pixel=_metres_per_pixel(source_camera, centre, (low + high) / 2),
        shell=shell,
    )


def _top_and_heights(mask: np.ndarray, camera: Camera, low: float, high: float) -> tuple[np.ndarray, float, float]:
    """(H, W) bool the top face of the proxy, and from which height to which it stands."""
    top = _top_face(mask, camera, low, high)
    return (top, low, high) if top.sum() >= LEAST_TOP * mask.sum() else (mask, (low + high) / 2, (low + high) / 2)


def template_from_reference(
    reference: Reference, camera: Camera, height: float, *, shell: float = 1.0
) -> ObjectTemplate:
    """The template of an object that is known by its look from above; a pose's angle is the object's heading then.

    Args:
        reference: how it looks.
        camera: takes the pictures in which it is looked for.
        height: of the table that it stands on, metres.
        shell: see :class:`ObjectTemplate`.

    Raises:
        InputFileError: the reference picture shows nothing.
    """
    size = np.array(reference.size)
    middle = np.array([camera.width / 2, camera.height / 2])
    pixel = _metres_per_pixel(camera, middle, height + size[2] / 2)
    zoom = reference.metres_per_pixel / pixel
    width, tall = (max(1, round(zoom * n)) for n in reference.picture.shape[1::-1])
    solid = reference.picture[..., 3] > 127
    if not solid.any():
        raise InputFileError(f"the reference picture of {reference.phrase!r} shows nothing", hint="render it anew")
    # Around the object lies its own mean colour: what is mixed in at its edge changes nothing.
    alone = np.where(solid[..., None], reference.picture[..., :3], reference.picture[solid][:, :3].mean(axis=0))
    scaled = cv2.resize(alone.astype(np.uint8), (width, tall), interpolation=cv2.INTER_AREA)
    mask = cv2.resize(solid.astype(np.float32), (width, tall), interpolation=cv2.INTER_AREA) > 0.5
    fovy = 2 * np.arctan(tall * pixel / 2 / REFERENCE_DISTANCE)
    above = look_at([0, 0, height + REFERENCE_DISTANCE], [0, 0, height], up=(0, 1, 0))
    box = np.array([[*-size[:2] / 2, height], [*size[:2] / 2, height + size[2]]])
    source = LabImage.of(scaled, np.zeros(mask.shape, np.float32))
    return template_of(source, mask, Camera(width, tall, fovy, above), box, np.zeros(2), camera=camera, shell=shell)


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


def _middle_and_extent(mask: np.ndarray) -> tuple[np.ndarray, float]:
    """(2,) u, v of the middle of a mask, and its longest side, pixels."""
    v, u = np.nonzero(mask)
    pixels = np.stack([u, v], axis=1) + 0.5
    _, sides, _ = cv2.minAreaRect(pixels.astype(np.float32))
    return pixels.mean(axis=0), float(max(sides)) + 1


def _metres_per_pixel(camera: Camera, at: np.ndarray, height: float) -> float:
    """Metres that the pixel at (2,) covers at a height."""
    return float(np.linalg.norm(np.diff(camera.unproject([at, at + [1, 0]], height), axis=0)))


def _rim(top: np.ndarray, camera: Camera, low: float, high: float, base: np.ndarray) -> Rim:
    """The rim of an object whose top face (H, W) bool is seen, relative to (3,) its origin; one outline if it is
    flat."""
    edge, normals = _outline(top)
    chosen = np.linspace(0, len(edge) - 1, min(RIM_POINTS // 2, len(edge))).astype(int)
    around = camera.unproject(edge[chosen], high)[:, :2]
    out = camera.unproject(edge[chosen] + normals[chosen], high)[:, :2] - around
    out = out / (np.linalg.norm(out, axis=1, keepdims=True) + 1e-9)
    heights = (high, low) if low < high else (high,)
    points = np.concatenate([np.column_stack([around, np.full(len(around), z)]) for z in heights]) - base
    upper = np.repeat([1.0, -1.0], len(around)) if low < high else np.zeros(len(around))
    return Rim(points, np.tile(out, (len(heights), 1)), upper)


def _inner(mask: np.ndarray, step: float, shell: float) -> np.ndarray:
    """(n, 2) at most :data:`POINTS` pixels of a mask, deep enough not to mix with what is around, within the shell."""
    u, v, width, height = cv2.boundingRect(mask.astype(np.uint8))
    window = np.s_[v : v + height, u : u + width]
    depth = cv2.distanceTransform(np.pad(mask[window].astype(np.uint8), 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
    deep = (depth >= min(step, 0.5 * depth.max())) & (depth <= shell * depth.max())
    rows, columns = np.nonzero(deep)
    return _spread_out(np.stack([columns + u, rows + v], axis=1) + 0.5, POINTS)


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
    cv2.drawContours(window, [contour - [u0, v0]], -1, (1.0,), cv2.FILLED)
    soft = cv2.GaussianBlur(window, (0, 0), 1.5)
    at = contour - [u0, v0]
    slopes = [cv2.Sobel(soft, cv2.CV_32F, *order)[at[:, 1], at[:, 0]] for order in ((1, 0), (0, 1))]
    normals = -np.stack(slopes, axis=1)
    return contour + 0.5, normals / (np.linalg.norm(normals, axis=1, keepdims=True) + 1e-9)
