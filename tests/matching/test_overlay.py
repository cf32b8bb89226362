from __future__ import annotations

import numpy as np

from tests.painted_world import Thing
from vcage.base.drawing import WARNING, Canvas, palette
from vcage.layout.picture import Footprint, collisions, draw_layout
from vcage.matching.overlay import draw_overlay
from vcage.schema.matches import Match
from vcage.schema.scene import Table, Workspace

WORKSPACE = Workspace(lower=(-0.5, -0.3), upper=(0.5, 0.3))


def has_colour(picture: np.ndarray, colour: tuple[int, int, int]) -> bool:
    return bool(np.any(np.all(picture == colour, axis=2)))


def test_the_palette_has_different_colours():
    assert len(set(palette(24))) == 24


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


def test_the_overlay_is_enlarged_and_marks_what_nobody_claimed(things, moved, background, make_scene):
    scene = make_scene(things)
    matches = [match_of(*pair) for pair in zip(things, moved, strict=True)]
    plain = draw_overlay(background, scene, matches)
    marked = draw_overlay(background, scene, matches, unclaimed=[(10, 10, 60, 60)])
    assert plain.shape == (960, 1280, 3)
    assert not has_colour(plain, WARNING)
    assert has_colour(marked, WARNING)


def test_a_kept_object_is_marked(things, moved, paint, make_scene):
    matches = [match_of(*pair) for pair in zip(things, moved, strict=True)]
    lost = {"method": "kept", "similarity": None, "confidence": 0.0, "box": None, "ncc": None}
    matches[1] = match_of(things[1], things[1], **lost, note="not found in the target picture; kept where it was")
    assert has_colour(draw_overlay(paint(moved)[0], make_scene(things), matches), WARNING)


def pair(apart: float) -> list[Footprint]:
    return [
        Footprint("a", "black marker pen", (-apart, 0.0), (0.1, 0.02), 0.5),
        Footprint("b", "box", (apart, 0.0), (0.1, 0.1), 0.0),
    ]


def test_collisions_of_container_and_content_do_not_count():
    assert len(collisions(pair(0.01))) == 1
    inside = [Footprint("a", "pen", (0, 0), (0.1, 0.02), 0.0, container="b"), pair(0.0)[1]]
    assert collisions(inside) == []


def test_the_layout_picture_shows_both_plans_side_by_side():
    picture = draw_layout(pair(0.01), pair(0.1), WORKSPACE, Table())
    assert picture.dtype == np.uint8
    assert picture.shape[1] > 2.5 * picture.shape[0]
    assert has_colour(picture[:, : picture.shape[1] // 2], WARNING)
    assert not has_colour(picture[:, picture.shape[1] // 2 :], WARNING)


def test_the_same_layout_gives_the_same_picture():
    first, second = (draw_layout(pair(0.01), pair(0.1), WORKSPACE, Table()) for _ in range(2))
    assert (first == second).all()


def test_contents_of_a_turned_container_collide_along_its_walls_only():
    tray = Footprint("tray", "tray", (0.0, 0.0), (0.3, 0.3), 0.7)
    along = np.array([np.cos(0.7), np.sin(0.7)])
    near, far = (Footprint(n, n, tuple(s * 0.03 * along), (0.05, 0.2), 0.7, "tray") for n, s in (("a", -1), ("b", 1)))
    assert collisions([tray, near, far]) == []
    touching = Footprint("c", "c", tuple(0.01 * along), (0.05, 0.2), 0.7, "tray")
    assert len(collisions([tray, near, touching])) == 1
