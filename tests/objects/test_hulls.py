"""Convex pieces of a fetched mesh."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import trimesh

from vcage.objects import hulls
from vcage.objects.convex import Convex
from vcage.objects.hulls import SETTINGS, convex_pieces


@pytest.fixture(scope="module", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """One cache for all tests here, as splitting a cup takes seconds."""
    folder = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("VCAGE_CACHE", str(folder))
        yield folder


def cup() -> trimesh.Trimesh:
    """A cup with walls of 4 mm, 8 cm wide and 9 cm high."""
    outer = trimesh.creation.cylinder(radius=0.04, height=0.09, sections=48)
    inner = trimesh.creation.cylinder(radius=0.036, height=0.09, sections=48)
    inner.apply_translation([0, 0, 0.006])
    return trimesh.boolean.difference([outer, inner], engine="manifold")


def outside(pieces: list[trimesh.Trimesh], points: np.ndarray) -> np.ndarray:
    """(n,) metres that points lie outside the nearest piece."""
    return np.maximum(np.min([Convex.of(piece.vertices).outside(points) for piece in pieces], axis=0), 0)


def test_a_convex_mesh_is_one_piece() -> None:
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.03)
    (piece,) = convex_pieces(np.asarray(ball.triangles))
    assert piece.is_watertight and len(piece.vertices) <= 2 * SETTINGS.max_corners
    assert piece.volume == pytest.approx(ball.volume, rel=0.15)


def test_a_ball_gets_a_flat_foot_to_stand_on() -> None:
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.03)
    (piece,) = convex_pieces(np.asarray(ball.triangles))
    foot = piece.vertices[piece.vertices[:, 2] < piece.bounds[0, 2] + 1e-6]
    assert len(foot) >= 3 and np.ptp(foot[:, :2], axis=0).min() > 0.004


@pytest.mark.slow
def test_the_pieces_of_a_cup_stand_on_one_level() -> None:
    heights = np.concatenate([piece.vertices[:, 2] for piece in convex_pieces(np.asarray(cup().triangles))])
    lowest = heights.min()
    assert np.count_nonzero(heights == lowest) >= 3
    assert not ((heights > lowest) & (heights < lowest + 0.001)).any()


def test_separate_convex_parts_are_a_piece_each() -> None:
    boxes = [trimesh.creation.box(extents=(0.02, 0.02, 0.02)) for _ in range(3)]
    for i, box in enumerate(boxes):
        box.apply_translation([0.05 * i, 0, 0])
    assert len(convex_pieces(np.concatenate([box.triangles for box in boxes]))) == 3


@pytest.mark.slow
def test_a_cup_stays_open_and_its_walls_are_covered() -> None:
    mesh = cup()
    pieces = convex_pieces(np.asarray(mesh.triangles))
    assert 1 < len(pieces) <= SETTINGS.max_pieces
    surface = trimesh.sample.sample_surface(mesh, 1000, seed=0)[0]
    assert np.percentile(outside(pieces, surface), 95) <= 0.003
    column = np.column_stack([np.zeros(30), np.zeros(30), np.linspace(-0.03, 0.1, 30)])
    assert (outside(pieces, column) > 0.005).all()


def test_pieces_stay_within_the_bounds_of_the_mesh() -> None:
    mesh = cup()
    points = np.concatenate([piece.vertices for piece in convex_pieces(np.asarray(mesh.triangles))])
    assert (points >= mesh.bounds[0] - 1e-6).all() and (points <= mesh.bounds[1] + 1e-6).all()


def test_a_flat_sheet_becomes_a_thin_solid() -> None:
    sheet = np.array([[[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0]], [[0, 0, 0], [0.1, 0.1, 0], [0, 0.1, 0]]])
    (piece,) = convex_pieces(sheet)
    assert piece.is_watertight and piece.volume > 0


def test_a_part_inside_another_needs_no_piece() -> None:
    outer, inner = trimesh.creation.box(extents=(0.05,) * 3), trimesh.creation.box(extents=(0.02,) * 3)
    assert len(convex_pieces(np.concatenate([outer.triangles, inner.triangles]))) == 1


def test_the_same_mesh_is_split_once(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    corners = np.asarray(cup().triangles)
    first = convex_pieces(corners)
    kept = set((cache / "hulls").glob("*.npz"))
    monkeypatch.setattr(hulls, "_decomposed", lambda corners: pytest.fail("split again"))
    again = convex_pieces(corners)
    assert [piece.vertices.tolist() for piece in first] == [piece.vertices.tolist() for piece in again]
    assert kept and set((cache / "hulls").glob("*.npz")) == kept


@pytest.mark.slow
def test_splitting_twice_gives_the_same_pieces() -> None:
    foot, back = (trimesh.creation.box(extents=size) for size in ((0.06, 0.03, 0.01), (0.01, 0.03, 0.06)))
    corners = np.asarray(trimesh.boolean.union([foot, back], engine="manifold").triangles)
    first, second = hulls._decomposed(corners), hulls._decomposed(corners)
    assert len(first) > 1
    assert [piece.tolist() for piece in first] == [piece.tolist() for piece in second]


def test_loose_triangles_are_covered_like_a_mesh() -> None:
    ring = trimesh.creation.annulus(r_min=0.03, r_max=0.04, height=0.02, sections=60)
    loose = np.asarray(ring.subdivide().triangles)
    shrunk = loose.mean(axis=1, keepdims=True) + 0.999 * (loose - loose.mean(axis=1, keepdims=True))
    pieces = convex_pieces(shrunk)
    assert len(pieces) <= SETTINGS.max_pieces
    assert np.percentile(outside(pieces, ring.sample(1000, seed=0)), 95) <= 0.003
    assert outside(pieces, np.zeros((1, 3)))[0] > 0.02
