"""Finds an object in a picture from its reference: colours and outline, over positions and headings.

Colours alone fail for a cardboard box on a wooden table, an outline alone among many edges: both count.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from vcage.base.geometry import Camera
from vcage.vision.colour import LIGHTNESS_WEIGHT, distance, to_lab
from vcage.vision.protocols import Reference

HEADINGS = 24
"""Headings that are tried around the circle; twice as many for long objects, whose ends move faster."""

FINE_HEADINGS = np.radians([-8.0, -4.0, 0.0, 4.0, 8.0])
"""Headings around a proposed one that the refinement tries."""

FINEST_HEADINGS = np.radians([-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0])
"""Headings around the best of those that the last pass tries."""

FINALISTS = 4
"""Places that reach the last pass."""

PROPOSALS = 8
"""Places that template matching at half size proposes."""

CAP = 25.0
"""Largest colour distance that one pixel can cost."""

COLOUR_SHARE = 0.6
"""Share of the colours in the misfit; the rest is the outline's."""

STRONG_EDGE = 3.0
"""Change of lightness per pixel of an edge that counts fully."""

_ANGLES = np.arange(8) * np.pi / 8

MAX_PIXELS = 1500
"""Pixels of a template that the refinement compares."""

GOOD_FIT = 0.35
"""A place with less misfit, where something is known to stand, makes a search of the whole picture needless."""

_MARGIN = 4
"""Width of the rim of table colour around a template, pixels."""


@dataclass(frozen=True)
class Sighting:
    """One place where an object may be.

    Args:
        centre: (2,) pixel of the middle of the template.
        heading: radians.
        misfit: of colours (mean capped distance to the template) and outline (how little of it lies on edges of the
            picture); 0 is perfect, 1 useless.
        mask: (H, W) bool, the object's outline there.
    """

    centre: np.ndarray
    heading: float
    misfit: float
    mask: np.ndarray


@dataclass(frozen=True)
class Template:
    """An object at one heading.

    Args:
        lab: (h, w, 3) colours, over the table's colour.
        weight: (h, w) how much each pixel counts.
        outline: (h, w) bool, the object's pixels.
        rim: (n, 2) pixels (u, v) along the edge of the outline.
        normals: (n, 2) directions across that edge.
    """

    heading: float
    lab: np.ndarray
    weight: np.ndarray
    outline: np.ndarray
    rim: np.ndarray
    normals: np.ndarray


def pixels_per_metre(camera: Camera, table_height: float) -> float:
    """Scale of the picture at the middle of the view on the table plane."""
    middle = camera.unproject(np.array([camera.width / 2, camera.height / 2]), table_height)
    step = camera.project(np.stack([middle + [0.005, 0, 0], middle - [0.005, 0, 0]]))
    return float(np.linalg.norm(step[0] - step[1]) / 0.01)


def templates(
    reference: Reference, scale: float, table_lab: np.ndarray, headings: np.ndarray, rim_only: bool = False
) -> list[Template]:
    """The reference at each heading, in a picture of ``scale`` pixels per metre.

    Args:
        table_lab: (3,) colour of the table around the object.
        rim_only: weigh only the outer part: what lies in a receptacle hides its middle.
    """
    zoom = scale * reference.metres_per_pixel
    height, width = reference.picture.shape[:2]
    side = int(np.ceil(np.hypot(*reference.size[:2]) * scale * 1.25)) + 2 * _MARGIN + 3
    lab = to_lab(_over(reference.picture, table_lab))
    alpha = (reference.picture[..., 3] > 127).astype(np.float32)
    made = []
    for heading in headings:
        turn = cv2.getRotationMatrix2D((width / 2 - 0.5, height / 2 - 0.5), float(np.degrees(heading)), zoom)
        turn[:, 2] += side / 2 - np.array([width, height]) / 2
        border = tuple(float(x) for x in table_lab)
        turned = cv2.warpAffine(lab, turn, (side, side), flags=cv2.INTER_AREA, borderValue=border)
        outline = cv2.warpAffine(alpha, turn, (side, side)) > 0.5
        made.append(Template(float(heading), turned, _weights(outline, rim_only), outline, *_rim(outline)))
    return made


