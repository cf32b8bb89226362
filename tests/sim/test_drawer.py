from __future__ import annotations

import numpy as np
import pytest

from vcage.base.geometry import Pose
from vcage.schema.scene import Table
from vcage.sim.bodies import Body
from vcage.sim.cameras import observe
from vcage.sim.drawer import ModelDrawer, Window, reference_view
from vcage.sim.world import World

NOWHERE = -2.0
"""Height of a table that is out of sight, metres."""

PLACE = Pose.from_yaw([0.12, -0.08, 0.74], 0.7)


@pytest.fixture(scope="module")
def drawer(models):
    return ModelDrawer(models)


def window_of(camera, step: int) -> Window:
    u, v = camera.project(PLACE.p)
    return Window(round(u) - 48, round(v) - 48, 96 // step, step)


def test_a_window_shows_the_same_as_the_whole_picture(drawer, models, template):
    camera = template.top_camera.camera()
    alone = World(Table(height=NOWHERE), {"bar": Body(models["bar"], PLACE)}, render=True)
    whole, window = observe(alone, camera), window_of(camera, 1)
    part = slice(window.top, window.top + 96), slice(window.left, window.left + 96)
    drawing = drawer.draw("bar", PLACE, camera, window)
    assert (drawing.covered != (whole.segmentation[part] > 0)).mean() < 0.002
    inside = drawing.covered & (whole.segmentation[part] > 0)
    assert np.abs(drawing.picture[inside].astype(int) - whole.picture[part][inside]).mean() < 2
    assert np.allclose(drawing.depth[inside], whole.depth[part][inside], atol=1e-3)
    assert drawing.depth[~drawing.covered].min(initial=np.inf) > drawing.depth[drawing.covered].max()


def test_a_smaller_drawing_covers_the_same_place(drawer, template):
    camera = template.top_camera.camera()
    full, half = (drawer.draw("bar", PLACE, camera, window_of(camera, step)).covered for step in (1, 2))
    assert np.abs(full.reshape(48, 2, 48, 2).mean(axis=(1, 3)) - half).mean() < 0.05


def test_only_the_requested_object_is_drawn(drawer, template):
    camera = template.top_camera.camera()
    first = drawer.draw("cube", PLACE, camera, window_of(camera, 1))
    drawer.draw("tray", PLACE, camera, window_of(camera, 1))
    again = drawer.draw("cube", PLACE, camera, window_of(camera, 1))
    assert np.array_equal(first.picture[first.covered], again.picture[again.covered])


def test_an_object_without_a_model_has_none(drawer):
    assert drawer.model("ghost") is None


def test_the_reference_has_the_scale_it_says(models):
    view = reference_view(models["tray"], metres_per_pixel=0.002)
    rows, columns = np.nonzero(view[..., 3])
    assert view.dtype == np.uint8
    assert abs((columns.max() - columns.min() + 1) * 0.002 - 0.2) < 0.005
    assert abs((rows.max() - rows.min() + 1) * 0.002 - 0.14) < 0.005


def test_in_the_reference_x_is_to_the_right_and_y_up(models):
    alpha = reference_view(models["bar"])[..., 3]  # its lug is at +x, +y
    v, _ = np.nonzero(alpha)
    height, width = alpha.shape
    assert v.min() + 0.5 < height - v.max()  # reaches further up than down
    assert alpha[v.min(), : width // 2].max() == 0 and alpha[v.min(), width // 2 :].max() == 255


def test_the_colour_of_the_reference_is_the_objects(models):
    view = reference_view(models["cube"])
    colour = view[view[..., 3] > 0][:, :3].mean(axis=0)
    assert colour[0] > 2 * colour[1]


def test_windows_of_about_one_size_share_a_camera(models, template):
    camera, drawer = template.top_camera.camera(), ModelDrawer(models)
    drawings = [drawer.draw("bar", PLACE, camera, Window(200, 200, side, 1)) for side in range(65, 97)]
    assert [len(drawing.covered) for drawing in drawings] == list(range(65, 97))
    assert len(drawer._world._cameras) == 1
