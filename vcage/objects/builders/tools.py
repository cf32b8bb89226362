"""Hand tools and small hardware that lie in a drawer."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import pieces, shells, solids
from vcage.objects.builders.mappings import around, from_front, tiled
from vcage.objects.builders.parts import BuiltObject, Mapping, paint, variant_rng
from vcage.objects.textures import materials, packaging, prints


def screwdriver(variant: str) -> BuiltObject:
    """A screwdriver along x, blade to the left; its handle has six sides and lies flat."""
    rng = variant_rng("screwdriver", variant)
    grip, collar = {
        "red": ((206, 32, 36), (36, 36, 40)),
        "yellow": ((246, 190, 24), (36, 36, 40)),
        "blue": ((28, 92, 180), (240, 200, 40)),
    }[variant]
    angle = np.arange(42) * 2 * np.pi / 42
    flutes = (1 - 0.075 * (0.5 + 0.5 * np.cos(6 * angle)) ** 2)[:, None]
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1) * flutes
    low = -float(ring[:, 1].min())
    ring[:, 1] = np.maximum(ring[:, 1], -0.88 * low)
    radius, axis = 0.0155, 0.0155 * 0.88 * low
    stations = [(0.0, 0.62), (0.004, 0.8), (0.014, 0.82), (0.024, 1.0), (0.086, 1.0), (0.096, 0.94), (0.1, 0.72)]
    rings = [np.column_stack([np.full(42, x), ring * radius * s + (0, axis)]) for x, s in stations]
    handle = solids.closed_rings(rings)
    shaft = shells.rod(0.0034, -0.078, 0.002, axis, 20)
    blade = pieces.hull(
        [(-0.098, y, axis + z) for y in (-0.0038, 0.0038) for z in (-0.0007, 0.0007)],
        [(-0.086, y, axis + z) for y in (-0.0042, 0.0042) for z in (-0.0015, 0.0015)],
        [(-0.0765, y, axis + z) for y in (-0.003, 0.003) for z in (-0.003, 0.003)],
    )
    stripes = np.tile(np.asarray(grip, dtype=np.uint8), (64, 256, 1))
    picture = packaging.striped([grip, grip, collar], 18)
    picture = np.concatenate([stripes[:14], np.repeat(picture, 2, axis=0)[:40], stripes[:10]])
    cuff = shells.rod(0.0105, -0.001, 0.006, axis, 24)
    parts = [
        paint(handle, picture, around(0, (0.0, axis)), roughness=0.35, crease=25),
        paint(cuff, materials.plastic(rng, collar), tiled(0.05), roughness=0.5),
        paint(solids.union(shaft, blade), materials.brushed(rng), tiled(0.05), roughness=0.25, metallic=0.5),
    ]
    hulls = [
        pieces.hull(*rings[3:]),
        pieces.hull(*rings[:4]),
        pieces.hull(shaft.vertices[::2]),
        blade,
    ]
    return BuiltObject(parts, hulls, mass=0.11, friction=0.7)


def tape_measure(variant: str) -> BuiltObject:
    """A tape measure that stands upright, the hook of its tape at the left foot."""
    rng = variant_rng("tape_measure", variant)
    case, rubber = {"yellow": ((248, 198, 24), (40, 40, 44)), "red": ((200, 36, 40), (52, 54, 58))}[variant]
    wide, tall, thick = 0.07, 0.064, 0.036
    corner = solids.arc((wide / 2 - 0.03, tall - 0.03), 0.03, 0, 90, 9)
    foot = solids.arc((wide / 2 - 0.006, 0.006), 0.006, -90, 0, 4)
    nose = [(-wide / 2 + 0.02, tall), (-wide / 2 + 0.008, tall - 0.006), (-wide / 2, tall - 0.02), (-wide / 2, 0.0)]
    outline = np.concatenate([foot, corner, nose])  # x, z; counter-clockwise
    shell = shells.along_y(outline[::-1, ::-1], thick)
    wrapped = np.maximum((outline - (0, tall / 2)) * 1.014 + (0, tall / 2), (-1.0, 0.0))
    band = shells.along_y(wrapped[::-1, ::-1], 0.4 * thick)
    face = prints.disc(prints.canvas(320, 292, rubber), (0.52, 0.46), 0.4, case)
    face = prints.disc(face, (0.52, 0.46), 0.27, (246, 246, 240))
    face = prints.disc(face, (0.52, 0.46), 0.25, case)
    face = packaging.fitted(face, "5 m", (0.52, 0.44), (0.34, 0.16), rubber)
    face = packaging.fitted(face, "GAUGER", (0.52, 0.58), (0.3, 0.06), rubber)
    flat = np.abs(shell.face_normals[:, 1]) > 0.9
    sides, rim = shell.copy(), shell.copy()
    sides.update_faces(flat)
    rim.update_faces(~flat)
    mouth = solids.box((0.006, 0.02, 0.007), (-wide / 2 - 0.0025, 0, 0.003))
    blade = solids.box((0.014, 0.019, 0.0012), (-wide / 2 - 0.008, 0, 0.005))
    hook = solids.box((0.0015, 0.019, 0.0075), (-wide / 2 - 0.0155, 0, 0.0))
    button = solids.rounded_box((0.012, 0.014, 0.006), 0.002, (-0.018, 0, tall - 0.005))
    ticks = packaging.striped([(248, 214, 60), (30, 30, 32)], 20)
    parts = [
        paint(sides, face, _both_sides(), roughness=0.5),
        paint(rim, materials.plastic(rng, rubber), tiled(0.05), roughness=0.7, crease=25),
        paint(band, materials.plastic(rng, case), tiled(0.05), roughness=0.4, crease=25),
        paint(mouth, materials.plastic(rng, (28, 28, 30)), tiled(0.05), roughness=0.6),
        paint(blade, ticks, tiled(0.02), roughness=0.4),
        paint(hook, materials.brushed(rng), tiled(0.05), roughness=0.3, metallic=0.5),
        paint(button, materials.plastic(rng, (214, 40, 36)), tiled(0.05), roughness=0.5),
    ]
    return BuiltObject(parts, [shell.convex_hull, mouth, blade, hook, button.convex_hull], mass=0.2, friction=0.7)


def _both_sides() -> Mapping:
    """The picture as seen from the front, on the back as seen from there."""

    def mapping(corners: np.ndarray, normals: np.ndarray) -> np.ndarray:
        flat = corners[..., [0, 2]]
        low, high = flat.reshape(-1, 2).min(axis=0), flat.reshape(-1, 2).max(axis=0)
        uv = (flat - low) / (high - low)
        back = normals[:, 1] > 0
        uv[back, :, 0] = 1 - uv[back, :, 0]
        return uv

    return mapping


def padlock(variant: str) -> BuiltObject:
    """A padlock that stands on its keyhole side, bow up."""
    rng = variant_rng("padlock", variant)
    metal = {"brass": (206, 164, 76), "black": (52, 54, 58), "blue": (34, 84, 160)}[variant]
    wide, thick, tall, top = 0.048, 0.026, 0.042, 0.074
    body = solids.rounded_box((wide, thick, tall), 0.004, steps=3)
    bend = np.radians(np.linspace(0, 180, 13))
    reach, pipe = 0.0145, 0.0042
    crown = top - reach - pipe
    legs = [(reach, 0, tall - 0.002), (reach, 0, crown - 0.001)]
    path = np.array([*legs, *[(reach * np.cos(t), 0, crown + reach * np.sin(t)) for t in bend[1:-1]]])
    path = np.concatenate([path, path[1::-1] * (-1, 1, 1)])
    bow = solids.sweep(path, solids.circle(pipe, 14), up=(0, 1, 0))
    picture = materials.brushed(rng, metal, 256)
    ink = tuple(int(0.38 * c) for c in metal) if variant == "brass" else (226, 226, 222)
    edge = [(0.08, 0.1), (0.92, 0.1), (0.92, 0.9), (0.08, 0.9)]
    picture = packaging.stroke(picture, edge, 0.014, ink, closed=True)
    picture = packaging.fitted(picture, "BASTION", (0.5, 0.36), (0.64, 0.2), ink)
    picture = packaging.fitted(picture, "50 mm", (0.5, 0.56), (0.3, 0.1), ink)
    picture = prints.disc(picture, (0.5, 0.74), 0.06, (24, 24, 26))
    picture = prints.rectangle(picture, (0.485, 0.72), (0.515, 0.86), (24, 24, 26))
    parts = [
        paint(body, picture, from_front(), roughness=0.3, metallic=0.4),
        paint(bow, materials.brushed(rng), tiled(0.05), roughness=0.2, metallic=0.5),
    ]
    rings = bow.vertices[:-2].reshape(len(path), 14, 3)
    hulls = [body.convex_hull, *pieces.chain([rings[i] for i in range(0, len(path), 2)])]
    if len(path) % 2 == 0:
        hulls.append(pieces.hull(rings[-2], rings[-1]))
    return BuiltObject(parts, hulls, mass=0.28, friction=0.6)


BUILDERS = {"padlock": padlock, "screwdriver": screwdriver, "tape_measure": tape_measure}
