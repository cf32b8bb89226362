from __future__ import annotations

import numpy as np

from vcage.sim.drawer import Drawing
from vcage.vision.photometric_alignment import align


def test_a_drawing_that_shows_nothing_explains_nothing():
    nothing = Drawing(np.zeros((8, 8, 3), np.uint8), np.zeros((8, 8), bool), np.zeros((8, 8), np.float32))
    left, motion = align(nothing, np.zeros((8, 8, 4), np.float32), np.zeros((8, 8, 2, 3), np.float32), 1, 500.0)
    assert left == 1.0 and not motion.any()


def test_light_from_one_side_is_explained_by_the_way_surfaces_face():
    covered = np.zeros((32, 32), bool)
    covered[8:24, 8:24] = True
    grey = np.where(covered[..., None], np.uint8([128, 128, 128]), np.uint8(0))
    roof = np.abs(np.arange(32) - 15.5)[None].repeat(32, axis=0).astype(np.float32) / 500 + 1
    target = np.zeros((32, 32, 4), np.float32)
    target[..., 3] = covered
    target[:, :16, 0], target[:, 16:, 0] = 64, 44
    motions = np.zeros((32, 32, 2, 3), np.float32)
    faced, flat = (
        align(Drawing(grey, covered, depth), target, motions, 1, 500.0)[0] for depth in (roof, np.ones_like(roof))
    )
    assert faced < 0.7 * flat
