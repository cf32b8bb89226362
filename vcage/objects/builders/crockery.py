"""Crockery: round things of ceramic or plastic, and a spoon."""

from __future__ import annotations

import itertools

import numpy as np

from vcage.objects.builders import pieces, solids
from vcage.objects.builders.mappings import around, from_above, tiled
from vcage.objects.builders.parts import BuiltObject, paint, variant_rng
from vcage.objects.textures import materials, prints

GLAZES = {"white": (240, 238, 232), "blue": (62, 104, 160), "red": (178, 48, 44), "green": (112, 150, 116)}


def plate(variant: str) -> BuiltObject:
    """A coupe plate, 0.21 m across, flat over 0.18 m, with a steep rim that fingers can close on."""
    rng = variant_rng("plate", variant)
    profile = [(0, 0), (0.078, 0), (0.082, 0.0015), (0.094, 0.003), (0.0995, 0.0075), (0.1045, 0.026), (0.1035, 0.0272)]
    profile += [(0.1005, 0.0268), (0.0955, 0.0095), (0.0915, 0.0066), (0, 0.006)]
    dish = solids.revolved(profile, 56)
    glaze = materials.plastic(rng, GLAZES[variant], 256)
    line = (58, 92, 148) if variant == "white" else (226, 226, 218)
    glaze = prints.disc(prints.disc(glaze, (0.5, 0.5), 0.445, line), (0.5, 0.5), 0.425, GLAZES[variant])
    hulls = [pieces.stack([(0.079, 0), (0.0935, 0.0028), (0.0935, 0.0066)])]
    hulls += pieces.ring([(0.0915, 0.0064), (0.0935, 0.003), (0.0995, 0.0075), (0.0955, 0.0095)])
    hulls += pieces.ring([(0.0955, 0.0095), (0.0995, 0.0075), (0.1045, 0.026), (0.1035, 0.0272), (0.1005, 0.0268)])
    return BuiltObject([paint(dish, glaze, from_above(), roughness=0.25)], hulls, mass=0.45, friction=0.6)


def bowl(variant: str) -> BuiltObject:
    """A cereal bowl, 0.15 m across, whose wall stands almost upright where fingers close on it."""
    rng = variant_rng("bowl", variant)
    outer = np.concatenate([solids.arc((0, 0.036), (0.072, 0.032), -62, 0, 9), [(0.0745, 0.058)]])
    inner = np.concatenate([[(0.0695, 0.058)], solids.arc((0, 0.038), (0.067, 0.029), 0, -80, 11)])
    profile = np.concatenate([[(0, 0), (0.034, 0), (0.036, 0.004)], outer, [(0.072, 0.0595)], inner, [(0, 0.009)]])
    body = solids.revolved(profile, 48)
    colour = GLAZES[variant]
    glaze = materials.speckled(rng, colour, tuple(int(0.55 * c) for c in colour), 0.04)
    hulls = [pieces.stack([(0.034, 0), (0.042, 0.0095)])]
    levels = [0.0088, 0.0145, 0.022, 0.037, 0.0592]
    for low, high in itertools.pairwise(levels):
        quad = [(_radius_at(inner, z), z) for z in (low, high)] + [(_radius_at(outer, z), z) for z in (low, high)]
        hulls += pieces.ring(quad)
    return BuiltObject([paint(body, glaze, tiled(0.1), roughness=0.3)], hulls, mass=0.26, friction=0.6)


def _radius_at(curve: np.ndarray, z: float) -> float:
    """Radius of a profile's curve (n, 2) at a height."""
    rising = curve[np.argsort(curve[:, 1])]
    return float(np.interp(z, rising[:, 1], rising[:, 0]))


def mug(variant: str) -> BuiltObject:
    """A mug of 0.068 m across with the handle to the right."""
    rng = variant_rng("mug", variant)
    radius, height, wall, floor = 0.034, 0.086, 0.0035, 0.006
    profile = [(0, 0), (radius - 0.003, 0), (radius, 0.003), (radius, height - 0.001), (radius - 0.001, height)]
    profile += [(radius - wall + 0.001, height), (radius - wall, height - 0.001), (radius - wall, floor + 0.004)]
    profile += [(radius - wall - 0.004, floor), (0, floor)]
    bend = np.radians(np.linspace(100, -100, 17))
    centre, reach = np.array([radius + 0.001, 0, 0.045]), np.array([0.024, 0, 0.025])
    path = centre + np.stack([np.cos(bend), np.zeros(17), np.sin(bend)], axis=1) * reach
    path[:, 0] = np.maximum(path[:, 0], radius - wall / 2)
    section = solids.circle(1.0, 14) * (0.0042, 0.006)
    handle = solids.sweep(path, section, up=(0, 1, 0))
    body = solids.union(
        solids.revolved(profile, 44),
        solids.cut(
            handle,
            solids.moved(solids.revolved([(0, 0), (radius - wall / 2, 0), (radius - wall / 2, 0.2), (0, 0.2)], 44)),
        ),
    )
    glaze = materials.speckled(rng, GLAZES[variant], tuple(int(0.7 * c) for c in GLAZES[variant]), 0.015)
    hulls = [pieces.stack([(radius - 0.003, 0), (radius, 0.003), (radius, floor)])]
    hulls += pieces.ring([(radius - wall, floor), (radius, floor), (radius, height), (radius - wall, height)])
    box_section = np.array([(0.0042, 0.006), (-0.0042, 0.006), (-0.0042, -0.006), (0.0042, -0.006)])
    hulls += _handle_pieces(path[::2], box_section)
    return BuiltObject([paint(body, glaze, tiled(0.1), roughness=0.3)], hulls, mass=0.3, friction=0.6)


