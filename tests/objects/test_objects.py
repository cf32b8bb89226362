"""Every object of the library: shape, collision pieces, points, rest. One test per property names all that lack it."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.spatial import KDTree

from vcage.objects.asset import Asset
from vcage.objects.openings import Opening
from vcage.objects.points import check_points
from vcage.schema.asset import FunctionalPoint
from vcage.schema.base import Vec3

pytestmark = pytest.mark.slow

GRIPPER_OPENING = 0.07


def _failing(assets: Iterable[Asset], holds: Callable[[Asset], bool]) -> list[str]:
    """The assets without a given property."""
    return [f"{asset.name}/{asset.variant.id}" for asset in assets if not holds(asset)]


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


def test_bounds_stand_on_the_ground_and_are_centred(variants: list[Asset]) -> None:
    def centred(asset: Asset) -> bool:
        return abs(asset.bounds[0, 2]) <= 1e-6 and bool((np.abs(asset.bounds[:, :2].sum(axis=0)) <= 2e-6).all())

    assert _failing(variants, centred) == []


def test_the_picture_mesh_fills_the_bounds(variants: list[Asset]) -> None:
    assert _failing(variants, lambda asset: np.abs(_visual(asset).bounds - asset.bounds).max() <= 0.002) == []


def test_triangles_are_few(variants: list[Asset]) -> None:
    assert _failing(variants, lambda asset: len(_visual(asset).faces) <= 6000) == []


def test_pieces_cover_the_mesh_within_3_mm(kinds: list[Asset]) -> None:
    def covered(asset: Asset) -> bool:
        points = trimesh.sample.sample_surface(_visual(asset), 1500, seed=0)[0]
        return np.quantile(_distance_outside(asset, points), _share(asset)) <= 0.003

    assert _failing(kinds, covered) == []


def _outer_corners(asset: Asset) -> np.ndarray:
    """(n, 3) the corners of all pieces that do not lie within another piece."""
    corners = []
    for piece in asset.pieces:
        others = [other.outside(piece.vertices) for other in asset.pieces if other is not piece]
        corners.append(piece.vertices[np.min(others, axis=0) > -1e-4] if others else piece.vertices)
    return np.concatenate(corners)


def test_pieces_do_not_stand_out_of_the_mesh(kinds: list[Asset]) -> None:
    def within(asset: Asset) -> bool:
        mesh = _visual(asset)
        corners = _outer_corners(asset)
        surface = np.concatenate([mesh.vertices, trimesh.sample.sample_surface(mesh, 60000, seed=0)[0]])
        far = KDTree(surface).query(corners)[0] > 0.006
        if asset.annotation.source != "parametric":  # its surface is rarely closed, so nothing is inside of it
            return far.mean() <= 0.1
        return not far.any() or (mesh.is_watertight and bool(mesh.contains(corners[far]).all()))

    assert _failing(kinds, within) == []


def test_collision_files_are_convex_and_closed(kinds: list[Asset]) -> None:
    def convex(path: str) -> bool:
        mesh = trimesh.load_mesh(path)
        same = mesh.convex_hull.volume == pytest.approx(mesh.volume, rel=1e-3)
        return mesh.is_watertight and mesh.volume > 0 and len(mesh.vertices) < 255 and same

    def all_convex(asset: Asset) -> bool:
        return all(map(convex, [*asset.model.hulls, *(path for link in asset.model.links for path in link.hulls)]))

    assert _failing(kinds, all_convex) == []


def test_contact_points_can_be_grasped(variants: list[Asset]) -> None:
    def graspable(asset: Asset) -> bool:
        return all(0 < asset.grasp_width(contact) <= GRIPPER_OPENING for contact in asset.annotation.contact_points)

    assert _failing(variants, graspable) == []


def test_contact_points_leave_room_for_the_finger_tips(variants: list[Asset]) -> None:
    def roomy(asset: Asset) -> bool:
        return all(0.01 < contact.position[2] < asset.size[2] for contact in asset.annotation.contact_points)

    assert _failing(variants, roomy) == []


def test_points_lie_on_the_object(variants: list[Asset]) -> None:
    for asset in variants:
        check_points(asset, Path(asset.name) / "asset.json")


def test_closing_is_across_the_approach(kinds: list[Asset]) -> None:
    def across(asset: Asset) -> bool:
        return all(abs(np.dot(c.approach, c.closing)) < 1e-6 for c in asset.annotation.contact_points)

    assert _failing(kinds, across) == []


def test_functional_points_have_room(kinds: list[Asset]) -> None:
    def roomy(asset: Asset) -> bool:
        points = asset.annotation.functional_points
        return all(_has_room(asset.opening(point), point.position) for point in points)

    assert _failing(kinds, roomy) == []


def _has_room(opening: Opening, position: Vec3) -> bool:
    level = abs(opening.floor - position[2]) < 0.001
    return min(opening.size) >= 0.035 and level and np.abs(np.subtract(opening.centre, position[:2])).max() <= 0.003


def test_containers_are_open_from_above(kinds: list[Asset]) -> None:
    def free_above(asset: Asset, point: FunctionalPoint) -> bool:
        column = np.linspace(point.position[2] + 0.002, asset.size[2] + 0.05, 40)
        points = np.column_stack([np.tile(point.position[:2], (40, 1)), column])
        own = asset.pieces_of(point.link)  # drawers are pulled out and lids open
        return bool((np.min([piece.outside(points) for piece in own], axis=0) > 0).all())

    def open_above(asset: Asset) -> bool:
        containers = [p for p in asset.annotation.functional_points if p.holds == "in" and not p.sideways]
        return all(free_above(asset, point) for point in containers)

    assert _failing(kinds, open_above) == []


def _drift(asset: Asset, seconds: float = 1.0) -> tuple[float, float]:
    """Metres and degrees that an object moves on a flat ground."""
    sapien = pytest.importorskip("sapien")
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    scene.set_timestep(1 / 250)
    material = sapien.physx.PhysxMaterial(asset.model.friction, asset.model.friction, 0.0)
    ground = scene.create_actor_builder()
    ground.add_box_collision(half_size=[1, 1, 0.1], pose=sapien.Pose([0, 0, -0.1]), material=material)
    ground.build_static()
    builder = scene.create_actor_builder()
    for path in asset.model.hulls:
        builder.add_convex_collision_from_file(path, material=material, density=asset.model.mass / asset.volume)
    entity = builder.build()
    for _ in range(round(seconds * 250)):
        scene.step()
    pose = entity.pose
    return float(np.linalg.norm(pose.p)), float(np.degrees(2 * np.arccos(min(1.0, abs(pose.q[0])))))


def test_objects_put_down_upright_stay_in_place_but_for_balls(kinds: list[Asset]) -> None:
    def stays(asset: Asset) -> bool:
        moved, turned = _drift(asset)
        return moved < 0.002 and turned < 2.0

    assert _failing((asset for asset in kinds if not asset.annotation.loose), stays) == []