def _rim(outline: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Edge pixels of an outline, and the directions across the edge there."""
    soft = cv2.GaussianBlur(outline.astype(np.float32), (0, 0), 1.5)
    edge = outline & ~cv2.erode(outline.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool)
    rows, columns = np.nonzero(edge)
    across = np.stack([cv2.Sobel(soft, cv2.CV_32F, 1, 0), cv2.Sobel(soft, cv2.CV_32F, 0, 1)], axis=-1)[rows, columns]
    return np.stack([columns, rows], axis=1), across / (np.linalg.norm(across, axis=1, keepdims=True) + 1e-9)


def gradients(lab: np.ndarray) -> np.ndarray:
    """(H, W, 2) change of lightness per pixel along u and v."""
    light = cv2.GaussianBlur(lab[..., 0], (0, 0), 1.0)
    return np.stack([cv2.Sobel(light, cv2.CV_32F, 1, 0), cv2.Sobel(light, cv2.CV_32F, 0, 1)], axis=-1) / 8


def _over(rgba: np.ndarray, table_lab: np.ndarray) -> np.ndarray:
    """The reference over the table's colour."""
    table = cv2.cvtColor(table_lab.astype(np.float32).reshape(1, 1, 3), cv2.COLOR_LAB2RGB)[0, 0] * 255
    alpha = rgba[..., 3:].astype(np.float32) / 255
    return np.clip(rgba[..., :3] * alpha + table * (1 - alpha), 0, 255).astype(np.uint8)


def _weights(outline: np.ndarray, rim_only: bool) -> np.ndarray:
    """1 on the object, ½ on the rim of table around it; the object's middle left out when asked."""
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * _MARGIN + 1, 2 * _MARGIN + 1))
    around = cv2.dilate(outline.astype(np.uint8), kernel).astype(bool)
    weight = np.where(outline, 1.0, np.where(around, 0.5, 0.0)).astype(np.float32)
    if rim_only:
        depth = cv2.distanceTransform(outline.astype(np.uint8), cv2.DIST_L2, 5)
        weight[depth > 0.35 * depth.max()] = 0
    return weight


