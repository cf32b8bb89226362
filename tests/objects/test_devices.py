"""Doors, screens, levers, dials and buttons keep clear of their bodies, and a hand finds room at them."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import trimesh

from vcage.objects.asset import Asset
from vcage.objects.library import Library
from vcage.schema.asset import ContactPoint
from vcage.sim.joints import link_poses

MOVING = {"kitchen_timer": "dial", "laptop": "screen", "microwave": "door", "service_bell": "button", "tap": "lever"}
TURNING = sorted(set(MOVING) - {"service_bell"})

CLEARANCE = 0.0004
"""Least distance between a moving part and the body, metres."""

PALM, PALM_OFFSET = (0.20, 0.064, 0.06), 0.037
"""The palm: along the closing axis, across it, and away from the object, where it begins above the grasp, metres."""


@pytest.fixture(params=sorted(MOVING))
def device(request: pytest.FixtureRequest, library: Library) -> Asset:
    return library.asset(request.param)


@pytest.fixture(params=TURNING)
def turning(request: pytest.FixtureRequest, library: Library) -> Asset:
    return library.asset(request.param)


def _handle(asset: Asset) -> ContactPoint:
    return next(contact for contact in asset.annotation.contact_points if contact.link == MOVING[asset.name])


def _surface(asset: Asset, link: str | None) -> np.ndarray:
    """(n, 3) corners and samples of the pieces of a part."""
    hulls = asset.model.hulls if link is None else asset.model.link(link).hulls
    meshes = [trimesh.load(path) for path in hulls]
    return np.concatenate([p for m in meshes for p in (m.vertices, trimesh.sample.sample_surface(m, 300, seed=0)[0])])


def _outside(asset: Asset, link: str | None, points: np.ndarray) -> float:
    """How far the nearest of the points lies outside a part; negative when one is inside."""
    return float(np.min([piece.outside(points).min() for piece in asset.pieces_of(link)]))


def _gap(asset: Asset, share: float) -> float:
    """Least distance between the moving part and the body with the joint at a share of its range."""
    (link,) = asset.model.links
    moved = link_poses(asset.model, [share * link.joint.far_end])[link.name]
    there = _outside(asset, None, moved.apply(_surface(asset, link.name)))
    back = _outside(asset, link.name, moved.inverse().apply(_surface(asset, None)))
    return min(there, back)


def test_the_moving_part_has_its_name(device: Asset) -> None:
    assert [link.name for link in device.model.links] == [MOVING[device.name]]


def test_the_part_at_rest_touches_nothing(device: Asset) -> None:
    assert _gap(device, 0.0) >= CLEARANCE


@pytest.mark.parametrize("share", [0.05, 0.3, 0.65, 1.0])
def test_the_part_turns_without_touching_the_body(turning: Asset, share: float) -> None:
    assert _gap(turning, share) >= CLEARANCE


def test_a_handle_is_thin_enough_for_open_fingers(turning: Asset) -> None:
    assert 0.01 <= turning.grasp_width(_handle(turning)) <= 0.016


def test_the_palm_finds_room_at_the_handle(turning: Asset) -> None:
    contact = _handle(turning)
    approach, closing = np.array(contact.approach), np.array(contact.closing)
    box = np.array(list(itertools.product(*(np.linspace(-0.5, 0.5, 15) * size for size in PALM))))
    middle = np.array(contact.position) - (PALM_OFFSET + PALM[2] / 2) * approach
    points = middle + box @ np.stack([closing, np.cross(approach, closing), -approach])
    assert points[:, 2].min() > 0
    assert min(_outside(turning, link, points) for link in (None, MOVING[turning.name])) > 0


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
    centre = opened.apply(_surface(laptop, "screen")).mean(axis=0)
    back = _surface(laptop, None)[:, 1].max()
    assert centre[1] > screen.joint.origin[1]
    # Its weight behind the base's back edge is a small part of the base's in front of it.
    assert screen.mass * (centre[1] - back) < 0.1 * laptop.model.mass * back
