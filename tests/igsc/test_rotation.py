from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vcage.igsc.rotation import estimate_rotation, mask_centroid


@pytest.mark.parametrize("turn", [-170, -97, -31, -3, 0, 14, 60, 122, 180])
def test_a_two_ended_object_is_turned_back_within_two_degrees(things, paint, turn):
    marker = replace(things[2], xy=(0.0, 0.0))
    first, mask = paint([replace(marker, yaw=0.3)])
    second, other = paint([replace(marker, yaw=0.3 + np.deg2rad(turn))])
    angle, ncc = estimate_rotation(first, mask > 0, second, other > 0)
    assert abs((np.rad2deg(angle) - turn + 180) % 360 - 180) < 2
    assert ncc > 0.9


def test_a_round_object_is_not_turned():
    v, u = np.mgrid[:200, :200]
    mask = np.hypot(u - 100, v - 100) < 40
    picture = np.where(mask[..., None], 230, 120).astype(np.uint8).repeat(3, axis=2)
    angle, ncc = estimate_rotation(picture, mask, picture, mask)
    assert angle == 0.0
    assert ncc > 0.99


def test_a_symmetric_object_takes_the_smaller_turn():
    mask = np.zeros((200, 200), dtype=bool)
    mask[80:120, 50:150] = True
    picture = np.where(mask[..., None], 230, 120).astype(np.uint8).repeat(3, axis=2)
    angle, _ = estimate_rotation(picture, mask, picture, mask)
    assert angle == 0.0


def test_the_centroid_of_one_pixel_is_its_middle():
    mask = np.zeros((4, 5), dtype=bool)
    mask[1, 3] = True
    assert mask_centroid(mask).tolist() == [3.5, 1.5]
