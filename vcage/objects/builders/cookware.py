"""Cookware: pots, pans and kettles of metal and enamel."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import lumps, pieces, solids
from vcage.objects.builders.mappings import from_above, tiled
from vcage.objects.builders.parts import BuiltObject, Part, paint, variant_rng
from vcage.objects.textures import kitchen, materials


def pot(variant: str) -> BuiltObject:
    """An open cooking pot, 0.15 m across and 0.08 m high, with a lug on the left and on the right."""
    rng = variant_rng("pot", variant)
    radius, height, wall, floor = 0.075, 0.08, 0.004, 0.006
    profile = [(0, 0), (radius - 0.007, 0), (radius - 0.002, 0.002), (radius, 0.007), (radius, height - 0.005)]
    profile += [(radius + 0.0022, height - 0.0035), (radius + 0.003, height - 0.0015), (radius + 0.0015, height)]
    profile += [(radius - wall, height), (radius - wall, floor + 0.004), (radius - wall - 0.004, floor), (0, floor)]
    outside, inside = solids.split_by_facing(solids.revolved(profile, 56))
    hulls = [pieces.stack([(radius - 0.007, 0), (radius - 0.002, 0.002), (radius - 0.001, floor)])]
    hulls += pieces.ring([(radius - wall, floor), (radius, floor), (radius + 0.0025, height), (radius - wall, height)])
    coat = {"red": (176, 36, 34), "blue": (40, 78, 128)}.get(variant)
    if coat is None:
        parts = [
            _steel(outside, rng),
            paint(inside, kitchen.steel_bowl(rng), from_above(), roughness=0.3, metallic=0.5),
        ]
    else:
        white = kitchen.enamel(rng, (238, 236, 228), chips=False)
        parts = [
            paint(outside, kitchen.enamel(rng, coat), tiled(0.12), roughness=0.22),
            paint(inside, white, tiled(0.12), roughness=0.25),
        ]
    path = _lug_path(radius - 0.0065, 0.061)
    section = solids.circle(1.0, 12) * (0.0052, 0.0045)
    for side in (-1, 1):
        lug = solids.moved(solids.sweep(path, section), turn=0 if side > 0 else 180)
        parts.append(_steel(lug, rng) if coat is None else _dark(lug, rng))
        corners = np.array([(0.0052, 0.0045), (-0.0052, 0.0045), (-0.0052, -0.0045), (0.0052, -0.0045)])
        turned = path * (side, side, 1)
        hulls += pieces.chain(_rings(turned[[0, 1, 3, 6, 9, 11, 14, 17, 19, 20]], corners, up=(0, 0, 1)))
    return BuiltObject(parts, hulls, mass=0.5, friction=0.6)


def frying_pan(variant: str) -> BuiltObject:
    """A frying pan of 0.176 m with a long raised handle to the right."""
    rng = variant_rng("frying_pan", variant)
    top, foot, height, floor = 0.088, 0.068, 0.04, 0.0055
    outer = [(0, 0), (foot - 0.002, 0), (foot, 0.001), (top - 0.001, height - 0.002), (top, height - 0.001)]
    outer += [(top - 0.001, height), (top - 0.0035, height), (foot + 0.0005, floor + 0.004)]
    outer += [(foot - 0.0025, floor + 0.001), (foot - 0.006, floor), (0, floor)]
    outside, inside = solids.split_by_facing(solids.revolved(outer, 56))
    colour = {"black": (44, 44, 46), "copper": (186, 104, 62), "green": (58, 104, 84)}[variant]
    shell = materials.brushed(rng, colour)
    coat = kitchen.nonstick(rng, (58, 58, 60) if variant != "copper" else (196, 190, 182))
    parts = [
        paint(outside, shell, tiled(0.1), roughness=0.4, metallic=0.2),
        paint(inside, coat, from_above(), roughness=0.45),
    ]
    hulls = [pieces.stack([(foot - 0.002, 0), (foot, 0.001), (foot + 0.002, floor)])]
    hulls += pieces.ring([(foot - 0.0005, floor), (foot + 0.001, 0.002), (top, height - 0.001), (top - 0.0035, height)])
    x = np.array([0.083, 0.092, 0.105, 0.125, 0.16, 0.2, 0.222, 0.229])
    z = np.array([0.031, 0.0345, 0.039, 0.0425, 0.046, 0.0475, 0.047, 0.0465])
    width = np.array([0.62, 0.62, 0.8, 0.92, 1.0, 1.08, 0.95, 0.55])
    path = np.stack([x, np.zeros(8), z], axis=1)
    section = solids.circle(1.0, 20) * (0.0125, 0.0105)
    handle = solids.sweep(path, section, np.stack([width, np.interp(x, [0.083, 0.1, 0.22], [0.7, 1, 0.8])], axis=1))
    hanger = solids.prism(solids.circle(0.0045, 16, (0.213, 0)), 0.2)
    if variant == "copper":
        parts.append(_steel(solids.cut(handle, hanger), rng))
    else:
        parts.append(_dark(solids.cut(handle, hanger), rng))
    bracket = solids.rounded_box((0.016, 0.026, 0.014), 0.003, (0.0875, 0, 0.0245))
    parts.append(_steel(bracket, rng))
    for y in (-0.009, 0.009):
        parts.append(_steel(solids.ellipsoid((0.003, 0.0032, 0.0032), (0.0805, y, 0.0305), 10), rng))
    rings = np.asarray(handle.vertices)[: 8 * 20].reshape(8, 20, 3)
    hulls += pieces.chain(list(rings[[0, 2, 4, 6, 7]][:, ::2]))
    hulls.append(bracket.convex_hull)
    return BuiltObject(parts, hulls, mass=0.34, friction=0.7)


def kettle(variant: str) -> BuiltObject:
    """A stove kettle with a fixed handle across the top and its spout to the right."""
    rng = variant_rng("kettle", variant)
    knots = [(0.058, 0), (0.067, 0.006), (0.07, 0.02), (0.068, 0.045), (0.058, 0.072), (0.046, 0.087), (0.038, 0.0925)]
    shape = lumps.smooth(knots, 18)
    body = solids.revolved(np.concatenate([[(0, 0)], shape, [(0, 0.0925)]]), 48)
    lid = [(0, 0.091), (0.037, 0.091), (0.037, 0.0935), (0.03, 0.098), (0.016, 0.1015), (0, 0.1025)]
    lid_hull = pieces.stack([(0.037, 0.0915), (0.037, 0.0935), (0.03, 0.098), (0.016, 0.1015)])
    knob = np.concatenate(
        [[(0, 0.1), (0.006, 0.1), (0.005, 0.106)], solids.arc((0, 0.112), (0.0105, 0.007), -40, 90, 8)]
    )
    spout_path = np.array([(0.05, 0, 0.036), (0.066, 0, 0.046), (0.08, 0, 0.06), (0.092, 0, 0.078), (0.103, 0, 0.088)])
    spout = solids.sweep(spout_path, solids.circle(0.0165, 20), [1.15, 1, 0.78, 0.62, 0.6], up=(0, 1, 0))
    mouth = solids.sweep(
        spout_path[-2:] + (spout_path[-1] - spout_path[-2]) * 0.6, solids.circle(0.0078, 16), up=(0, 1, 0)
    )
    arch = _arch()
    strap = _strap(arch, 0.0024, 0.0065)
    grip = solids.moved(solids.rounded_box((0.02, 0.02, 0.078), 0.008), (-0.039, 0, 0.163), turn=90, axis=(0, 1, 0))
    coat = {"red": (178, 32, 34), "mint": (150, 200, 182)}.get(variant)
    if coat is None:
        parts = [_steel(body, rng), _steel(solids.revolved(lid, 40), rng), _steel(solids.cut(spout, mouth), rng)]
    else:
        glaze = kitchen.enamel(rng, coat)
        shells = (body, solids.revolved(lid, 40), solids.cut(spout, mouth))
        parts = [paint(shell, glaze, tiled(0.12), roughness=0.2) for shell in shells]
    parts += [_dark(solids.revolved(knob, 24), rng), _steel(strap, rng)]
    parts.append(
        _dark(grip, rng) if variant != "mint" else paint(grip, materials.wood(rng), tiled(0.06), roughness=0.6)
    )
    hulls = [pieces.stack([(0.058, 0), *[tuple(p) for p in shape[2::3]], (0.038, 0.0925)]), lid_hull]
    hulls += [pieces.stack([(0.006, 0.1), (0.0105, 0.112), (0.006, 0.118)])]
    rings = np.asarray(spout.vertices)[: 5 * 20].reshape(5, 20, 3)
    hulls += pieces.chain(list(rings[:, ::2]))
    corners = np.array([(0.0024, 0.0065), (-0.0024, 0.0065), (-0.0024, -0.0065), (0.0024, -0.0065)])
    hulls += pieces.chain(_rings(arch[[0, 2, 5, 8, -9, -6, -3, -1]], corners, up=(0, 1, 0)))
    hulls.append(grip.convex_hull)
    return BuiltObject(parts, hulls, mass=0.45, friction=0.7)


def _lug_path(start: float, z: float) -> np.ndarray:
    """(21, 3) a loop from the wall to the right and back, 0.05 m wide between its middle lines."""
    half, reach, bend = 0.0248, 0.034, 0.014
    corner = solids.arc((start + reach - bend, half - bend), bend, 90, 0, 9)
    back = np.concatenate([[(start, half)], corner])
    front = back[::-1] * (1, -1)
    flat = np.concatenate([back, [(start + reach, 0)], front])[::-1]
    return np.column_stack([flat, np.full(len(flat), z)])


def _arch() -> np.ndarray:
    """(n, 3) a kettle's handle in the xz plane from the left shoulder over the top to the right one."""
    right = np.concatenate([[(0.053, 0.074)], [(0.058, 0.105)], solids.arc((0.04, 0.141), (0.021, 0.022), -5, 90, 7)])
    left = right[::-1] * (-1, 1)
    flat = np.concatenate([right, [(0.0, 0.163)], left])[::-1]
    return np.column_stack([flat[:, 0], np.zeros(len(flat)), flat[:, 1]])


