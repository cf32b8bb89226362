"""Check 1: the visual mesh is light, the hulls cover it, containers stay open, volume and mass are plausible."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh

from vcage.base.errors import DamagedFile
from vcage.objects.asset import Asset
from vcage.objects.convex import Convex
from vcage.schema.proof import ProofCheck


@dataclass(frozen=True)
class MeshLimits:
    """Limits of a model's meshes.

    Args:
        max_faces: of all meshes together.
        samples: points drawn from the surface of each part.
        max_uncovered_m: distance from the hulls of 95 % of the surface.
        max_overhang_m: of the hulls beyond the mesh's bounding box.
        density_range_kg_m3: of mass to hull volume, from foam and hollow things to steel.
        min_depth_m: of the room inside a container.
        min_width_m: of the room inside a container.
    """

    max_faces: int = 6000
    samples: int = 3000
    max_uncovered_m: float = 0.003
    max_overhang_m: float = 0.004
    density_range_kg_m3: tuple[float, float] = (8.0, 9000.0)
    min_depth_m: float = 0.008
    min_width_m: float = 0.02


LIMITS = MeshLimits()


def check_mesh(asset: Asset, seed: int) -> ProofCheck:
    """Measure the meshes of an asset."""
    meshes = {None: _load(asset.model.visual), **{link.name: _load(link.visual) for link in asset.model.links}}
    faces = sum(len(mesh.faces) for mesh in meshes.values())
    cover = max(_cover(mesh, asset.pieces_of(link), seed) for link, mesh in meshes.items())
    overhang = max(_overhang(mesh, asset.pieces_of(link)) for link, mesh in meshes.items())
    density = asset.model.total_mass / asset.volume
    reasons = []
    if faces > LIMITS.max_faces:
        reasons.append(f"{faces} faces, at most {LIMITS.max_faces}")
    if cover > LIMITS.max_uncovered_m:
        reasons.append(f"5 % of the surface lie more than {1000 * cover:.1f} mm outside the hulls")
    if overhang > LIMITS.max_overhang_m:
        reasons.append(f"the hulls reach {1000 * overhang:.1f} mm beyond the mesh")
    if not LIMITS.density_range_kg_m3[0] <= density <= LIMITS.density_range_kg_m3[1]:
        reasons.append(f"{asset.model.total_mass:.3g} kg in {1e6 * asset.volume:.0f} cm³ is {density:.0f} kg/m³")
    reasons += _closed_containers(asset, meshes)
    measured = {"faces": faces, "cover_mm": 1000 * cover, "density": density, "mass_kg": asset.model.total_mass}
    measured |= {"hulls": len(asset.pieces), "volume_cm3": 1e6 * asset.volume}
    return ProofCheck(
        check="mesh",
        passed=not reasons,
        succeeded=int(not reasons),
        measured={name: round(float(value), 4) for name, value in measured.items()},
        reasons=reasons,
    )


def _load(path: str) -> trimesh.Trimesh:
    try:
        return trimesh.load_mesh(Path(path), process=False)
    except Exception as error:  # trimesh raises whatever the parser of the format raises
        raise DamagedFile(
            f"{path} is not a mesh that can be read: {error}",
            hint="delete the folder it lies in: it is made again on demand",
        ) from error


def _cover(mesh: trimesh.Trimesh, pieces: list[Convex], seed: int) -> float:
    """95th percentile of the distance from the surface to the hulls, metres."""
    points, _ = trimesh.sample.sample_surface(mesh, LIMITS.samples, seed=seed)
    outside = np.min([piece.outside(points) for piece in pieces], axis=0)
    return float(np.percentile(np.maximum(outside, 0), 95))


def _overhang(mesh: trimesh.Trimesh, pieces: list[Convex]) -> float:
    vertices = np.concatenate([piece.vertices for piece in pieces])
    beyond = np.maximum(mesh.bounds[0] - vertices.min(axis=0), vertices.max(axis=0) - mesh.bounds[1])
    return float(beyond.max())


def _closed_containers(asset: Asset, meshes: dict[str | None, trimesh.Trimesh]) -> list[str]:
    """Return the faults of containers: filled by hulls, or covered by the mesh."""
    reasons = []
    for point in asset.annotation.functional_points:
        try:
            opening = asset.opening(point)
        except ValueError as error:
            reasons.append(f"functional point {point.id} {point.name!r}: {error}")
            continue
        if point.holds == "in" and (opening.depth < LIMITS.min_depth_m or min(opening.size) < LIMITS.min_width_m):
            room = f"{100 * min(opening.size):.1f} cm of width and {100 * opening.depth:.1f} cm of depth"
            reasons.append(f"functional point {point.id} {point.name!r}: the hulls leave {room}")
        start = np.asarray(point.position) + 0.004 * np.asarray(point.axis) + [0.0, 0.0, 0.01 * point.sideways]
        if _ray_meets(meshes[point.link], start, np.asarray(point.axis)):
            reasons.append(f"functional point {point.id} {point.name!r}: the mesh covers it")
    return reasons


def _ray_meets(mesh: trimesh.Trimesh, origin: np.ndarray, direction: np.ndarray) -> bool:
    """True if a ray meets any triangle (Möller and Trumbore, 1997)."""
    corners = np.asarray(mesh.triangles)  # (m, 3, 3)
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(direction, second)
    determinant = np.einsum("ij,ij->i", first, across)
    facing = np.abs(determinant) > 1e-14
    inverse = 1 / np.where(facing, determinant, 1.0)
    offset = origin - corners[:, 0]
    u = np.einsum("ij,ij->i", offset, across) * inverse
    around = np.cross(offset, first)
    v = around @ direction * inverse
    distance = np.einsum("ij,ij->i", second, around) * inverse
    return bool(np.any(facing & (u >= 0) & (v >= 0) & (u + v <= 1) & (distance > 0)))
