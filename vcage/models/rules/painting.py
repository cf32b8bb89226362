"""Draws objects of a picture at other places: with perspective, shading and shadows, the far ones first."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from vcage.base.geometry import Camera, Pose, box_corners, rotation_2d, wrap_angle
from vcage.models.rules.cutouts import Cutout
from vcage.models.rules.light import Light
from vcage.models.rules.prism import Prism, cells_of, look_up, prism_of


@dataclass(frozen=True)
class PaintSettings:
    """Measures of a drawn object.

    Args:
        lean_px: how far neighbouring slices of a tall object may be apart in the picture.
        pad_px: room around an object in the window that it is drawn in.
        shading: least and largest change of a side's brightness when it is turned in the light.
        sharpness: slope of the edge of a slice, which interpolation has made soft twice.
        softness_px: standard deviation of the blur of a shadow's edge.
    """

    lean_px: float = 1.5
    pad_px: int = 12
    shading: tuple[float, float] = (0.6, 1.6)
    sharpness: float = 2.0
    softness_px: float = 1.0


SETTINGS = PaintSettings()


@dataclass(frozen=True)
class Painting:
    """A picture (H, W, 3) uint8 and the share of each object's pixels that are seen in it."""

    picture: np.ndarray
    visible: dict[str, float]

    @property
    def least_visible(self) -> float:
        """The share of the object that is seen the least."""
        return min(self.visible.values(), default=1.0)

    def hidden(self, least: float) -> list[str]:
        """Objects with less than this share visible."""
        return [name for name, share in self.visible.items() if share < least]


@dataclass(frozen=True)
class _Move:
    """A new place of an object: (2,) world x, y of its box's centre, and its turn, radians."""

    centre: np.ndarray
    turn: float


@dataclass(frozen=True)
class _Sprite:
    """An object at its new place, and its pixels in a window whose upper left pixel is ``corner`` (u, v)."""

    item: Cutout
    prism: Prism
    move: _Move
    corner: tuple[int, int]
    colour: np.ndarray
    alpha: np.ndarray


@dataclass(frozen=True)
class View:
    """The conditions under which pictures were taken.

    Args:
        camera: of the pictures.
        light: None if it is unknown; no shadows are drawn then.
        table_z: height in metres of the surface that shadows fall on.
    """

    camera: Camera
    light: Light | None
    table_z: float


def paint_objects(
    picture: np.ndarray,
    background: np.ndarray,
    items: Sequence[Cutout],
    poses: Mapping[str, Pose],
    view: View,
    covered: Collection[str] = (),
) -> Painting:
    """Paint objects at their poses over the background; they turn about the vertical, and stay as high as they are.

    Args:
        picture: (H, W, 3) uint8, from which the objects were cut.
        background: (H, W, 3) uint8, the empty table.
        items: the objects.
        poses: in the world, by id.
        view: of both pictures.
        covered: objects that others may lie in or on; how much of them is seen does not matter.
    """
    shown = [item for item in items if not item.hidden]
    moves = {item.record.id: _move(item, poses[item.record.id]) for item in shown}
    order = sorted(shown, key=lambda item: _depth(item, moves[item.record.id], view.camera))
    sprites = [_sprite(item, items, moves[item.record.id], picture, view) for item in order]
    canvas = background.astype(np.float32)
    if view.light is not None and sprites:
        shade = np.max([_cast(s, view, view.light, background.shape[:2]) for s in sprites], axis=0)
        shade = cv2.GaussianBlur(shade, (0, 0), SETTINGS.softness_px)[..., None]
        canvas *= 1 - shade * (1 - view.light.left)
    owner = np.full(background.shape[:2], -1)
    drawn = {}
    for index, sprite in enumerate(sprites):
        drawn[sprite.item.record.id] = int((sprite.alpha > 0.5).sum())
        (rows, columns), inner = _window_of(sprite, background.shape)
        alpha = sprite.alpha[inner][..., None]
        canvas[rows, columns] = canvas[rows, columns] * (1 - alpha) + sprite.colour[inner]
        owner[rows, columns][alpha[..., 0] > 0.5] = index
    visible = {
        s.item.record.id: float((owner == i).sum() / max(drawn[s.item.record.id], 1))
        for i, s in enumerate(sprites)
        if s.item.record.id not in covered
    }
    return Painting(np.clip(np.rint(canvas), 0, 255).astype(np.uint8), visible)