def _strap(path: np.ndarray, thickness: float, half_width: float) -> solids.Solid:
    """A flat strip along a path in the xz plane; half its thickness and half its width (along y) are given."""
    section = np.array(
        [(-thickness, -half_width), (thickness, -half_width), (thickness, half_width), (-thickness, half_width)]
    )
    return solids.sweep(path, section, up=(0, 1, 0))


def _rings(path: np.ndarray, section: np.ndarray, up: tuple[float, float, float]) -> list[np.ndarray]:
    """Sections (k, 3) at the points of a path: first coordinate to the side, second along ``up``."""
    forward = np.gradient(path, axis=0)
    forward /= np.linalg.norm(forward, axis=1, keepdims=True)
    side = np.cross(forward, up)
    return list(
        path[:, None] + section[None, :, :1] * side[:, None] + section[None, :, 1:] * np.asarray(up, dtype=float)
    )


def _steel(solid: solids.Solid, rng: np.random.Generator) -> Part:
    return paint(solid, kitchen.steel(rng), tiled(0.08), roughness=0.28, metallic=0.5)


def _dark(solid: solids.Solid, rng: np.random.Generator) -> Part:
    return paint(solid, materials.plastic(rng, (38, 37, 38)), tiled(0.06), roughness=0.5)


BUILDERS = {"frying_pan": frying_pan, "kettle": kettle, "pot": pot}
