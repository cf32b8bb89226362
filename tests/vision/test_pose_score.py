from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vcage.vision.colour import LabImage
from vcage.vision.object_templates import template_of
from vcage.vision.pose_score import fit, from_pixels, mask_at, middles, refine
from vcage.vision.symmetry import smallest_turn


@pytest.fixture(scope="module")
def tall(things, paint, make_scene, camera):
    """A tall box away from the middle, its template, and its pose before it moves."""
    thing = replace(things[0], size=(0.10, 0.07, 0.18), xy=(0.3, 0.15), yaw=0.2)
    picture, segmentation = paint([thing])
    image = LabImage.of(picture, (segmentation > 0).astype(np.float32))
    record = make_scene([thing]).objects[0]
    template = template_of(image, segmentation == 1, camera, np.array(record.aabb), np.array(thing.xy))
    return thing, image, template, np.array([*thing.xy, 0.0, 0.0])


def test_an_unmoved_object_fits_perfectly_except_at_its_edges(tall):
    _, image, template, pose = tall
    assert fit(image, template, pose[None]).goodness[0] > 0.93


def test_the_outline_at_the_old_place_is_the_old_outline(tall):
    _, _, template, pose = tall
    drawn = mask_at(template, pose)
    assert (drawn & template.mask).sum() > 0.9 * (drawn | template.mask).sum()


def test_a_tall_object_is_followed_to_where_the_camera_sees_its_other_side(tall, paint):
    thing, _, template, _ = tall
    picture, segmentation = paint([replace(thing, xy=(-0.32, -0.12), yaw=1.0)])
    image = LabImage.of(picture, (segmentation > 0).astype(np.float32))
    start = np.array([[-0.31, -0.13, 0.7, 0.0]])
    found = refine(image, template, start, np.array([0.005, 0.005, 0.12, 0.03]), 25).poses[0]
    assert np.hypot(*(found[:2] - [-0.32, -0.12])) < 0.015
    assert abs(found[2] - 0.8) < np.deg2rad(6)


def test_the_middle_is_seen_where_the_camera_projects_it(tall, camera):
    thing, _, template, pose = tall
    wanted = camera.project(np.array([*thing.xy, 0.74 + 0.09]))
    assert middles(template, pose[None])[0] == pytest.approx(wanted, abs=0.05)


def test_a_crop_laid_where_it_was_keeps_its_place(tall):
    thing, _, template, _ = tall
    assert from_pixels(template, np.array([[*template.centre, 0.0, 0.0]]))[0, :2] == pytest.approx(thing.xy)


def test_no_poses_fit_nowhere(tall):
    _, image, template, _ = tall
    assert fit(image, template, np.zeros((0, 4))).goodness.shape == (0,)
    assert refine(image, template, np.zeros((0, 4)), np.ones(4), 3).poses.shape == (0, 4)


@pytest.mark.parametrize(("degrees", "order", "expected"), [(170, 1, 170), (170, 2, -10), (100, 4, 10), (77, 0, 0)])
def test_the_smallest_of_equal_turns_is_taken(degrees, order, expected):
    assert np.rad2deg(smallest_turn(np.deg2rad(degrees), order)) == pytest.approx(expected)
