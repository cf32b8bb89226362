"""Collision pieces of meshes in all the states in which they come."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from vcage.objects.importers.component_hulls import component_hulls, convex_hull, hulls_of_surface, joined


def box(*bounds) -> trimesh.Trimesh:
    return trimesh.creation.box(bounds=bounds)


def hulls(*parts: trimesh.Trimesh) -> list[trimesh.Trimesh]:
    return component_hulls(*joined(list(parts)))


def test_separate_parts_are_pieces_of_their_own():
    assert len(hulls(box((0, 0, 0), (1, 1, 1)), box((2, 0, 0), (3, 1, 1)))) == 2


def test_closed_solids_that_touch_are_pieces_of_their_own():
    assert len(hulls(box((0, 0, 0), (1, 1, 1)), box((1, 0, 0), (2, 1, 1)))) == 2


def test_an_open_surface_is_one_piece():
    sheet = box((0, 0, 0), (1, 1, 1))
    sheet.update_faces(np.arange(12) != 0)
    assert len(hulls(sheet)) == 1


def test_a_surface_with_both_sides_drawn_is_one_piece():
    one = box((0, 0, 0), (1, 1, 1))
    turned = one.copy()
    turned.invert()
    (hull,) = hulls(one, turned)
    assert hull.volume == pytest.approx(1)


def test_a_surface_without_shared_corners_is_one_piece():
    one = box((0, 0, 0), (1, 1, 1))
    one.unmerge_vertices()
    (hull,) = hulls(one)
    assert hull.is_watertight and len(hull.vertices) == 8


def test_a_flat_part_gets_a_thickness():
    flat = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]], process=False)
    (hull,) = hulls(flat)
    assert hull.volume == pytest.approx(0.001)


def test_a_line_is_no_piece():
    assert convex_hull(np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0.0]])) is None


def test_the_shape_of_a_mere_surface_keeps_containers_open():
    pot = trimesh.creation.annulus(0.04, 0.05, 0.08)
    pieces = hulls_of_surface(np.asarray(pot.vertices), np.asarray(pot.faces))
    assert sum(piece.volume for piece in pieces) < 1.5 * pot.volume
