from __future__ import annotations

import numpy as np
import pytest

from tests.layout.items import roll, standing_at, tray
from vcage.layout.groups import assign_containers
from vcage.layout.items import TableItem
from vcage.objects.openings import Opening

CUP = Opening(centre=(0.0, 0.0), size=(0.06, 0.06), floor=0.005, rim=0.105)


def test_an_allowed_content_that_touches_its_container_is_assigned():
    assert assign_containers([tray(), roll()]) == {"tray": None, "roll": "tray"}


def test_without_permission_nothing_is_assigned():
    assert assign_containers([tray(), roll(inside=None)])["roll"] is None


def test_an_object_beside_its_container_stays_there():
    assert assign_containers([tray(), roll(target=(0.3, 0))])["roll"] is None


def test_an_object_longer_than_the_opening_is_not_assigned():
    assert assign_containers([tray(), roll(size=(0.28, 0.02, 0.02))])["roll"] is None


def test_the_opening_turns_with_its_container():
    items = [tray(yaw=np.pi / 2), roll(size=(0.25, 0.02, 0.02))]
    assert assign_containers(items)["roll"] is None
    assert assign_containers([items[0], roll(size=(0.25, 0.02, 0.02), yaw=np.pi / 2)])["roll"] == "tray"


def test_a_full_container_takes_no_more():
    items = [tray(), *[roll(f"roll{k}", size=(0.12, 0.12, 0.05)) for k in range(4)]]
    assert [assign_containers(items)[f"roll{k}"] for k in range(4)] == ["tray", "tray", None, None]


def test_volume_counts_in_deep_containers():
    cup = standing_at("cup", (0.07, 0.07, 0.1), 0.0, (0, 0), CUP)
    tall = standing_at("tall", (0.05, 0.05, 0.2), 0.0, (0, 0), inside="cup")
    low = standing_at("low", (0.05, 0.05, 0.08), 0.0, (0, 0), inside="cup")
    assert assign_containers([cup, tall])["tall"] is None
    assert assign_containers([cup, low])["low"] == "cup"


def test_a_planned_content_is_assigned_regardless_of_its_targets_place():
    items = [tray(), roll(target=(0.3, 0))]
    assert assign_containers(items, demanded=["roll"])["roll"] == "tray"


def block(name: str, **fields) -> TableItem:
    top = Opening(centre=(0.0, 0.0), size=(0.05, 0.05), floor=0.05, rim=np.inf)
    return standing_at(
        **{"id": name, "size": (0.05, 0.05, 0.05), "yaw": 0.0, "target": (0, 0), "opening": top, **fields}
    )


def test_one_thing_as_large_as_a_bare_top_stands_on_it_at_any_heading():
    items = [block("a"), block("b", yaw=0.5, inside="a"), block("c", inside="a")]
    assert assign_containers(items) == {"a": None, "b": "a", "c": None}


def test_the_rectangle_turns_about_the_origin():
    item = roll(centre=(0.1, 0.0), yaw=np.pi / 2)
    assert item.rectangle() == pytest.approx(np.array([[-0.03, 0.05], [0.03, 0.15]]))


def test_relations_see_the_body_and_not_the_room():
    item = roll(centre=(0.1, 0.0), body=[[-0.01, -0.02], [0.01, 0.02]], yaw=np.pi / 2)
    assert item.body_rectangle() == pytest.approx(np.array([[-0.02, -0.01], [0.02, 0.01]]))
