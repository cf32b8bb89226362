"""Search for a known object in a whole picture: exhaustive template matching, then refinement of the best poses.

Template matching compares all positions and headings at once, in a small picture. Three costs count: the squared
colour distance inside the turned mask, table inside it, and other things around it. All are linear in (Lab, |Lab|²,
salience) of the patch around a position, so one matrix product compares every position with every heading. The best
are refined by the pose score (:mod:`vcage.vision.pose_score`).
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from vcage.base.geometry import wrap_angle
from vcage.vision.colour import LabImage
from vcage.vision.object_templates import ObjectTemplate
from vcage.vision.pose_score import LIGHTNESS, Fit, fit, from_pixels, refine, rotation

ROUGH_STEPS, FINE_STEPS = np.array([3.0, 3.0, 0.12, 0.03]), np.array([1.0, 1.0, 0.05, 0.015])
"""First steps of the refinement along x, y (pixels of the compared size), angle (radians) and log scale."""

FLIPS = np.array([np.pi / 2, np.pi, -np.pi / 2])
"""Turns of the best pose that are tried as well: objects are most alike to themselves half and quarter turned."""


@dataclass(frozen=True)
class SearchSettings:
    """Extent and resolution of the search.

    Args:
        places, headings: proposed places of an object, and headings at each.
        rough_poses, fine_poses: number of roughly refined poses, and of the finely refined ones among them.
        rough_rounds, fine_rounds: of the refinement.
        same_place_share, same_heading_rad: poses nearer to each other, in square roots of the object's area and in
            radians, count as the same.
        extent_px, long_extent_px: longest side of a compact and of a very long object in the small picture.
        angles, long_angles: headings around the circle; the ends of a long object move faster.
        margin_px: by which the compared patches are wider than the object.
        chunk: positions compared together; their windows stay in the processor's cache.
        colour_scale: colour distance that costs as much as an inside full of table, Lab units.
        ring_share: weight of the surroundings of the object; neighbours may touch it.
        apart_share: least distance between two places, in square roots of the object's area.
        least_salience: places that stand out of the table by less are not tried.
    """

    places: int = 14
    headings: int = 3
    rough_poses: int = 8
    fine_poses: int = 4
    rough_rounds: int = 5
    fine_rounds: int = 7
    same_place_share: float = 0.15
    same_heading_rad: float = 0.25
    extent_px: float = 14.0
    long_extent_px: float = 26.0
    angles: int = 24
    long_angles: int = 40
    margin_px: int = 5
    chunk: int = 1024
    colour_scale: float = 20.0
    ring_share: float = 0.6
    apart_share: float = 0.6
    least_salience: float = 0.25


SETTINGS = SearchSettings()


def search(image: LabImage, template: ObjectTemplate, also: np.ndarray) -> Fit:
    """The poses of :func:`search_finely` among those of :func:`search_roughly`."""
    return search_finely(image, template, search_roughly(image, template, also))


def search_roughly(target: LabImage, template: ObjectTemplate, also: np.ndarray) -> Fit:
    """Poses at which the object may be in a picture, the best first.

    Args:
        target: the picture.
        template: the object.
        also: (n, 2) pixels where something was detected; tried as well.
    """
    first = fit(target, template, _proposed(target, template, also)).best_first()
    starts = first.poses[: SETTINGS.rough_poses]
    return refine(target, template, starts, _steps(template, ROUGH_STEPS), SETTINGS.rough_rounds).best_first()


def search_finely(target: LabImage, template: ObjectTemplate, found: Fit) -> Fit:
    """The best of the poses that were found roughly, and turns of the very best, refined, the best first."""
    if not len(found.poses):
        return found
    again = fit(target, template, found.poses).best_first()
    apart = _distinct(again, template)[: SETTINGS.fine_poses]
    flipped = np.repeat(again.poses[:1], len(FLIPS), axis=0)
    flipped[:, 2] += FLIPS
    starts = np.concatenate([again.poses[apart], flipped])
    return refine(target, template, starts, _steps(template, FINE_STEPS), SETTINGS.fine_rounds).best_first()


def _steps(template: ObjectTemplate, steps: np.ndarray) -> np.ndarray:
    return steps * [template.step * template.pixel, template.step * template.pixel, 1, 1]


def _distinct(found: Fit, template: ObjectTemplate) -> list[int]:
    """Indices of poses that do not count as the same as a better one."""
    chosen: list[int] = []
    near = SETTINGS.same_place_share * np.sqrt(template.area) * template.pixel
    for k, pose in enumerate(found.poses):
        away = found.poses[chosen] - pose
        turned = np.abs(wrap_angle(away[:, 2]))
        if not np.any((np.hypot(away[:, 0], away[:, 1]) < near) & (turned < SETTINGS.same_heading_rad)):
            chosen.append(k)
    return chosen


def _proposed(image: LabImage, template: ObjectTemplate, also: np.ndarray) -> np.ndarray:
    """(k, 4) poses to refine: the best headings at each of the best places, and at pixels ``also`` (n, 2)."""
    s = SETTINGS
    # Few sizes, so that objects share the smaller pictures.
    long = template.extent * template.extent > 2.5 * template.area
    wanted = float(np.clip(s.extent_px * np.sqrt(template.extent**2 / template.area), s.extent_px, s.long_extent_px))
    step = 2 ** (np.ceil(2 * np.log2(max(template.extent / wanted, 1.0))) / 2)
    turns = s.long_angles if long else s.angles
    angles = np.arange(turns) * 2 * np.pi / turns
    side = 2 * int(np.ceil((template.extent / step + s.margin_px) / 2)) + 1
    weights, constant = _templates(template, step, side, angles)
    level = image.level(step)
    size = np.array([level.shape[1], level.shape[0]]) / [image.lab.shape[1], image.lab.shape[0]]
    places = _places(level, template.area / step**2, np.floor(also * size).astype(int))
    if not len(places):
        return np.zeros((0, 4))
    misfit = _misfits(_features(level), places, weights, side) + constant
    found = _apart(places, misfit.min(axis=1), max(1.5, s.apart_share * np.sqrt(template.area) / step))
    poses = []
    for k in found:
        by_angle = misfit[k]
        peaks = (by_angle <= np.roll(by_angle, 1)) & (by_angle <= np.roll(by_angle, -1))
        order = np.argsort(np.where(peaks, by_angle, np.inf), kind="stable")[: min(s.headings, int(peaks.sum()))]
        poses += [(*((places[k] + 0.5) / size), angles[a], 0.0) for a in order]
    return from_pixels(template, np.array(poses))


def _features(level: np.ndarray) -> np.ndarray:
    """(h, w, 5) weighted Lab, its square, salience."""
    lab = level[..., :3] * np.array([LIGHTNESS, 1, 1], np.float32)
    return np.dstack([lab, (lab * lab).sum(axis=-1), level[..., 3]])


def _templates(template: ObjectTemplate, step: float, side: int, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(5 side², headings) weights and (headings,) constants of the misfit."""
    level = np.dstack([template.source.level(step)[..., :3], _shrunk(template.mask, template.source.level(step).shape)])
    size = np.array([level.shape[1], level.shape[0]]) / [template.mask.shape[1], template.mask.shape[0]]
    centre = template.centre * size - 0.5
    columns, constants = [], []
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (5, 5))
    for angle in angles:
        turn = rotation(angle)
        shift = (side - 1) / 2 - turn @ centre
        turned = cv2.warpAffine(level, np.column_stack([turn, shift]), (side, side), flags=cv2.INTER_LINEAR)
        mask = turned[..., 3]
        lab = turned[..., :3] * np.array([LIGHTNESS, 1, 1], np.float32)
        ring = np.clip(cv2.dilate(mask, kernel) - mask, 0, 1)
        inside, around = mask / max(mask.sum(), 1e-6), ring / max(ring.sum(), 1e-6)
        colours = inside[..., None] / SETTINGS.colour_scale**2
        weights = np.dstack([-2 * colours * lab, colours, (SETTINGS.ring_share * around - inside)[..., None]])
        columns.append(weights.reshape(-1))
        constants.append(1 + (colours * lab * lab).sum())
    return np.stack(columns, axis=1).astype(np.float32), np.array(constants, np.float32)


