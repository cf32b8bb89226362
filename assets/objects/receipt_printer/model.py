"""A narrow counter printer with a printed receipt that curls out of its top to the front."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from assets.textures import till_faces
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import six_sides, tiled
from vcage.objects.modelling.parts import BuiltObject, Mapping, paint, variant_rng

COLOURS = {"black": (52, 54, 58), "white": (230, 230, 226)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("receipt_printer", variant)
    colour = COLOURS[variant]
    width, depth, height, paper = 0.112, 0.062, 0.08, 0.048
    body = solids.rounded_box((width, depth, height), 0.006)
    lid = solids.rounded_box((width - 0.012, 0.032, 0.005), 0.002, (0, 0.0125, height - 0.002))
    mouth = solids.box((paper + 0.008, 0.008, 0.0014), (0, -0.0095, height - 0.0004))
    front = prints.canvas(384, 256, colour)
    ink = (236, 236, 232) if variant == "black" else (60, 64, 70)
    front = prints.text(front, "PRINTIX", (0.36, 0.78), 0.09, ink)
    front = prints.rectangle(front, (0.04, 0.3), (0.96, 0.32), tuple(int(0.6 * c) for c in colour))
    for x, light in ((0.7, (80, 220, 110)), (0.78, (240, 170, 50)), (0.9, (60, 130, 220))):
        front = prints.disc(front, (x, 0.78), 0.022 if x < 0.85 else 0.045, light)
    curl = np.concatenate(
        [solids.arc((-0.0275, height + 0.001), 0.018, 0, 160, 9), [(-0.0462, 0.07), (-0.0455, 0.056)]]
    )
    strip, sections = _strip(curl, paper, 0.0012)
    parts = [
        paint(body, prints.atlas({"front": front}, colour, (384, 256)), six_sides(), roughness=0.5),
        paint(lid, materials.plastic(rng, tuple(int(0.85 * c) for c in colour)), tiled(0.05), roughness=0.5),
        paint(mouth, materials.plastic(rng, (20, 20, 22)), tiled(0.05), roughness=0.6),
        paint(strip, till_faces.receipt((256, 352), rows=8), _down(curl), roughness=0.9),
    ]
    return BuiltObject(parts, [body.convex_hull, lid.convex_hull, *pieces.chain(sections)], mass=0.35, friction=0.7)


def _strip(curve: np.ndarray, width: float, thickness: float) -> tuple[solids.Solid, list[np.ndarray]]:
    """A band along x over a curve (n, 2) of y and z; the solid, and its sections (4, 3) along the curve."""
    forward = np.gradient(curve, axis=0)
    forward /= np.linalg.norm(forward, axis=1, keepdims=True)
    offset = np.stack([forward[:, 1], -forward[:, 0]], axis=1) * thickness / 2
    sections = [
        np.array([(-width / 2, *a), (width / 2, *a), (width / 2, *b), (-width / 2, *b)])
        for a, b in zip(curve - offset, curve + offset, strict=True)
    ]
    return solids.closed_rings(sections), sections


def _down(curve: np.ndarray) -> Mapping:
    """The picture hangs over a curve (n, 2) of y and z, its upper edge at the start; columns along x."""

    def mapping(corners: np.ndarray, _normals: np.ndarray) -> np.ndarray:
        x = corners[..., 0]
        nearest = KDTree(curve).query(corners[..., 1:])[1]
        return np.stack([(x - x.min()) / np.ptp(x), 1 - nearest / (len(curve) - 1)], axis=-1)

    return mapping