def _move(item: Cutout, pose: Pose) -> _Move:
    before = item.record.pose.pose()
    turn = float(wrap_angle(pose.yaw - before.yaw))
    return _Move(pose.p[:2] + rotation_2d(turn) @ (item.centre - before.p[:2]), turn)


def _depth(item: Cutout, move: _Move, camera: Camera) -> tuple[float, float]:
    """Sorts hidden objects before hiding ones: far from the camera first, and supports before their contents."""
    away = move.centre - camera.pose.p[:2]
    return round(item.box[0, 2], 2), -float(np.linalg.norm(away))


def _sprite(item: Cutout, items: Sequence[Cutout], move: _Move, picture: np.ndarray, view: View) -> _Sprite:
    """The object's pixels at its new place, slice upon slice."""
    camera = view.camera
    whole = _with_contents(item, items)
    slices = 1 + int(
        np.ceil(max(_lean(item, item.centre, camera), _lean(item, move.centre, camera)) / SETTINGS.lean_px)
    )
    prism = prism_of(whole, camera, slices)
    colour = _spread_colour(picture, item.mask, whole.mask)
    corner, shape = _window(item, move, camera)
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    pixels = np.stack([columns + corner[0], rows + corner[1]], axis=-1) + 0.5
    pasted, covered = np.zeros((*shape, 3), np.float32), np.zeros(shape, np.float32)
    turn = rotation_2d(move.turn)
    for index, z in enumerate(prism.heights):
        here = (camera.unproject(pixels, z)[..., :2] - move.centre) @ turn
        alpha = np.clip(SETTINGS.sharpness * (prism.sample(index, here)[..., None] - 0.5) + 0.5, 0, 1)
        top = index == len(prism.heights) - 1
        unseen = _unseen(prism, index, camera)
        hidden = look_up(unseen, cells_of(here, unseen))[..., None] > 0.5
        there = here if top else np.where(hidden, 2 * prism.axis - here, here)
        lift = np.full((*here.shape[:-1], 1), z)
        source = (camera.project(np.concatenate([prism.origin + there, lift], axis=-1)) - 0.5).astype(np.float32)
        layer = cv2.remap(colour, source[..., 0], source[..., 1], cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
        if view.light is not None and not top:
            shade = _side_shading(prism, index, move.turn, view.light, unseen)
            layer = layer * (1 + look_up(shade - 1, cells_of(here, shade)))[..., None]
        pasted = pasted * (1 - alpha) + layer * alpha
        covered = covered * (1 - alpha[..., 0]) + alpha[..., 0]
    return _Sprite(item, prism, move, corner, pasted, covered)


def _with_contents(item: Cutout, items: Sequence[Cutout]) -> Cutout:
    """The object with its pixels hidden by its own contents."""
    contents = [other.mask for other in items if other.record.container == item.record.id]
    return replace(item, mask=np.any([item.mask, *contents], axis=0)) if contents else item


def _lean(item: Cutout, centre: np.ndarray, camera: Camera) -> float:
    """Distance of the top of the object's box from its base in the picture, pixels."""
    ends = np.array([[*centre, z] for z in item.box[:, 2]])
    base, top = camera.project(ends)
    spread = np.linalg.norm(item.size) / 2
    wider = camera.focal * spread * np.ptp(1 / (camera.pose.p[2] - item.box[:, 2]))
    return float(np.linalg.norm(top - base) + wider)


def _spread_colour(picture: np.ndarray, mask: np.ndarray, whole: np.ndarray) -> np.ndarray:
    """The picture (float32) with the object's own colours where something lies over it, and around its outline."""
    reach = cv2.dilate((mask | whole).astype(np.uint8), np.ones((9, 9), np.uint8))
    return cv2.inpaint(picture, reach * ~mask, 3, cv2.INPAINT_TELEA).astype(np.float32)


def _window(item: Cutout, move: _Move, camera: Camera) -> tuple[tuple[int, int], tuple[int, int]]:
    """Upper left pixel (u, v) and shape (rows, columns) of what the object can cover, not cut at the picture's edge."""
    half = item.half_size(move.turn)
    corners = box_corners([*(move.centre - half), item.box[0, 2]], [*(move.centre + half), item.box[1, 2]])
    pixels = camera.project(corners)
    lower = np.floor(pixels.min(axis=0)).astype(int) - SETTINGS.pad_px
    upper = np.ceil(pixels.max(axis=0)).astype(int) + SETTINGS.pad_px
    return (int(lower[0]), int(lower[1])), (int(upper[1] - lower[1]), int(upper[0] - lower[0]))


def _window_of(sprite: _Sprite, shape: Sequence[int]) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
    """(rows and columns of the picture, the same in the sprite's window), cut at the picture's edge."""
    outer, inner = [], []
    for start, length, limit in zip(sprite.corner[::-1], sprite.alpha.shape, shape[:2], strict=True):
        low, high = min(max(start, 0), limit), max(min(start + length, limit), 0)
        high = max(low, high)
        outer.append(slice(low, high))
        inner.append(slice(low - start, high - start))
    return (outer[0], outer[1]), (inner[0], inner[1])


def _unseen(prism: Prism, index: int, camera: Camera) -> np.ndarray:
    """(rows, columns) float32: 1 at the rim of a slice where its side faces away from the camera in the source."""
    normals = prism.normals(index)
    away = normals @ (camera.pose.p[:2] - prism.origin) <= 0
    rim = np.linalg.norm(normals, axis=-1) > 0.5
    return (away & rim & (prism.opposite(index) > 0.5)).astype(np.float32)


def _side_shading(prism: Prism, index: int, turn: float, light: Light, unseen: np.ndarray) -> np.ndarray:
    """(rows, columns) factor of the picture's brightness for the rim of a slice that is turned in the light.

    A side visible in the source was lit as it stood there; for a hidden one the opposite side stands in.
    """
    normals = prism.normals(index)
    strength = np.linalg.norm(normals, axis=-1)
    after = light.on_side(normals @ rotation_2d(turn).T)
    before = light.on_side(np.where(unseen[..., None] > 0, -normals, normals))
    factor = np.where(strength > 0.5, np.clip(after / before, *SETTINGS.shading), 1.0)
    return cv2.GaussianBlur(factor.astype(np.float32), (0, 0), 2)


def _cast(sprite: _Sprite, view: View, light: Light, shape: tuple[int, ...]) -> np.ndarray:
    """(H, W) in [0, 1]: the object's shadow on the table."""
    camera, table = view.camera, view.table_z
    shade = np.zeros(shape, np.float32)
    half = sprite.item.half_size(sprite.move.turn) + SETTINGS.pad_px / camera.focal
    tops = [sprite.move.centre + light.offset * (z - table) for z in sprite.item.box[:, 2]]
    corners = [[*(top + sign * half), table] for top in tops for sign in (-1, 1)]
    pixels = camera.project(np.array(corners))
    lower = np.clip(np.floor(pixels.min(axis=0)).astype(int), 0, [shape[1], shape[0]])
    upper = np.clip(np.ceil(pixels.max(axis=0)).astype(int), lower, [shape[1], shape[0]])
    if np.any(upper <= lower):
        return shade
    rows, columns = np.mgrid[lower[1] : upper[1], lower[0] : upper[0]]
    points = camera.unproject(np.stack([columns, rows], axis=-1) + 0.5, table)[..., :2]
    turn = rotation_2d(sprite.move.turn)
    swept = np.zeros(rows.shape, np.float32)
    for index, z in enumerate(sprite.prism.heights):
        here = points - sprite.move.centre - light.offset * (z - table)
        swept = np.maximum(swept, sprite.prism.sample(index, here @ turn))
    shade[lower[1] : upper[1], lower[0] : upper[0]] = swept
    return shade
