"""The shape of an object as far as its picture from above and its box tell it: a stack of slices of its outline.

A slice holds the points of one height that the picture can show as the object, that are in the object's box, and whose
opposite points are too: most objects look alike on the side hidden from the camera. So a bottle keeps its
narrow neck and a bowl its narrow foot. The remaining pixels (a handle) stand at the middle height.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from scipy.fft import irfft2, next_fast_len, rfft2

from vcage.base.geometry import Camera
from vcage.models.rules.cutouts import Cutout


@dataclass(frozen=True)
class PrismSettings:
    """Settings of the prism that is cut out of a picture.

    Args:
        cell_m: edge of a cell of a slice.
        brim_m: margin of slices around the object's box; masks end between pixels.
        symmetry_gain: factor by which more of the object must have an opposite about another centre than the box's.
        lopsided_share: an object with more pixels without an opposite is taken as seen (a banana).
        min_slices, max_slices: number of slices.
    """

    cell_m: float = 0.001
    brim_m: float = 0.004
    symmetry_gain: float = 1.08
    lopsided_share: float = 0.25
    min_slices: int = 2
    max_slices: int = 40


SETTINGS = PrismSettings()


@dataclass(frozen=True)
class Prism:
    """A stack of slices as the object stands in the source picture.

    Args:
        origin: (2,) world x, y of the box's centre, the middle of every slice.
        heights: (k,) z of the slices, upwards.
        axis: (2,) the upright line that opposite points lie about, relative to the origin, metres.
        slices: (k, rows, columns) float32 in [0, 1], how far each cell is the object; rows along y, columns along x.
    """

    origin: np.ndarray
    heights: np.ndarray
    slices: np.ndarray
    axis: np.ndarray

    def sample(self, index: int, points: np.ndarray) -> np.ndarray:
        """(…) how far points (…, 2) of the slice, relative to its middle, are the object."""
        return look_up(self.slices[index], cells_of(points, self.slices[index]))

    def opposite(self, index: int) -> np.ndarray:
        """(rows, columns) the slice turned by half about the axis."""
        cells = self.slices[index]
        return _opposite(cells, self.axis / SETTINGS.cell_m + (np.array(cells.shape[::-1]) - 1) / 2)

    def normals(self, index: int) -> np.ndarray:
        """(rows, columns, 2) direction out of the slice, of unit length where its rim is near."""
        smooth = cv2.GaussianBlur(self.slices[index], (0, 0), 3)
        outwards = -np.stack([np.gradient(smooth, axis=1), np.gradient(smooth, axis=0)], axis=-1)
        return outwards / np.maximum(np.linalg.norm(outwards, axis=-1, keepdims=True), 1e-4)


def cells_of(points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """(…, 2) column and row, in cells, of points (…, 2) relative to the middle of a slice, metres."""
    return points / SETTINGS.cell_m + (np.array(cells.shape[1::-1]) - 1) / 2


def look_up(values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Values at (h, w, 2) columns and rows, between pixels by interpolation; 0 outside."""
    at = at.astype(np.float32)
    return cv2.remap(values, at[..., 0], at[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT)


def prism_of(item: Cutout, camera: Camera, slices: int) -> Prism:
    """The prism of an object whose mask is not empty."""
    slices = int(np.clip(slices, SETTINGS.min_slices, SETTINGS.max_slices))
    heights = np.linspace(item.box[0, 2], item.box[1, 2], slices)
    half = (item.box[1, :2] - item.box[0, :2]) / 2
    brim = SETTINGS.brim_m
    points = _cells(half + brim)
    within = np.clip(((half + brim - np.abs(points)) / brim).min(axis=-1), 0, 1).astype(np.float32)
    mask = item.mask.astype(np.float32)
    seen = [_lifted(mask, camera, item.centre + points, z) * within for z in heights]
    about = _middle(seen)
    stack = np.stack([np.minimum(cells, _opposite(cells, about)) for cells in seen])
    axis = (about - (np.array(stack.shape[:0:-1]) - 1) / 2) * SETTINGS.cell_m
    prism = Prism(item.centre, heights, stack, axis)
    left = np.clip(mask - _covered(prism, camera, mask), 0, 1)
    left = cv2.morphologyEx(left, cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))
    if left.sum() > SETTINGS.lopsided_share * mask.sum():
        return Prism(item.centre, heights, np.stack(seen), axis)
    left = np.minimum(cv2.dilate(left, np.ones((5, 5), np.uint8)), mask)
    middle = slices // 2
    stack[middle] = np.maximum(stack[middle], _lifted(left, camera, item.centre + points, heights[middle]))
    return prism


def _cells(half: np.ndarray) -> np.ndarray:
    """(rows, columns, 2) middles of the cells of a slice, relative to its own middle."""
    count = np.ceil(half / SETTINGS.cell_m).astype(int)
    axes = [np.arange(-n, n + 1) * SETTINGS.cell_m for n in count]
    return np.stack(np.meshgrid(*axes, indexing="xy"), axis=-1)


def _lifted(mask: np.ndarray, camera: Camera, points: np.ndarray, height: float) -> np.ndarray:
    """(rows, columns) the mask as seen at world points (rows, columns, 2) of a height."""
    lift = np.full((*points.shape[:-1], 1), height)
    return look_up(mask, camera.project(np.concatenate([points, lift], axis=-1)) - 0.5)


def _middle(seen: Sequence[np.ndarray]) -> np.ndarray:
    """(2,) column and row of the point that most cells have a cell opposite to: the box's, unless another is better.

    It is the peak of the self-convolution of the slices; a mug's is in its middle, though its handle sticks out.
    """
    rows, columns = (2 * length - 1 for length in seen[0].shape)
    size = next_fast_len(rows, real=True), next_fast_len(columns, real=True)
    total = irfft2((rfft2(np.stack(seen), size) ** 2).sum(axis=0), size)[:rows, :columns]
    middle = np.array(total.shape) // 2
    peak = np.array(np.unravel_index(int(np.argmax(total)), total.shape))
    better = total[tuple(peak)] > SETTINGS.symmetry_gain * total[tuple(middle)]
    return (peak if better else middle)[::-1] / 2


def _opposite(cells: np.ndarray, about: np.ndarray) -> np.ndarray:
    """The cells turned by half about a point (column, row)."""
    turn = np.array([[-1, 0, 2 * about[0]], [0, -1, 2 * about[1]]])
    return cv2.warpAffine(cells, turn, cells.shape[::-1], flags=cv2.INTER_LINEAR)


def _covered(prism: Prism, camera: Camera, mask: np.ndarray) -> np.ndarray:
    """(H, W) pixels of the mask, and around it, that the prism covers in its own picture."""
    covered = np.zeros(mask.shape, np.float32)
    u, v, width, height = cv2.boundingRect((mask > 0).astype(np.uint8))
    rows, columns = np.mgrid[v : v + height, u : u + width]
    pixels = np.stack([columns, rows], axis=-1) + 0.5
    window = covered[v : v + height, u : u + width]
    for index, z in enumerate(prism.heights):
        np.maximum(window, prism.sample(index, camera.unproject(pixels, z)[..., :2] - prism.origin), out=window)
    return covered
