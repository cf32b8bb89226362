"""Templates of known objects: points on a proxy of an object's shape, coloured by a picture of it.

The picture is either the scene's own source picture, in which the object's mask is known, or the library's reference
picture of the object from straight above.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.base.errors import InputFileError
from vcage.base.geometry import Camera, look_at
from vcage.sim.drawer import REFERENCE_DISTANCE_M
from vcage.vision.colour import LabImage
from vcage.vision.protocols import Reference


@dataclass(frozen=True)
class TemplateSettings:
    """Size and sampling of a template.

    Args:
        surface_points: compared points inside an object.
        rim_points: compared points along its outline.
        extent_px: larger objects are compared in a smaller picture, in which they have this longest side.
        least_top_share: an object of whose silhouette less is its top is no upright prism; its proxy is flat, at half
            its height.
        layers: copies of the top face, from the bottom up, that make the outline of the proxy.
        ray_steps: heights at which a ray is tested for meeting the proxy.
    """

    surface_points: int = 220
    rim_points: int = 80
    extent_px: float = 44.0
    least_top_share: float = 0.25
    layers: int = 3
    ray_steps: int = 9


SETTINGS = TemplateSettings()


@dataclass(frozen=True)
class Surface:
    """Visible points of an object.

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
    """A known object: its picture on a proxy of its shape.

    The proxy is the object's footprint drawn up to its height. When the object moves and the camera sees it from
    another side, the proxy tells where each pixel of the picture goes and which pixels are hidden.

    Args:
        source: the picture of the object.
        source_camera: took it; one of its pixels covers as much of the object as one of ``camera``'s.
        camera: takes the pictures in which the object is searched.
        mask: (H, W) bool, the object's place in the source.
        top: (H, W) bool, pixels of its top face; all of them when the shape is not known.
        centre: (2,) u, v of the middle of its mask, pixels.
        box: (2, 3) its bounding box when the source was taken, world, metres.
        origin: (3,) its origin then; z is the bottom of the box.
        layers: heights above its base at which the top face is drawn to get its outline, metres.
        surface, rim: compared points.
        extent: its longest side, pixels.
        step: factor by which the compared pictures are smaller.
        pixel: metres that a pixel covers at half its height.
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

    @property
    def area(self) -> int:
        """Pixels."""
        return int(self.mask.sum())


def template_of(
    source: LabImage,
    mask: np.ndarray,
    source_camera: Camera,
    box: np.ndarray,
    origin: Sequence[float] | np.ndarray,
    *,
    camera: Camera | None = None,
) -> ObjectTemplate:
    """The template of an object that a picture shows.

    Args:
        source: the picture.
        mask: (H, W) bool, not empty, the object's place in it.
        source_camera: took the picture.
        box: (2, 3) the object's world box there, metres.
        origin: (2,) x, y of its origin there.
        camera: takes the pictures in which it is searched; None for the same.
    """
    centre, extent = _middle_and_extent(mask)
    step = max(1.0, extent / SETTINGS.extent_px)
    base = np.array([*origin, box[0, 2]])
    top, low, high = _top_and_heights(mask, source_camera, *box[:, 2].tolist())
    seen = _inner(mask, step)
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
        layers=np.linspace(low, high, SETTINGS.layers if low < high else 1) - base[2],
        surface=Surface(points - base, facing, source.sample(seen[None], step)[0, :, :3]),
        rim=_rim(top, source_camera, low, high, base),
        extent=extent,
        step=step,
        pixel=_metres_per_pixel(source_camera, centre, (low + high) / 2),
    )


def _top_and_heights(mask: np.ndarray, camera: Camera, low: float, high: float) -> tuple[np.ndarray, float, float]:
    """(H, W) bool the top face of the proxy, and the heights of its bottom and top, metres."""
    top, middle = _top_face(mask, camera, low, high), (low + high) / 2
    return (top, low, high) if top.sum() >= SETTINGS.least_top_share * mask.sum() else (mask, middle, middle)


def template_from_reference(reference: Reference, camera: Camera, height: float) -> ObjectTemplate:
    """The template of an object of which a picture from above is known; a pose's angle is its heading then.

    Args:
        reference: its look.
        camera: takes the pictures in which it is searched.
        height: of the table that it stands on, metres.

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
        raise InputFileError(f"the reference picture of {reference.phrase!r} shows nothing", hint="render it again")
    # The ground gets the object's mean colour, so that resampling does not change the colours at its edge.
    alone = np.where(solid[..., None], reference.picture[..., :3], reference.picture[solid][:, :3].mean(axis=0))
    scaled = cv2.resize(alone.astype(np.uint8), (width, tall), interpolation=cv2.INTER_AREA)
    mask = cv2.resize(solid.astype(np.float32), (width, tall), interpolation=cv2.INTER_AREA) > 0.5
    fovy = 2 * np.arctan(tall * pixel / 2 / REFERENCE_DISTANCE_M)
    above = look_at([0, 0, height + REFERENCE_DISTANCE_M], [0, 0, height], up=(0, 1, 0))
    box = np.array([[*-size[:2] / 2, height], [*size[:2] / 2, height + size[2]]])
    source = LabImage.of(scaled, np.zeros(mask.shape, np.float32))
    return template_of(source, mask, Camera(width, tall, fovy, above), box, np.zeros(2), camera=camera)


