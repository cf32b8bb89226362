from __future__ import annotations

import numpy as np

from vcage.base.drawing import WARNING
from vcage.layout.items import TableItem
from vcage.layout.picture import collisions, draw_layout
from vcage.schema.scene import Table, Workspace

WORKSPACE = Workspace(lower=(-0.5, -0.3), upper=(0.5, 0.3))


def has_colour(picture: np.ndarray, colour: tuple[int, int, int]) -> bool:
    return bool(np.any(np.all(picture == colour, axis=2)))


LABELS = {"a": "black marker pen", "b": "box"}


def pair(apart: float) -> list[TableItem]:
    return [
        TableItem("a", (0.1, 0.02, 0.02), (0.5,), (-apart, 0.0)),
        TableItem("b", (0.1, 0.1, 0.05), (0.0,), (apart, 0.0)),
    ]


def test_collisions_of_container_and_content_do_not_count():
    assert len(collisions(pair(0.01))) == 1
    inside = [TableItem("a", (0.1, 0.02, 0.02), inside="b"), pair(0.0)[1]]
    assert collisions(inside) == []


def test_the_layout_picture_shows_both_plans_side_by_side():
    picture = draw_layout(pair(0.01), pair(0.1), LABELS, WORKSPACE, Table())
    assert picture.dtype == np.uint8
    assert picture.shape[1] > 2.5 * picture.shape[0]
    assert has_colour(picture[:, : picture.shape[1] // 2], WARNING)
    assert not has_colour(picture[:, picture.shape[1] // 2 :], WARNING)


def test_the_same_layout_gives_the_same_picture():
    first, second = (draw_layout(pair(0.01), pair(0.1), LABELS, WORKSPACE, Table()) for _ in range(2))
    assert (first == second).all()


def test_contents_of_a_turned_container_collide_along_its_walls_only():
    tray = TableItem("tray", (0.3, 0.3, 0.05), (0.7,))
    along = np.array([np.cos(0.7), np.sin(0.7)])
    near, far, touching = (
        TableItem(name, (0.05, 0.2, 0.05), (0.7,), tuple(by * along), inside="tray")
        for name, by in (("a", -0.03), ("b", 0.03), ("c", 0.01))
    )
    assert collisions([tray, near, far]) == []
    assert len(collisions([tray, near, touching])) == 1
