"""What is measured where something was put in or on another."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from tests.models.tabletop import BLOCKS, BOX, CAMERA, HEIGHT, view
from vcage.base.geometry import Pose, box_corners
from vcage.models.rules.evidence.places import besides_shift, margin_of
from vcage.models.rules.pixels import Change

ROOM = box_corners([-0.1, -0.05, 0.0], [0.1, 0.05, 0.04])[None]
POSE = Pose.from_yaw((0.1, 0.05, HEIGHT), 0.4)


@pytest.mark.parametrize("shift", [(0.012, 0.0), (-0.01, 0.008)])
def test_a_shift_alone_is_no_change(shift: tuple[float, float]) -> None:
    nudged = BOX.moved(at=(BOX.at[0] + shift[0], BOX.at[1] + shift[1]))
    was, now = view([BOX]), view([nudged])
    change = Change.between(was, now).all
    left = besides_shift(was.picture, now.picture, change)
    assert left.sum() <= 0.3 * change.sum()


def test_an_arrival_is_seen_beside_a_shifted_object() -> None:
    nudged, block = BOX.moved(at=(BOX.at[0] + 0.01, BOX.at[1])), BLOCKS[0].moved(at=BOX.at, base=0.005)
    was, now = view([BOX]), view([nudged, block])
    left = besides_shift(was.picture, now.picture, Change.between(was, now).all)
    shown = view([nudged]).picture.astype(int) - now.picture
    assert left[np.abs(shown).max(axis=2) > 40].mean() > 0.9


@pytest.mark.parametrize(("local", "margin"), [((0.0, 0.0), 0.05), ((0.08, 0.0), 0.02), ((0.0, 0.06), -0.01)])
def test_the_margin_is_how_far_the_middle_is_from_the_edge(local: tuple[float, float], margin: float) -> None:
    u, v = CAMERA.project(POSE.apply(np.array([[*local, 0.0]])))[0]
    blob = np.zeros((CAMERA.height, CAMERA.width), np.uint8)
    cv2.circle(blob, (round(u - 0.5), round(v - 0.5)), 5, (1,), -1)
    assert margin_of(blob.astype(bool), ROOM, POSE, CAMERA) == pytest.approx(margin, abs=0.003)


def test_an_unseen_object_has_no_position() -> None:
    assert margin_of(np.zeros((CAMERA.height, CAMERA.width), bool), ROOM, POSE, CAMERA) == -np.inf
