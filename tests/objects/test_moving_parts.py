"""Drawers, doors and lids of our furniture keep clear of everything else, and a hand finds room at their handles."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import trimesh

from vcage.objects.asset import Asset
from vcage.objects.library import Library
from vcage.sim.joints import link_poses

FURNITURE = (
    "cabinet_one_drawer",
    "cabinet_two_drawers",
    "cabinet_three_drawers",
    "cash_drawer",
    "hinged_cabinet",
    "lidded_box",
)

CLEARANCE = 0.0005
"""Least distance between two parts, metres."""

PALM, PALM_OFFSET = (0.20, 0.064, 0.06), 0.037
"""The palm: along the closing axis, across it, and away from the object, where it begins above the grasp, metres."""


@pytest.fixture(params=FURNITURE)
def furniture(request: pytest.FixtureRequest, library: Library) -> Asset:
    return library.asset(request.param)


def _surface(asset: Asset, link: str | None) -> np.ndarray:
    """(n, 3) corners and samples of the pieces of a part."""
    hulls = asset.model.hulls if link is None else asset.model.link(link).hulls
    meshes = [trimesh.load(path) for path in hulls]
    return np.concatenate([points for m in meshes for points in (m.vertices, _samples(m))])


def _samples(mesh: trimesh.Trimesh, count: int = 150) -> np.ndarray:
    return trimesh.sample.sample_surface(mesh, count, seed=0)[0]


def _outside(asset: Asset, link: str | None, points: np.ndarray) -> np.ndarray:
    """(n,) how far points lie outside the nearest piece of a part."""
    return np.min([piece.outside(points) for piece in asset.pieces_of(link)], axis=0)


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 1.0])
def test_parts_keep_clear_of_each_other_over_the_whole_range(furniture: Asset, share: float) -> None:
    names = [None, *(link.name for link in furniture.model.links)]
    surfaces = {name: _surface(furniture, name) for name in names}
    for link in furniture.model.links:
        poses = link_poses(furniture.model, [share * x.joint.far_end * (x == link) for x in furniture.model.links])
        for other in names:
            if other != link.name:
                there = poses[other].inverse() * poses[link.name]
                assert _outside(furniture, other, there.apply(surfaces[link.name])).min() >= CLEARANCE
                assert _outside(furniture, link.name, there.inverse().apply(surfaces[other])).min() >= CLEARANCE


def test_every_moving_part_has_a_handle_4_cm_above_the_table(furniture: Asset) -> None:
    held = {contact.link: contact for contact in furniture.annotation.contact_points}
    assert set(held) == {link.name for link in furniture.model.links}
    for contact in held.values():
        assert contact.position[2] >= 0.05
        assert 0.008 <= furniture.grasp_width(contact) <= 0.016


def test_the_palm_finds_room_at_every_handle(furniture: Asset) -> None:
    box = np.array(list(itertools.product(*(np.linspace(-0.5, 0.5, 15) * size for size in PALM))))
    for contact in furniture.annotation.contact_points:
        approach, closing = np.array(contact.approach), np.array(contact.closing)
        across = np.cross(approach, closing)
        axes = np.stack([closing, across, -approach])
        middle = np.array(contact.position) - (PALM_OFFSET + PALM[2] / 2) * approach
        points = middle + box @ axes
        for link in (None, *(x.name for x in furniture.model.links)):
            assert _outside(furniture, link, points).min() > 0, (contact.name, link)


def test_a_lid_stays_open_by_its_own_weight(library: Library) -> None:
    box = library.asset("lidded_box")
    (lid,) = box.model.links
    centre = np.mean(_surface(box, "lid"), axis=0)
    opened = link_poses(box.model, [lid.joint.upper])["lid"].apply(centre)
    assert opened[1] > lid.joint.origin[1] + 0.01