def _handle_pieces(path: np.ndarray, section: np.ndarray) -> list[pieces.Piece]:
    """Convex pieces of a handle in the xz plane; the section's second coordinate lies along y."""
    forward = np.gradient(path, axis=0)
    forward /= np.linalg.norm(forward, axis=1, keepdims=True)
    side = np.cross(forward, (0, 1, 0))
    rings = path[:, None] + section[None, :, :1] * side[:, None] + section[None, :, 1:] * np.array([0, 1.0, 0])
    return pieces.chain(list(rings))


def cup(variant: str) -> BuiltObject:
    """A paper cup without a lid, wider at the top."""
    rng = variant_rng("cup", variant)
    colour = {"white": (242, 240, 236), "teal": (48, 140, 146)}[variant]
    height, wall, floor = 0.085, 0.002, 0.005
    low, high = 0.026, 0.0345
    profile = [(0, 0), (low, 0), (high - 0.0012, height - 0.005), (high, height - 0.003), (high, height - 0.001)]
    profile += [(high - 0.001, height), (high - wall - 0.001, height), (low - wall + 0.0005, floor), (0, floor)]
    print_ = materials.plastic(rng, colour, 256)
    ink = (52, 120, 126) if variant == "white" else (236, 240, 236)
    wave = (np.sin(np.arange(256) * 2 * np.pi * 4 / 256) * 10 + 120).astype(int)
    for column, row in enumerate(wave):
        print_[row : row + 26, column] = ink
        print_[row + 36 : row + 44, column] = ink
    hulls = [pieces.stack([(low, 0), (low + 0.0005, floor)])]
    hulls += pieces.ring([(low - wall, floor), (low, floor), (high, height), (high - wall - 0.001, height)])
    outside, inside = solids.split_by_facing(solids.revolved(profile, 40))
    parts = [
        paint(outside, print_, around(), roughness=0.8),
        paint(inside, materials.plastic(rng, (240, 238, 232)), tiled(0.1), roughness=0.8),
    ]
    return BuiltObject(parts, hulls, mass=0.04, friction=0.7)


def spoon(variant: str) -> BuiltObject:
    """A cooking spoon that lies along x, bowl to the left, handle thick enough to be picked up."""
    rng = variant_rng("spoon", variant)
    x = np.linspace(0.018, 0.1, 12)
    path = np.stack([x, np.zeros(12), np.linspace(0.0085, 0.008, 12)], axis=1)
    width = np.interp(x, [0.018, 0.05, 0.09, 0.1], [0.7, 0.9, 1.1, 0.8])
    handle = solids.sweep(path, solids.circle(1.0, 16) * (0.007, 0.0075), width)
    ladle = solids.moved(solids.ellipsoid((0.032, 0.021, 0.011), count=28), (-0.004, 0, 0.011))
    hollow = solids.moved(solids.ellipsoid((0.028, 0.017, 0.009), count=28), (-0.005, 0, 0.0155))
    ladle = solids.cut(ladle, hollow, solids.box((0.2, 0.2, 0.1), (0, 0, 0.0155)))
    body = solids.union(ladle, handle)
    low = float(body.bounds[0, 2])
    if variant == "wood":
        part = paint(body, materials.wood(rng, materials.BEECH), tiled(0.12), roughness=0.7)
    else:
        part = paint(body, materials.brushed(rng), tiled(0.1), roughness=0.35, metallic=0.3)
    block_ = pieces.coarse(solids.cut(ladle, solids.box((0.2, 0.2, 0.1), (0, 0, 0.013))).vertices)
    bar = handle.convex_hull
    base = pieces.hull(*[[(0.02, y, low), (0.1, y, low), (0.02, y, 0.006), (0.1, y, 0.006)] for y in (-0.005, 0.005)])
    return BuiltObject([part], [block_, bar, base], mass=0.05, friction=0.7)


BUILDERS = {"bowl": bowl, "cup": cup, "mug": mug, "plate": plate, "spoon": spoon}
