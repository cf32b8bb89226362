from __future__ import annotations

import numpy as np

from tests.painted_world import Thing
from vcage.base.drawing import WARNING, Canvas, distinct_colours
from vcage.schema.matches import Match
from vcage.vision.overlay import draw_overlay


def has_colour(picture: np.ndarray, colour: tuple[int, int, int]) -> bool:
    return bool(np.any(np.all(picture == colour, axis=2)))


def test_the_palette_has_different_colours():
    assert len(set(distinct_colours(24))) == 24


def test_labels_of_the_same_box_do_not_cover_each_other():
    canvas = Canvas(np.zeros((400, 400, 3), dtype=np.uint8), 16)
    for k in range(6):
        canvas.label((180, 180, 220, 220), f"label {k}", (10 * k, 90, 90))
    boxes = np.array(canvas._labels)
    overlaps = np.minimum(boxes[:, None, 2:], boxes[None, :, 2:]) - np.maximum(boxes[:, None, :2], boxes[None, :, :2])
    covered = np.all(overlaps > 0, axis=2) & ~np.eye(6, dtype=bool)
    assert not covered.any()


def match_of(thing: Thing, target: Thing, **fields: object) -> Match:
    found = {"method": "feature", "similarity": 0.9, "confidence": 0.9, "box": (300, 200, 380, 260), "ncc": 0.9}
    place = {"object": thing.id, "position": target.xy, "yaw": target.yaw, "turned": target.yaw - thing.yaw}
    return Match(**(found | place | fields))


def test_the_overlay_is_enlarged_and_marks_unclaimed_boxes(things, moved, background, make_scene):
    scene = make_scene(things)
    matches = [match_of(*pair) for pair in zip(things, moved, strict=True)]
    plain = draw_overlay(background, scene, matches)
    marked = draw_overlay(background, scene, matches, unclaimed=[(10, 10, 60, 60)])
    assert plain.shape == (960, 1280, 3)
    assert not has_colour(plain, WARNING)
    assert has_colour(marked, WARNING)


def test_an_object_that_was_not_found_is_marked(things, moved, paint, make_scene):
    matches = [match_of(*pair) for pair in zip(things, moved, strict=True)]
    lost = {"method": "kept", "similarity": None, "confidence": 0.0, "box": None, "ncc": None}
    matches[1] = match_of(things[1], things[1], **lost, note="not found in the target picture; kept where it was")
    assert has_colour(draw_overlay(paint(moved)[0], make_scene(things), matches), WARNING)
