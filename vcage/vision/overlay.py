"""The picture of a matching: the old and the new place of each object in the target, and the confidence."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from vcage.base.drawing import WARNING, Canvas, Colour, distinct_colours
from vcage.schema.matches import Match
from vcage.schema.scene import ObjectRecord, Scene

WIDTH_PX = 1280
"""Smaller pictures are enlarged to this width, so that the labels are readable."""

SURE_CONFIDENCE = 0.6
"""A match of less confidence is drawn with a dashed box and a question mark."""


def draw_overlay(
    picture: np.ndarray, scene: Scene, matches: Sequence[Match], unclaimed: Sequence[Sequence[float]] = ()
) -> np.ndarray:
    """The target picture with a labelled box per match and an arrow from each object's old place to its new one.

    Args:
        picture: (H, W, 3) uint8 target picture, in the size of the scene's camera.
        scene: the source scene.
        matches: see :func:`vcage.vision.match.match_picture`.
        unclaimed: boxes that no object claimed, drawn dashed.

    Returns:
        (H', W', 3) uint8, W' at least 1280.
    """
    scale = max(1.0, WIDTH_PX / picture.shape[1])
    size = (round(picture.shape[1] * scale), round(picture.shape[0] * scale))
    canvas = Canvas(cv2.resize(picture, size, interpolation=cv2.INTER_CUBIC), text_size=19)
    colours = dict(zip([o.id for o in scene.objects], distinct_colours(len(scene.objects)), strict=True))
    for box in unclaimed:
        _dashed(canvas, np.array(box) * scale, WARNING)
    drawn = [(match, _places(scene, match) * scale, colours[match.object]) for match in matches]
    labelled = [_label_box(match, places, scale).tolist() for match, places, _ in drawn]
    for match, places, colour in drawn:
        _draw_match(canvas, match, places, colour, scale)
    for _, (start, end), colour in drawn:
        canvas.arrow(start, end, colour)
    for box in labelled:
        canvas.keep_clear(box)
    for box in unclaimed:
        canvas.label((np.array(box) * scale).tolist(), "not claimed", WARNING)
    for (match, _, colour), box in zip(drawn, labelled, strict=True):
        canvas.label(box, _words(scene.object(match.object), match), colour)
    return canvas.picture()


def _places(scene: Scene, match: Match) -> np.ndarray:
    """(2, 2) pixels of the object's middle in the source and in the target."""
    record = scene.object(match.object)
    height = (record.aabb[0][2] + record.aabb[1][2]) / 2
    points = [(*record.pose.position[:2], height), (*match.position, height)]
    return scene.top_camera.camera().project(points)


def _draw_match(canvas: Canvas, match: Match, places: np.ndarray, colour: Colour, scale: float) -> None:
    if match.box is not None:
        sure = match.confidence >= SURE_CONFIDENCE
        outline = (*colour, 255) if sure else None
        canvas.draw.rectangle([x * scale for x in match.box], fill=(*colour, 28), outline=outline, width=3)
        if not sure:
            _dashed(canvas, np.array(match.box) * scale, colour)
    start, end = places
    canvas.draw.ellipse([*(start - 5), *(start + 5)], outline=(255, 255, 255), fill=colour, width=2)
    if match.box is None:
        for sign in (1, -1):
            arm = np.array([10, sign * 10])
            canvas.draw.line([*(end - arm), *(end + arm)], fill=WARNING, width=4)


def _label_box(match: Match, places: np.ndarray, scale: float) -> np.ndarray:
    if match.box is not None:
        return np.array(match.box) * scale
    return np.concatenate([places[1] - 12, places[1] + 12])


def _words(record: ObjectRecord, match: Match) -> str:
    if match.method == "kept":
        return f"{record.phrase}: kept ({match.note.partition(' in ')[0].partition(';')[0]})"
    how = " by name" if match.method == "name" else ""
    doubt = "?" if match.confidence < SURE_CONFIDENCE else ""
    return f"{record.phrase}{doubt} {match.confidence:.2f}{how}, {np.rad2deg(match.turned):+.0f}°"


def _dashed(canvas: Canvas, box: np.ndarray, colour: Colour, dash: int = 9) -> None:
    u0, v0, u1, v1 = box
    for start, end in (((u0, v0), (u1, v0)), ((u1, v0), (u1, v1)), ((u1, v1), (u0, v1)), ((u0, v1), (u0, v0))):
        start, end = np.array(start), np.array(end)
        for k in range(0, max(1, int(np.hypot(*(end - start)))), 2 * dash):
            along = (end - start) / max(1.0, np.hypot(*(end - start)))
            stop = min(k + dash, np.hypot(*(end - start)))
            canvas.draw.line([*(start + k * along), *(start + stop * along)], fill=colour, width=3)