def _shrunk(mask: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    return cv2.resize(mask.astype(np.float32), (shape[1], shape[0]), interpolation=cv2.INTER_AREA)


def _places(level: np.ndarray, area: float, also: np.ndarray) -> np.ndarray:
    """(n, 2) pixels (u, v) of the small picture that stand out enough for an object of that area."""
    around = cv2.GaussianBlur(level[..., 3], (0, 0), max(0.6, 0.25 * np.sqrt(area)))
    v, u = np.nonzero(around > SETTINGS.least_salience)
    inside = also[np.all((also >= 0) & (also < [level.shape[1], level.shape[0]]), axis=1)]
    return np.concatenate([np.stack([u, v], axis=1), inside]).astype(int)


def _misfits(features: np.ndarray, places: np.ndarray, weights: np.ndarray, side: int) -> np.ndarray:
    """(places, headings) linear part of the misfit."""
    half = side // 2
    padded = cv2.copyMakeBorder(features[..., :4], half, half, half, half, cv2.BORDER_REPLICATE)
    outside = cv2.copyMakeBorder(features[..., 4], half, half, half, half, cv2.BORDER_CONSTANT)
    # Channels first, in the weights as well: rows of a window lie together and are copied faster.
    padded = np.stack([*cv2.split(padded), outside])
    # pyrefly: ignore[no-matching-overload]  numpy's stub knows no tuple of axes
    windows = np.lib.stride_tricks.sliding_window_view(padded, (side, side), axis=(1, 2))  # (5, h, w, side, side)
    windows = windows.transpose(1, 2, 0, 3, 4)
    weights = weights.reshape(side, side, 5, -1).transpose(2, 0, 1, 3).reshape(side * side * 5, -1)
    weights = np.ascontiguousarray(weights)
    found = [
        windows[chunk[:, 1], chunk[:, 0]].reshape(len(chunk), -1) @ weights
        for chunk in np.array_split(places, max(1, int(np.ceil(len(places) / SETTINGS.chunk))))
    ]
    return np.concatenate(found)


def _apart(places: np.ndarray, misfit: np.ndarray, distance: float) -> list[int]:
    """Indices of the best places no nearer to each other than ``distance``.

    Only places better than their neighbours are chosen; otherwise the inside of one large object takes them all.
    """
    size = places.max(axis=0) + 1
    surface = np.full(size[::-1], np.inf, np.float32)
    surface[places[:, 1], places[:, 0]] = misfit
    around = cv2.erode(surface, np.ones((3, 3), np.uint8))
    left = np.where(misfit <= around[places[:, 1], places[:, 0]], misfit, np.inf).astype(np.float64)
    chosen: list[int] = []
    while len(chosen) < SETTINGS.places:
        k = int(np.argmin(left))
        if not np.isfinite(left[k]):
            break
        chosen.append(k)
        left[np.hypot(*(places - places[k]).T) <= distance] = np.inf
    return chosen