def search(
    lab: np.ndarray,
    reference: Reference,
    scale: float,
    table_lab: np.ndarray,
    *,
    rim_only: bool = False,
    count: int = 1,
    around: Sequence[np.ndarray] = (),
) -> list[Sighting]:
    """The ``count`` best places of the reference in a Lab picture, the best first, none on top of another.

    Where something is known to stand is looked at first; when nothing there fits well, template matching at half
    size over all headings proposes places. Each is then refined at full size with a cost that is capped for every
    pixel, so that what covers a part of the object costs no more than that part.

    Args:
        rim_only: compare only the outer part (see :func:`templates`).
        around: (2,) pixels where something is known to stand.
    """
    long = max(reference.size[:2]) > 2.5 * min(reference.size[:2])
    headings = np.linspace(0, 2 * np.pi, HEADINGS * (2 if long else 1), endpoint=False)
    made = templates(reference, scale, table_lab, headings, rim_only) if len(around) else []
    standing = [refine(lab, made, centre, reach=6, step=3) for centre in around]
    found = [(s.centre, s.heading) for s in standing]
    if min((s.misfit for s in standing), default=1.0) > GOOD_FIT:
        half = cv2.resize(lab, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
        coarse = templates(reference, scale / 2, table_lab, headings, rim_only)
        found += [(2 * centre, heading) for centre, heading in _proposals(half, coarse, max(PROPOSALS, count))]
    for steps, kept in ((FINE_HEADINGS, FINALISTS), (FINEST_HEADINGS, count)):
        refined = [
            refine(lab, templates(reference, scale, table_lab, heading + steps, rim_only), centre)
            for centre, heading in found
        ]
        refined = sorted(refined, key=lambda s: s.misfit)[: max(kept, count)]
        found = [(s.centre, s.heading) for s in refined]
    return refined


def _proposals(lab: np.ndarray, made: list[Template], count: int) -> list[tuple[np.ndarray, float]]:
    """(pixel, heading) of the best matches, the best first."""
    scales = np.array([LIGHTNESS_WEIGHT, 1, 1], dtype=np.float32)
    picture, edges = lab * scales, gradients(lab)
    responses = [_response(edges, angle) for angle in _ANGLES]
    stack = np.stack([_colour_cost(picture, t, scales) / 2 + _outline_cost(responses, t) for t in made])
    best, which = stack.min(axis=0), stack.argmin(axis=0)
    side = made[0].outline.shape[0]
    reach = max(3, int(0.4 * np.sqrt(made[0].outline.sum())))
    found = []
    for _ in range(count):
        row, column = (int(n) for n in np.unravel_index(np.argmin(best), best.shape))
        if not np.isfinite(best[row, column]):
            break
        found.append((np.array([column, row]) + side / 2, made[which[row, column]].heading))
        best[max(0, row - reach) : row + reach + 1, max(0, column - reach) : column + reach + 1] = np.inf
    return found


def _colour_cost(picture: np.ndarray, template: Template, scales: np.ndarray) -> np.ndarray:
    """Root mean square distance of the template at each position inside the picture, as a share of the cap."""
    weight = np.repeat(np.sqrt(template.weight)[..., None], 3, axis=2)
    squares = cv2.matchTemplate(
        picture, np.multiply(template.lab, scales, dtype=np.float32), cv2.TM_SQDIFF, mask=weight
    )
    return np.minimum(np.sqrt(np.maximum(squares, 0) / template.weight.sum()) / CAP, 1)


def _outline_cost(responses: list[np.ndarray], template: Template) -> np.ndarray:
    """Share of the template's outline that lies on no edge of its direction, at each position."""
    directions = np.arctan2(template.normals[:, 1], template.normals[:, 0])
    bins = np.rint(directions / np.pi * len(_ANGLES)).astype(int) % len(_ANGLES)
    hits = []
    for index in np.unique(bins):
        drawn = np.zeros(template.outline.shape, np.float32)
        drawn[template.rim[bins == index, 1], template.rim[bins == index, 0]] = 1
        hits.append(cv2.matchTemplate(responses[index], drawn, cv2.TM_CCORR))
    return 1 - np.sum(hits, axis=0) / len(bins)


def _response(edges: np.ndarray, angle: float) -> np.ndarray:
    """(H, W) strength of the edges across one direction, in [0, 1], widened to bear with coarse headings."""
    across = np.abs(edges @ np.array([np.cos(angle), np.sin(angle)], np.float32))
    return cv2.dilate(np.minimum(across / STRONG_EDGE, 1), np.ones((5, 5), np.uint8))


def refine(lab: np.ndarray, made: list[Template], centre: np.ndarray, reach: int = 2, step: int = 1) -> Sighting:
    """The best of the templates at whole-pixel shifts of up to ``reach`` around ``centre``; the nearest of equals."""
    shifts = np.arange(-reach, reach + 1, step)
    grid = np.stack(np.meshgrid(shifts, shifts, indexing="ij"), axis=-1).reshape(-1, 2)
    grid = grid[np.argsort(np.abs(grid).sum(axis=1), kind="stable")]
    best = (np.inf, made[0], centre)
    edges = gradients(lab)
    for template in made:
        corner = np.rint(centre - np.array(template.outline.shape[::-1]) / 2).astype(int)
        colour, outline = (
            cost(source, template, corner + grid) for cost, source in ((_capped, lab), (_off_edges, edges))
        )
        costs = COLOUR_SHARE * colour + (1 - COLOUR_SHARE) * outline
        k = int(np.argmin(costs))
        if costs[k] < best[0] - 1e-9:
            best = (float(costs[k]), template, corner + grid[k])
    return _sighting(best[1], best[2], best[0], lab.shape[:2])


def _capped(lab: np.ndarray, template: Template, corners: np.ndarray) -> np.ndarray:
    """(n,) mean capped colour distance, as a share of the cap, with the template's corner at each (u, v)."""
    rows, columns = np.nonzero(template.weight)
    thin = slice(None, None, max(1, len(rows) // MAX_PIXELS))
    rows, columns = rows[thin], columns[thin]
    weights, colours = template.weight[rows, columns], template.lab[rows, columns]
    height, width = lab.shape[:2]
    pixels, total = lab.reshape(-1, 3), CAP * weights.sum()
    costs = np.empty(len(corners))
    for k, (u, v) in enumerate(corners):
        r, c = rows + v, columns + u
        there = np.clip(r, 0, height - 1) * width + np.clip(c, 0, width - 1)
        away = np.minimum(distance(pixels.take(there, axis=0), colours), CAP)
        away[(r < 0) | (r >= height) | (c < 0) | (c >= width)] = CAP
        costs[k] = float((away * weights).sum() / total)
    return costs


def _off_edges(edges: np.ndarray, template: Template, corners: np.ndarray) -> np.ndarray:
    """(n,) share of the template's outline that lies on no edge of its direction."""
    points = template.rim[None] + corners[:, None]
    limits = np.array([edges.shape[1], edges.shape[0]])
    seen = np.all((points >= 0) & (points < limits), axis=-1)
    points = np.clip(points, 0, limits - 1)
    across = np.abs((edges[points[..., 1], points[..., 0]] * template.normals[None]).sum(axis=-1))
    return 1 - np.where(seen, np.minimum(across / STRONG_EDGE, 1), 0).mean(axis=1)


def _sighting(template: Template, corner: np.ndarray, misfit: float, shape: tuple[int, ...]) -> Sighting:
    height, width = template.outline.shape
    u, v = (int(x) for x in corner)
    mask = np.zeros(shape, bool)
    low, high = (max(v, 0), max(u, 0)), (min(v + height, shape[0]), min(u + width, shape[1]))
    mask[low[0] : high[0], low[1] : high[1]] = template.outline[low[0] - v : high[0] - v, low[1] - u : high[1] - u]
    return Sighting(np.array([u + width / 2, v + height / 2]), template.heading, misfit, mask)
