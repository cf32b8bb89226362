from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from vcage.base.errors import UnknownName
from vcage.base.geometry import wrap_angle
from vcage.schema.plan import LayoutPlan, Relation
from vcage.vision.detector import BackgroundDetector
from vcage.vision.embedder import ClassicalEmbedder
from vcage.vision.match import Looks, Recogniser, match_picture, stored_matches
from vcage.vision.observation import ScenePictures
from vcage.vision.protocols import Detection


class Fixed:
    """A detector with given answers."""

    provider = "test"

    def __init__(self, detections=()):
        self.detections = list(detections)

    def detect(self, picture, names, background=None):
        return self.detections


@pytest.fixture(scope="module")
def table(things, paint, make_scene, background):
    """Matches a target picture with the scene of the things."""
    source, segmentation = paint(things)
    scene = make_scene(things)

    def match(target, plan=None, detector=None, segmentation=segmentation, threshold=0.5, symmetry=None):
        pictures = ScenePictures(source, segmentation, background)
        recogniser = Recogniser(detector or BackgroundDetector(), ClassicalEmbedder(), threshold)
        return match_picture(scene, plan, pictures, target, recogniser, Looks(symmetry or {}))

    return match


@pytest.fixture(scope="module")
def target(moved, paint):
    return paint(moved)[0]


def assert_found(result, moved, millimetres=6.0, degrees=4.0):
    for match, thing in zip(result.matches, moved, strict=True):
        assert match.method != "kept", match
        assert 1000 * np.hypot(*np.subtract(match.position, thing.xy)) < millimetres, match
        assert abs(wrap_angle(match.yaw - thing.yaw)) < np.deg2rad(degrees), match


def repainted(picture, paint, things):
    """The picture with the table's pixels replaced by blue stripes."""
    _, segmentation = paint(things)
    v = np.arange(picture.shape[0])[:, None, None]
    stripes = np.array([60, 90, 150]) + 8 * np.sin(v / 9.0) * np.ones((1, picture.shape[1], 1))
    return np.where(segmentation[..., None] > 0, picture, stripes).astype(np.uint8)


def test_every_object_is_found_where_it_went_and_how_it_was_turned(table, target, moved, things):
    result = table(target)
    assert [m.object for m in result.matches] == [t.id for t in things]
    assert_found(result, moved)
    assert result.unclaimed == []


@pytest.mark.slow
def test_a_repainted_table_hides_nothing(table, target, moved, paint):
    assert_found(table(repainted(target, paint, moved)), moved)


@pytest.mark.slow
def test_another_light_and_colour_cast_change_nothing(table, target, moved):
    changed = np.clip(target * np.array([1.08, 0.95, 0.85]) + 8, 0, 255).astype(np.uint8)
    assert_found(table(changed), moved)


@pytest.mark.slow
def test_blur_and_another_size_change_nothing(table, target, moved):
    soft = cv2.GaussianBlur(target, (0, 0), 1.2)
    result = table(cv2.resize(soft, (800, 600), interpolation=cv2.INTER_CUBIC))
    assert result.picture.shape == target.shape
    assert_found(result, moved)


@pytest.mark.slow
def test_touching_objects_are_distinguished(table, moved, paint):
    touching = [*moved[:3], replace(moved[3], xy=(0.05 - 0.03, 0.08 - 0.125), yaw=0.35)]
    assert_found(table(paint(touching)[0]), touching)


def test_objects_are_found_without_any_detection(table, target, moved):
    assert_found(table(target, detector=Fixed()), moved)


@pytest.mark.slow
def test_a_thousand_detections_are_cut_to_the_surest_and_noted(table, target, moved):
    rng = np.random.default_rng(1)
    corners = rng.uniform(0, 400, (1000, 2))
    many = [Detection((u, v, u + 20, v + 20), None, 0.5) for u, v in corners]
    result = table(target, detector=Fixed(many))
    assert_found(result, moved)
    assert any("1000 things" in note for note in result.notes)


def test_invalid_detections_are_left_out_and_noted(table, target, moved):
    box = (300.0, 200.0, 340.0, 240.0)
    odd = [
        Detection((np.nan, 0.0, 20.0, 20.0), None, 0.9),
        Detection((0.0, 0.0, np.inf, 20.0), None, 0.9),
        Detection(box, None, np.nan),
        Detection(box, np.ones((4, 4), bool), 0.9),
    ]
    result = table(target, detector=Fixed(odd))
    assert_found(result, moved)
    assert any(note.startswith("4 detections") for note in result.notes)


