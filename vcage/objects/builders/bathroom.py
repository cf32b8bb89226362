"""Things of a bathroom."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import pieces, solids
from vcage.objects.builders.mappings import around, from_above, tiled
from vcage.objects.builders.parts import BuiltObject, paint, variant_rng
from vcage.objects.textures import materials, prints


def soap_bar(variant: str) -> BuiltObject:
    """A bar of soap with a pressed word."""
    rng = variant_rng("soap_bar", variant)
    colour = {"lavender": (196, 176, 222), "olive": (176, 190, 130)}[variant]
    bar = solids.rounded_box((0.084, 0.054, 0.028), 0.011, steps=5)
    dark = tuple(int(0.78 * c) for c in colour)
    top = prints.text(materials.plastic(rng, colour, 256), "SOAP", (0.5, 0.5), 0.27, dark)
    return BuiltObject([paint(bar, top, from_above(), roughness=0.35)], [pieces.coarse(bar.vertices, 90)], 0.1, 0.6)


def toothbrush(variant: str) -> BuiltObject:
    """A chunky toothbrush that lies on its back along x, bristles up at the left end."""
    rng = variant_rng("toothbrush", variant)
    colour = {"blue": (40, 120, 200), "pink": (230, 90, 140)}[variant]
    x = np.linspace(-0.04, 0.085, 20)
    scale = np.interp(x, [-0.04, -0.01, 0.02, 0.06, 0.08, 0.085], [0.42, 0.45, 0.85, 1, 0.85, 0.5])
    half_width, half_height = 0.0078, 0.0085
    path = np.stack([x, np.zeros(20), half_height * scale], axis=1)
    handle = solids.sweep(path, solids.circle(1.0, 18) * (half_width, half_height), scale)
    head = solids.rounded_box((0.034, 0.0125, 0.0055), 0.0025, (-0.05, 0, 0.0005))
    grip = solids.rounded_box((0.05, 0.0095, 0.003), 0.0014, (0.048, 0, 2 * half_height * 0.97 - 0.0026))
    tufts = []
    for i, at in enumerate(np.linspace(-0.063, -0.037, 6)):
        for y in (-0.0036, 0, 0.0036):
            tufts.append(solids.box((0.0036, 0.003, 0.0105 + 0.001 * (i % 2)), (at, y, 0.005)))
    parts = [
        paint(solids.union(handle, head), materials.plastic(rng, colour), tiled(0.05), roughness=0.35),
        paint(grip, materials.plastic(rng, (240, 240, 240)), tiled(0.05), roughness=0.6),
        paint(solids.union(*tufts), materials.page_edges(rng, (238, 244, 250), 64), tiled(0.01), roughness=0.9),
    ]
    bristles = pieces.hull(*[tuft.vertices for tuft in tufts])
    foot = pieces.hull(*[[(at, y, z) for at in (-0.06, 0.08) for z in (0, 0.004)] for y in (-0.004, 0.004)])
    middle = pieces.coarse(handle.vertices[(handle.vertices[:, 0] > -0.002)])
    neck = pieces.coarse(handle.vertices[(handle.vertices[:, 0] < 0.006)])
    return BuiltObject(
        parts, [middle, neck, head.convex_hull, bristles, foot, grip.convex_hull], mass=0.02, friction=0.7
    )


def sponge(variant: str) -> BuiltObject:
    """A soft sponge with a scouring side at the bottom."""
    rng = variant_rng("sponge", variant)
    colour = {"yellow": (244, 206, 70), "blue": (104, 172, 220)}[variant]
    soft = solids.rounded_box((0.096, 0.062, 0.026), 0.004, (0, 0, 0.007))
    rough = solids.box((0.094, 0.06, 0.009))
    holes = materials.speckled(rng, colour, tuple(int(0.62 * c) for c in colour), 0.10)
    parts = [
        paint(soft, holes, tiled(0.07), roughness=0.95),
        paint(rough, materials.felt(rng, (44, 104, 62)), tiled(0.04), roughness=0.95),
    ]
    return BuiltObject(parts, [soft.convex_hull, rough], mass=0.02, friction=0.9)


def lotion_bottle(variant: str) -> BuiltObject:
    """An oval bottle with a flip cap, wide face to the front."""
    rng = variant_rng("lotion_bottle", variant)
    ground, words = {"mint": ((150, 208, 186), "LOTION"), "peach": ((246, 186, 150), "SHAMPOO")}[variant]
    height, shoulder = 0.135, 0.098
    levels = [
        (0, 0.94),
        (0.003, 1.0),
        (shoulder - 0.02, 1.0),
        (shoulder - 0.008, 0.93),
        (shoulder, 0.72),
        (shoulder + 0.003, 0.5),
    ]
    outline = solids.circle(1.0, 36) * (0.031, 0.02)
    body = solids.closed_rings([np.column_stack([outline * s, np.full(36, z)]) for z, s in levels])
    cap = solids.revolved(
        [(0, shoulder), (0.0145, shoulder), (0.0145, height - 0.003), (0.0125, height), (0, height)], 28
    )
    label = materials.plastic(rng, ground, 256)
    dark = tuple(int(0.45 * c) for c in ground)
    for x in (0.0, 0.5, 1.0):
        label = prints.rectangle(label, (max(0, x - 0.15), 0.25), (min(1, x + 0.15), 0.80), (250, 248, 244))
        label = prints.text(label, words, (x, 0.48), 0.075, dark)
        label = prints.rectangle(label, (max(0, x - 0.08), 0.58), (min(1, x + 0.08), 0.6), dark)
    parts = [
        paint(body, label, around(), roughness=0.35),
        paint(cap, materials.plastic(rng, (246, 246, 244)), tiled(0.05), roughness=0.35),
    ]
    rings = [np.column_stack([outline[::2] * s, np.full(18, z)]) for z, s in levels]
    lid = pieces.stack([(0.0145, shoulder), (0.0145, height - 0.003), (0.0125, height)])
    return BuiltObject(parts, [pieces.hull(*rings), lid], mass=0.18, friction=0.6)


BUILDERS = {"lotion_bottle": lotion_bottle, "soap_bar": soap_bar, "sponge": sponge, "toothbrush": toothbrush}
