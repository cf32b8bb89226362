from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vcage.geometry import wrap_angle
from vcage.igsc.match import greedy_pairs, match_objects, name_similarity, resize_to, with_mask
from vcage.models.protocols import Detection


@pytest.fixture(scope="module")
def matched(things, moved, paint, make_scene, detect, background, embedder):
    """The matches of a rearranged picture."""
    source, segmentation = paint(things)
    target, found = paint(moved)
    scene = make_scene(things)
    return match_objects(scene, source, segmentation, target, background, detect(found), embedder, threshold=0.7)


def test_every_object_is_matched_by_its_features(matched, things):
    matches, unclaimed = matched
    assert [m.object for m in matches] == [t.id for t in things]
    assert {m.method for m in matches} == {"feature"}
    assert unclaimed == []


def test_positions_are_recovered_within_three_millimetres(matched, moved):
    for match, thing in zip(matched[0], moved, strict=True):
        assert np.hypot(*np.subtract(match.position, thing.xy)) < 0.003, match


def test_headings_are_recovered_within_three_degrees(matched, moved):
    for match, thing in zip(matched[0], moved, strict=True):
        assert abs(wrap_angle(match.yaw - thing.yaw)) < np.deg2rad(3), match


def test_a_missing_object_is_kept_where_it_was_and_says_so(
    things, moved, paint, make_scene, detect, background, embedder
):
    source, segmentation = paint(things)
    target, found = paint([moved[0], moved[1], moved[3]])
    matches, _ = match_objects(
        make_scene(things), source, segmentation, target, background, detect(found), embedder, threshold=0.9
    )
    kept = matches[2]
    assert (kept.method, kept.box, kept.confidence) == ("kept", None, 0.0)
    assert kept.position == pytest.approx(things[2].xy)
    assert "not found" in kept.note


def test_an_object_hidden_in_the_source_is_kept(things, moved, paint, make_scene, detect, background, embedder):
    source, segmentation = paint(things)
    target, found = paint(moved)
    segmentation = np.where(segmentation == 2, 0, segmentation)
    matches, unclaimed = match_objects(
        make_scene(things), source, segmentation, target, background, detect(found), embedder, threshold=0.7
    )
    assert matches[1].method == "kept"
    assert "hidden" in matches[1].note
    assert len(unclaimed) == 1


def test_a_recoloured_object_is_found_by_its_name(things, moved, paint, make_scene, detect, background, embedder):
    source, segmentation = paint(things)
    painted = [*moved[:2], replace(moved[2], colour=(190, 160, 60)), moved[3]]
    target, found = paint(painted)
    labels = {4: "whiteboard eraser", 3: "marker pen red", 2: "black marker pen", 1: "packaging box"}
    detections = [replace(d, label=labels[4 - k]) for k, d in enumerate(detect(found))]
    matches, _ = match_objects(
        make_scene(things), source, segmentation, target, background, detections, embedder, threshold=0.97
    )
    assert matches[2].method == "name"
    assert np.hypot(*np.subtract(matches[2].position, moved[2].xy)) < 0.003


def test_no_detections_leave_everything_kept(things, paint, make_scene, background, embedder):
    source, segmentation = paint(things)
    matches, unclaimed = match_objects(
        make_scene(things), source, segmentation, source, background, [], embedder, threshold=0.7
    )
    assert {m.method for m in matches} == {"kept"}
    assert unclaimed == []


def test_detections_without_masks_get_them_from_the_empty_table(
    things, moved, paint, make_scene, detect, background, embedder
):
    source, segmentation = paint(things)
    target, found = paint(moved)
    boxes = [replace(d, mask=None) for d in detect(found)]
    matches, _ = match_objects(
        make_scene(things), source, segmentation, target, background, boxes, embedder, threshold=0.7
    )
    for match, thing in zip(matches, moved, strict=True):
        assert np.hypot(*np.subtract(match.position, thing.xy)) < 0.005, match


def test_pictures_of_another_size_are_refused(things, paint, make_scene, background, embedder):
    source, segmentation = paint(things)
    with pytest.raises(ValueError, match="sizes differ"):
        match_objects(make_scene(things), source, segmentation, source[:100], background, [], embedder, threshold=0.7)


def test_resizing_brings_a_picture_to_the_size_asked_for(background):
    assert resize_to(background, (240, 320)).shape == (240, 320, 3)
    assert resize_to(background, background.shape[:2]) is background


def test_greedy_pairs_take_the_best_first_and_nothing_twice():
    similarity = np.array([[0.9, 0.8], [0.95, 0.1]])
    assert greedy_pairs(similarity, 0.5) == {1: (0, 0.95), 0: (1, 0.8)}


def test_greedy_pairs_leave_out_what_does_not_exceed_the_threshold():
    assert greedy_pairs(np.array([[0.5]]), 0.5) == {}


@pytest.mark.parametrize(
    ("a", "b", "low", "high"),
    [
        ("black marker pen", "Black marker  pen", 1.0, 1.0),
        ("eraser", "whiteboard eraser", 0.6, 0.9),
        ("plate", "stapler", 0.0, 0.7),
        ("", "mug", 0.0, 0.0),
    ],
)
def test_name_similarity_is_between_nothing_and_the_same(a, b, low, high):
    assert low <= name_similarity(a, b) <= high


def test_a_box_that_leaves_the_picture_still_gets_a_mask(background):
    mask = with_mask(Detection((-20, -20, 15, 15), None, 1.0), background, background).mask
    assert mask[:15, :15].all() and mask.sum() == 225