def test_a_missing_object_stays_where_it_was_with_a_note(table, moved, paint, things):
    kept = table(paint([moved[0], moved[1], moved[3]])[0]).matches[2]
    assert (kept.method, kept.box, kept.confidence, kept.ncc) == ("kept", None, 0.0, None)
    assert kept.position == pytest.approx(things[2].xy)
    assert "kept where it was" in kept.note


@pytest.mark.slow
def test_a_missing_object_goes_where_the_plan_wants_it(table, moved, paint, things):
    relation = Relation(subject="marker_red", relation="right_of", reference="box")
    plan = LayoutPlan(text="The red marker goes to the right of the box.", relations=[relation])
    result = table(paint([moved[0], moved[1], moved[3]])[0], plan=plan)
    kept = result.matches[2]
    assert kept.method == "kept"
    assert kept.position[0] > moved[0].xy[0] + 0.12
    assert "where the plan wants it" in kept.note


@pytest.mark.slow
def test_an_object_hidden_in_the_source_is_never_matched(table, target, paint, things):
    segmentation = paint(things)[1]
    result = table(target, segmentation=np.where(segmentation == 2, 0, segmentation))
    assert result.matches[1].method == "kept"
    assert "hidden" in result.matches[1].note
    assert len(result.unclaimed) == 1


def test_on_an_empty_table_no_object_is_found(table, background):
    assert {m.method for m in table(background).matches} == {"kept"}


@pytest.mark.slow
def test_no_object_claims_a_stranger(table, moved, paint):
    stranger = replace(moved[3], id="stranger", size=(0.09, 0.09, 0.02), colour=(60, 200, 90), xy=(-0.05, -0.2))
    result = table(paint([*moved, stranger])[0])
    assert_found(result, moved)
    assert len(result.unclaimed) == 1


@pytest.mark.slow
def test_of_an_object_drawn_twice_one_is_taken_and_noted(table, moved, paint):
    result = table(paint([*moved, replace(moved[3], xy=(-0.05, -0.2), yaw=0.4)])[0])
    assert result.matches[3].method != "kept"
    assert any("drawn twice" in note for note in result.notes)


@pytest.mark.slow
def test_a_known_symmetry_gives_the_smallest_turn(table, target):
    turned = {order: table(target, symmetry={"marker_red": order}).matches[2].turned for order in (2, 0)}
    assert abs(turned[2]) <= np.pi / 2
    assert turned[0] == 0


def test_below_the_threshold_nothing_is_matched_by_features(table, target):
    matches = table(target, threshold=0.9999).matches
    assert {m.method for m in matches} == {"kept"}
    assert all(m.note.startswith("too unlike") for m in matches)


@pytest.mark.slow
def test_a_label_of_the_detector_names_the_method_below_the_threshold(table, target, moved, paint, detect, things):
    found = {int(paint(moved)[1][d.mask].max()): d for d in detect(paint(moved)[1])}
    labelled = [replace(found[k + 1], label=thing.phrase) for k, thing in enumerate(things)]
    assert {m.method for m in table(target, detector=Fixed(labelled), threshold=0.9999).matches} == {"name"}


def test_the_same_picture_gives_the_same_matches(table, target):
    assert table(target).matches == table(target).matches


def test_pictures_of_a_scene_that_differ_in_size_are_refused(things, paint, background):
    source, segmentation = paint(things)
    with pytest.raises(ValueError, match="differ in size"):
        ScenePictures(source[:100], segmentation, background)


def test_an_unknown_robot_is_an_error_if_the_plan_gives_a_place(things, make_scene):
    scene = make_scene(things).model_copy(update={"robot": "dual_panado"})
    relation = Relation(subject="marker_red", relation="right_of", reference="box")
    plan = LayoutPlan(text="The red marker goes to the right of the box.", relations=[relation])
    with pytest.raises(UnknownName, match="dual_panado"):
        observation = SimpleNamespace(scene=scene, shown={"marker_red"})
        stored_matches(observation, plan, {}, {"marker_red": "not found"})
