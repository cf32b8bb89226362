"""Every object of the library: shape, collision pieces, points."""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np
import pytest
import trimesh

from vcage.objects.asset import Asset

GRIPPER_OPENING = 0.07


def _visual(asset: Asset) -> trimesh.Trimesh:
    """The picture meshes of the body and of all moving parts, at rest, without their colours."""
    return _shape((asset.model.visual, *(link.visual for link in asset.model.links)))


@functools.cache
def _shape(paths: tuple[Path, ...]) -> trimesh.Trimesh:
    parts = [part for path in paths for part in trimesh.load_scene(path, process=False).dump()]
    return trimesh.util.concatenate([trimesh.Trimesh(part.vertices, part.faces, process=False) for part in parts])


def _share(asset: Asset) -> float:
    """Of the surface that has to keep to a limit: all of ours, and all but the crannies of a model of others."""
    return 1.0 if asset.annotation.source == "parametric" else 0.95


def _distance_outside(asset: Asset, points: np.ndarray) -> np.ndarray:
    """(n,) how far points lie outside the nearest piece; 0 inside."""
    return np.maximum(np.min([piece.outside(points) for piece in asset.pieces], axis=0), 0)


def test_bounds_stand_on_the_ground_and_are_centred(asset: Asset) -> None:
    assert asset.bounds[0, 2] == pytest.approx(0, abs=1e-6)
    np.testing.assert_allclose(asset.bounds[:, :2].sum(axis=0), 0, atol=2e-6)


def test_the_picture_mesh_fills_the_bounds(asset: Asset) -> None:
    np.testing.assert_allclose(_visual(asset).bounds, asset.bounds, atol=0.002)


def test_triangles_are_few(asset: Asset) -> None:
    assert len(_visual(asset).faces) <= 6000


def test_pieces_cover_the_mesh_within_3_mm(first_variant: Asset) -> None:
    points = trimesh.sample.sample_surface(_visual(first_variant), 1500, seed=0)[0]
    assert np.quantile(_distance_outside(first_variant, points), _share(first_variant)) <= 0.003


def _outer_corners(asset: Asset) -> np.ndarray:
    """(n, 3) the corners of all pieces that do not lie within another piece."""
    corners = []
    for piece in asset.pieces:
        others = [other.outside(piece.vertices) for other in asset.pieces if other is not piece]
        corners.append(piece.vertices[np.min(others, axis=0) > -1e-4] if others else piece.vertices)
    return np.concatenate(corners)


def test_pieces_do_not_stand_out_of_the_mesh(first_variant: Asset) -> None:
    mesh = _visual(first_variant)
    corners = _outer_corners(first_variant)
    surface = np.concatenate([mesh.vertices, trimesh.sample.sample_surface(mesh, 60000, seed=0)[0]])
    far = trimesh.proximity.cKDTree(surface).query(corners)[0] > 0.006
    if first_variant.annotation.source != "parametric":  # its surface is rarely closed, so nothing is inside of it
        assert far.mean() <= 0.1
        return
    inside = mesh.contains(corners[far]) if far.any() and mesh.is_watertight else np.zeros(far.sum(), dtype=bool)
    assert inside.all()


def test_collision_files_are_convex_and_closed(first_variant: Asset) -> None:
    for path in [*first_variant.model.hulls, *(path for link in first_variant.model.links for path in link.hulls)]:
        mesh = trimesh.load(path)
        assert mesh.is_watertight and mesh.volume > 0
        assert len(mesh.vertices) < 255
        assert mesh.convex_hull.volume == pytest.approx(mesh.volume, rel=1e-3)


def test_contact_points_can_be_grasped(asset: Asset) -> None:
    for contact in asset.annotation.contact_points:
        assert 0 < asset.grasp_width(contact) <= GRIPPER_OPENING, contact.name


def test_contact_points_leave_room_for_the_finger_tips(asset: Asset) -> None:
    for contact in asset.annotation.contact_points:
        assert 0.01 < contact.position[2] < asset.size[2], contact.name


def test_closing_is_across_the_approach(first_variant: Asset) -> None:
    for contact in first_variant.annotation.contact_points:
        assert abs(np.dot(contact.approach, contact.closing)) < 1e-6


def test_functional_points_have_room(first_variant: Asset) -> None:
    for point in first_variant.annotation.functional_points:
        opening = first_variant.opening(point)
        assert min(opening.size) >= 0.035
        assert abs(opening.floor - point.position[2]) < 0.001
        np.testing.assert_allclose(opening.centre, point.position[:2], atol=0.003)


def test_containers_are_open_from_above(first_variant: Asset) -> None:
    for point in first_variant.annotation.functional_points:
        if point.holds == "in" and not point.sideways:
            column = np.linspace(point.position[2] + 0.002, first_variant.size[2] + 0.05, 40)
            points = np.column_stack([np.tile(point.position[:2], (40, 1)), column])
            own = first_variant.pieces_of(point.link)  # drawers are pulled out and lids open
            assert (np.min([piece.outside(points) for piece in own], axis=0) > 0).all()