def _inside(mask: np.ndarray, camera: Camera, points: np.ndarray) -> np.ndarray:
    """(...,) bool, True for world points (..., 3) whose pixels lie inside a mask."""
    pixels = np.floor(camera.project(points))
    seen = np.all((pixels >= 0) & (pixels < [mask.shape[1], mask.shape[0]]), axis=-1)
    u, v = (np.where(seen, pixels[..., k], 0).astype(int) for k in (0, 1))
    return seen & mask[v, u]


def _top_face(mask: np.ndarray, camera: Camera, low: float, high: float) -> np.ndarray:
    """(H, W) bool, pixels of a silhouette that show the top: the silhouette continues straight below them.

    Of an upright prism exactly the pictures of top and bottom both lie in the silhouette.
    """
    v, u = np.nonzero(mask)
    below = camera.unproject(np.stack([u, v], axis=1) + 0.5, high)
    below[:, 2] = low
    top = np.zeros_like(mask)
    shown = _inside(mask, camera, below)
    top[v[shown], u[shown]] = True
    return top


def _on_proxy(
    pixels: np.ndarray, mask: np.ndarray, camera: Camera, low: float, high: float
) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) points where the rays through pixels (n, 2) meet the proxy, and the directions (n, 2) it faces there."""
    heights = np.linspace(high, low, SETTINGS.ray_steps)
    along = np.stack([camera.unproject(pixels, z) for z in heights])  # (s, n, 3)
    ends = [np.concatenate([along[..., :2], np.full((*along.shape[:2], 1), z)], axis=-1) for z in (low, high)]
    hit = _inside(mask, camera, ends[0]) & _inside(mask, camera, ends[1])
    first = np.where(hit.any(axis=0), hit.argmax(axis=0), SETTINGS.ray_steps // 2)
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
    """The rim of an object with a visible top face (H, W) bool, relative to its origin (3,).

    A flat object has one outline.
    """
    edge, normals = _outline(top)
    chosen = np.linspace(0, len(edge) - 1, min(SETTINGS.rim_points // 2, len(edge))).astype(int)
    around = camera.unproject(edge[chosen], high)[:, :2]
    out = camera.unproject(edge[chosen] + normals[chosen], high)[:, :2] - around
    out = out / (np.linalg.norm(out, axis=1, keepdims=True) + 1e-9)
    heights = (high, low) if low < high else (high,)
    points = np.concatenate([np.column_stack([around, np.full(len(around), z)]) for z in heights]) - base
    upper = np.repeat([1.0, -1.0], len(around)) if low < high else np.zeros(len(around))
    return Rim(points, np.tile(out, (len(heights), 1)), upper)


def _inner(mask: np.ndarray, step: float) -> np.ndarray:
    """(n, 2) pixels of a mask that lie deep enough not to mix with their surroundings, evenly spread."""
    u, v, width, height = cv2.boundingRect(mask.astype(np.uint8))
    window = np.s_[v : v + height, u : u + width]
    depth = cv2.distanceTransform(np.pad(mask[window].astype(np.uint8), 1), cv2.DIST_L2, 5)[1:-1, 1:-1]
    rows, columns = np.nonzero(depth >= min(step, 0.5 * depth.max()))
    return _spread_out(np.stack([columns + u, rows + v], axis=1) + 0.5, SETTINGS.surface_points)


def _spread_out(points: np.ndarray, count: int) -> np.ndarray:
    """At most ``count`` of the points, evenly spread."""
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
