"""Objects on their sides: the look of a tall kind whose frame is that of the lying body."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import library, thing, world_of
from vcage.base.errors import InputFileError, UnknownName
from vcage.objects.lying import standing_in_lying

TALL = ("bottle", "can", "cup", "milk_carton")


@pytest.mark.parametrize("name", TALL)
def test_a_lying_look_is_the_standing_one_turned(name: str) -> None:
    standing = library().asset(name)
    lying = library().asset(name, f"{standing.variant.id}_lying")
    corners = lying.stands.apply(np.concatenate([piece.vertices for piece in standing.pieces]))
    assert np.allclose(np.concatenate([piece.vertices for piece in lying.pieces]), corners, atol=1e-5)
    assert np.allclose([corners.min(axis=0), corners.max(axis=0)], lying.bounds, atol=1e-4)
    assert lying.model.total_mass == standing.model.total_mass and lying.standing is standing


@pytest.mark.parametrize("name", TALL)
def test_its_head_points_along_y_and_its_origin_is_in_the_middle_of_its_bottom(name: str) -> None:
    lying = library().asset(name, f"{library().asset(name).variant.id}_lying")
    assert lying.stands.rotation()[1, 2] > 0.95
    assert np.allclose(lying.bounds.mean(axis=0)[:2], 0, atol=1e-4) and lying.bounds[0, 2] == 0


@pytest.mark.parametrize("name", TALL)
def test_what_lies_does_not_roll_away(name: str) -> None:
    lying = thing(name, (0.1, 0.0), 0.7, variant=f"{library().asset(name).variant.id}_lying")
    report = world_of([lying]).settle()
    assert report.settled and report.drift_m[name] < 0.002 and report.tilt_rad[name] < np.radians(2)


@pytest.mark.parametrize("name", TALL)
def test_a_hand_closes_across_it_from_above_and_its_head(name: str) -> None:
    lying = library().asset(name, f"{library().asset(name).variant.id}_lying")
    for contact in lying.annotation.carrying_points:
        assert contact.closing == (1.0, 0.0, 0.0) and contact.approach[2] < 0 and contact.approach[1] < 0
        assert 0.02 < lying.grasp_width(contact) < 0.08


def test_a_standing_object_is_seen_in_its_own_frame() -> None:
    lying = thing("can", (0.1, 0.0), 0.7, variant="corn_lying")
    assert abs(lying.as_standing.pose.rotation()[2, 2]) < 1e-6
    assert np.allclose(lying.as_standing.aabb, lying.aabb, atol=2e-3)
    assert thing("can").as_standing is not lying


@pytest.mark.parametrize("name", ["plate", "block", "ball", "cabinet_one_drawer"])
def test_what_is_no_taller_than_wide_or_moves_or_rolls_does_not_lie(name: str) -> None:
    asset = library().asset(name)
    assert standing_in_lying(asset) is None
    with pytest.raises(InputFileError, match=f"{name} is not tall, or would not lie still"):
        library().asset(name, f"{asset.variant.id}_lying")


def test_a_lying_look_of_no_look_is_unknown() -> None:
    with pytest.raises(UnknownName, match="unknown variant of can 'mauve_lying'"):
        library().asset("can", "mauve_lying")
