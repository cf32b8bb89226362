"""Drawers, doors, lids, screens, levers, dials and buttons keep clear of the rest, and a hand finds room at them."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import trimesh

from vcage.objects.asset import Asset
from vcage.objects.library import Library
from vcage.schema.asset import ContactPoint
from vcage.sim.joints import link_poses

FURNITURE = (
    "cabinet_one_drawer",
    "cabinet_two_drawers",
    "cabinet_three_drawers",
    "cash_drawer",
    "hinged_cabinet",
    "lidded_box",
)

DEVICES = {"kitchen_timer": "dial", "laptop": "screen", "microwave": "door", "service_bell": "button", "tap": "lever"}
"""Device → its one moving part."""

TURNING = sorted(set(DEVICES) - {"service_bell"})

PALM, PALM_OFFSET = (0.20, 0.064, 0.06), 0.037
"""The palm: along the closing axis, across it, and away from the object, where it begins above the grasp, metres."""


@pytest.fixture(scope="session")
def furniture(library: Library) -> list[Asset]:
    return [library.asset(name) for name in FURNITURE]


@pytest.fixture(scope="session")
def devices(library: Library) -> list[Asset]:
    return [library.asset(name) for name in sorted(DEVICES)]


@pytest.fixture(scope="session")
def turning(library: Library) -> list[Asset]:
    return [library.asset(name) for name in TURNING]


def _handle(asset: Asset) -> ContactPoint:
    return next(contact for contact in asset.annotation.contact_points if contact.link == DEVICES[asset.name])


def _surface(asset: Asset, link: str | None, samples: int) -> np.ndarray:
    """(n, 3) corners of the pieces of a part, and as many samples on each."""
    hulls = asset.model.hulls if link is None else asset.model.link(link).hulls
    meshes = [trimesh.load_mesh(path) for path in hulls]
    return np.concatenate(
        [p for m in meshes for p in (m.vertices, trimesh.sample.sample_surface(m, samples, seed=0)[0])]
    )


def _outside(asset: Asset, link: str | None, points: np.ndarray) -> float:
    """Distance of the nearest point from a part; negative when one is inside."""
    return float(np.min([piece.outside(points).min() for piece in asset.pieces_of(link)]))


def _least_gap(asset: Asset, share: float, samples: int) -> float:
    """Least distance of a moving part from all others, each joint in turn at a share of its range, the rest closed."""
    names = [None, *(link.name for link in asset.model.links)]
    surfaces = {name: _surface(asset, name, samples) for name in names}
    gaps = []
    for link in asset.model.links:
        poses = link_poses(asset.model, [share * x.joint.far_end * (x == link) for x in asset.model.links])
        for other in (name for name in names if name != link.name):
            there = poses[other].inverse() * poses[link.name]
            gaps.append(_outside(asset, other, there.apply(surfaces[link.name])))
            gaps.append(_outside(asset, link.name, there.inverse().apply(surfaces[other])))
    return min(gaps)


def _palm_room(asset: Asset, contact: ContactPoint) -> tuple[float, float]:
    """Distance of a palm at a contact point from the table and all parts, metres; negative inside them."""
    box = np.array(list(itertools.product(*(np.linspace(-0.5, 0.5, 15) * size for size in PALM))))
    approach, closing = np.array(contact.approach), np.array(contact.closing)
    middle = np.array(contact.position) - (PALM_OFFSET + PALM[2] / 2) * approach
    points = middle + box @ np.stack([closing, np.cross(approach, closing), -approach])
    parts = [None, *(link.name for link in asset.model.links)]
    return float(points[:, 2].min()), min(_outside(asset, link, points) for link in parts)


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 1.0])
def test_parts_of_furniture_keep_half_a_millimetre_over_the_whole_range(furniture: list[Asset], share: float) -> None:
    assert {a.name: gap for a in furniture if (gap := _least_gap(a, share, samples=150)) < 0.0005} == {}


def test_every_part_of_furniture_has_a_handle_4_cm_above_the_table(furniture: list[Asset]) -> None:
    for asset in furniture:
        held = {contact.link: contact for contact in asset.annotation.contact_points}
        assert set(held) == {link.name for link in asset.model.links}, asset.name
        for contact in held.values():
            assert contact.position[2] >= 0.05, (asset.name, contact.name)
            assert 0.008 <= asset.grasp_width(contact) <= 0.016, (asset.name, contact.name)


def test_the_palm_finds_room_at_every_handle_of_furniture(furniture: list[Asset]) -> None:
    handles = [(asset, contact) for asset in furniture for contact in asset.annotation.contact_points]
    assert [(a.name, contact.name) for a, contact in handles if _palm_room(a, contact)[1] <= 0] == []


def test_a_lid_stays_open_by_its_own_weight(library: Library) -> None:
    box = library.asset("lidded_box")
    (lid,) = box.model.links
    centre = np.mean(_surface(box, "lid", samples=150), axis=0)
    opened = link_poses(box.model, [lid.joint.upper])["lid"].apply(centre)
    assert opened[1] > lid.joint.origin[1] + 0.01


def test_the_moving_part_of_a_device_has_its_name(devices: list[Asset]) -> None:
    assert {asset.name: [link.name for link in asset.model.links] for asset in devices} == {
        name: [part] for name, part in DEVICES.items()
    }


def test_the_part_of_a_device_at_rest_touches_nothing(devices: list[Asset]) -> None:
    assert {a.name: gap for a in devices if (gap := _least_gap(a, 0.0, samples=300)) < 0.0004} == {}


@pytest.mark.parametrize("share", [0.05, 0.3, 0.65, 1.0])
def test_the_part_of_a_device_turns_without_touching_the_body(turning: list[Asset], share: float) -> None:
    assert {a.name: gap for a in turning if (gap := _least_gap(a, share, samples=300)) < 0.0004} == {}


def test_a_handle_of_a_device_is_thin_enough_for_open_fingers(turning: list[Asset]) -> None:
    assert {a.name: w for a in turning if not 0.01 <= (w := a.grasp_width(_handle(a))) <= 0.016} == {}


def test_the_palm_finds_room_at_the_handle_of_a_device(turning: list[Asset]) -> None:
    assert {a.name: room for a in turning if min(room := _palm_room(a, _handle(a))) <= 0} == {}


def test_the_button_is_pressed_at_the_middle_of_its_top(library: Library) -> None:
    bell = library.asset("service_bell")
    contact = _handle(bell)
    assert contact.use == "press"
    np.testing.assert_allclose(contact.position, [0, 0, bell.size[2]], atol=0.001)


def test_the_buttons_spring_carries_its_weight_and_yields_to_a_finger(library: Library) -> None:
    (button,) = library.asset("service_bell").model.links
    pressed = button.joint.spring * button.joint.upper
    assert 10 * button.mass * 9.81 < pressed < 10


def test_the_open_screen_leans_back_and_the_laptop_stands(library: Library) -> None:
    laptop = library.asset("laptop")
    (screen,) = laptop.model.links
    opened = link_poses(laptop.model, [screen.joint.upper])["screen"]
    centre = opened.apply(_surface(laptop, "screen", samples=300)).mean(axis=0)
    back = _surface(laptop, None, samples=300)[:, 1].max()
    assert centre[1] > screen.joint.origin[1]
    # Its weight behind the base's back edge is a small part of the base's in front of it.
    assert screen.mass * (centre[1] - back) < 0.1 * laptop.model.mass * back
