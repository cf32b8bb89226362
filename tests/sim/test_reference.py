from __future__ import annotations

import numpy as np

from vcage.sim.reference import reference_view


def test_the_reference_has_the_scale_it_says(models):
    view = reference_view(models["tray"], metres_per_pixel=0.002)
    rows, columns = np.nonzero(view[..., 3])
    assert view.dtype == np.uint8
    assert abs((columns.max() - columns.min() + 1) * 0.002 - 0.2) < 0.005
    assert abs((rows.max() - rows.min() + 1) * 0.002 - 0.14) < 0.005


def test_x_is_to_the_right_and_y_up(models):
    alpha = reference_view(models["bar"])[..., 3]  # its lug is at +x, +y
    v, _ = np.nonzero(alpha)
    height, width = alpha.shape
    assert v.min() + 0.5 < height - v.max()  # reaches further up than down
    assert alpha[v.min(), : width // 2].max() == 0 and alpha[v.min(), width // 2 :].max() == 255


def test_colour_is_the_objects(models):
    view = reference_view(models["cube"])
    colour = view[view[..., 3] > 0][:, :3].mean(axis=0)
    assert colour[0] > 2 * colour[1]
