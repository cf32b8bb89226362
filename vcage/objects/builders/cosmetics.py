"""Small jars and bottles of a bathroom, and a hairbrush."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import pieces, shells, solids
from vcage.objects.builders.mappings import around, from_above, from_front, tiled
from vcage.objects.builders.parts import BuiltObject, paint, variant_rng
from vcage.objects.textures import materials, packaging, prints


def cream_jar(variant: str) -> BuiltObject:
    """A low round jar of face cream with a screw lid."""
    rng = variant_rng("cream_jar", variant)
    ground, lid, ink = {
        "white": ((246, 244, 240), (212, 176, 112), (150, 116, 60)),
        "blue": ((28, 62, 140), (240, 242, 246), (246, 248, 250)),
        "rose": ((240, 204, 204), (248, 246, 244), (166, 84, 96)),
    }[variant]
    radius, seam, height = 0.0315, 0.028, 0.047
    jar = [(0, 0), (radius - 0.004, 0), (radius - 0.001, 0.002), (radius, 0.005), (radius, seam - 0.002)]
    jar += [(radius - 0.0015, seam), (0, seam)]
    cap = [(0, seam), (radius, seam), (radius + 0.001, seam + 0.001), (radius + 0.001, height - 0.003)]
    cap += [(radius - 0.0005, height - 0.0008), (radius - 0.003, height), (0, height)]
    lines = [("VELLIA", 0.4, 0.14, 0.26, ink), ("face cream", 0.72, 0.13, 0.16, ink)]
    label = packaging.label((768, 112), ground, lines)
    top = materials.plastic(rng, lid, 256)
    mark = (110, 80, 36) if variant == "white" else ink if variant == "rose" else ground
    top = prints.disc(prints.disc(top, (0.5, 0.5), 0.42, mark), (0.5, 0.5), 0.405, lid)
    top = packaging.fitted(top, "VELLIA", (0.5, 0.45), (0.5, 0.14), mark)
    top = packaging.fitted(top, "face cream", (0.5, 0.61), (0.36, 0.07), mark)
    parts = [
        paint(solids.revolved(jar, 48), label, around(), roughness=0.25),
        paint(solids.revolved(cap, 48), top, from_above(), roughness=0.3),
    ]
    hulls = [
        pieces.stack([(radius - 0.003, 0), (radius, 0.004), (radius, seam)]),
        pieces.stack([(radius + 0.001, seam), (radius + 0.001, height - 0.002), (radius - 0.002, height)]),
    ]
    return BuiltObject(parts, hulls, mass=0.16, friction=0.6)


def perfume_bottle(variant: str) -> BuiltObject:
    """A flat glass flask with a metal collar and a tall cap."""
    rng = variant_rng("perfume_bottle", variant)
    low, high, lid = {
        "rose": ((236, 150, 160), (252, 226, 226), (216, 180, 110)),
        "amber": ((206, 132, 40), (248, 214, 140), (36, 34, 36)),
        "blue": ((54, 110, 186), (196, 222, 244), (206, 208, 212)),
    }[variant]
    size, neck, top = (0.056, 0.03, 0.068), 0.074, 0.104
    glass = solids.rounded_box(size, 0.006, steps=4)
    picture = packaging.frosted(rng, high, low)
    picture = prints.rectangle(picture, (0, 0), (1, 0.2), tuple(int(0.35 * c + 165) for c in high))
    ink = tuple(int(0.35 * c) for c in low)
    plate = solids.box((0.032, 0.0008, 0.026), (0, -size[1] / 2 - 0.0001, 0.02))
    face = packaging.label((256, 208), (250, 246, 236), [("ODETTE", 0.42, 0.8, 0.24, ink)], places=(0.5,))
    face = packaging.fitted(face, "eau de parfum", (0.5, 0.68), (0.66, 0.12), ink)
    edge = [(0.03, 0.04), (0.97, 0.04), (0.97, 0.96), (0.03, 0.96)]
    face = packaging.stroke(face, edge, 0.02, tuple(lid), closed=True)
    collar = [(0, 0.067), (0.0105, 0.067), (0.0105, neck), (0, neck)]
    cap = [(0, neck), (0.0118, neck), (0.0125, neck + 0.001), (0.0125, top - 0.002), (0.011, top), (0, top)]
    parts = [
        paint(glass, picture, around(), roughness=0.08),
        paint(plate, face, from_front(), roughness=0.5),
        paint(solids.revolved(collar, 32), materials.brushed(rng), tiled(0.05), roughness=0.25, metallic=0.5),
        paint(solids.revolved(cap, 36), materials.plastic(rng, lid), tiled(0.05), roughness=0.2, metallic=0.3),
    ]
    hulls = [
        solids.rounded_box(size, 0.006, steps=2),
        pieces.stack([(0.0105, 0.067), (0.0105, neck)]),
        pieces.stack([(0.0125, neck), (0.0125, top - 0.001), (0.011, top)]),
    ]
    return BuiltObject(parts, hulls, mass=0.16, friction=0.6)


def pill_bottle(variant: str) -> BuiltObject:
    """A small bottle of pills with a ribbed safety cap."""
    rng = variant_rng("pill_bottle", variant)
    ground, lid, accent, words = {
        "orange": ((214, 106, 22), (246, 246, 244), (40, 84, 150), "TABLETS"),
        "white": ((244, 244, 242), (70, 150, 90), (60, 140, 80), "VITAMIN C"),
    }[variant]
    radius, shoulder, height = 0.0215, 0.052, 0.073
    body = [(0, 0), (radius - 0.002, 0), (radius, 0.002), (radius, shoulder - 0.004), (radius - 0.004, shoulder)]
    cap = [(0, shoulder), (0.0225, shoulder), (0.0225, height - 0.0015), (0.021, height), (0, height)]
    paper = solids.revolved([(0.015, 0.007), (radius + 0.0003, 0.007), (radius + 0.0003, 0.042), (0.015, 0.042)], 40)
    label = packaging.label((640, 168), (250, 249, 246), [], [(0, 0.3, accent)])
    for x in (0.0, 0.5, 1.0):
        label = packaging.fitted(label, words, (x, 0.15), (0.26, 0.18), (252, 252, 250))
        label = packaging.fitted(label, "Take 1 a day", (x, 0.45), (0.22, 0.12), (40, 42, 48))
        for row, reach in ((0.6, 0.12), (0.7, 0.1), (0.8, 0.12), (0.9, 0.07)):
            label = prints.rectangle(label, (max(0, x - reach), row), (min(1, x + reach), row + 0.035), (150, 152, 158))
    tablets = packaging.cotton(rng, tuple(int(0.6 * c + 70) for c in ground), (512, 256))
    glass = tablets if variant == "orange" else materials.plastic(rng, ground)
    if variant == "orange":
        glass = (0.45 * glass + 0.55 * np.asarray(ground)).astype(np.uint8)
    dark = tuple(int(0.82 * c) for c in lid)
    top = [(0.0, height - 0.0002), (0.0195, height - 0.0002), (0.0195, height + 0.0003), (0, height + 0.0003)]
    disc = prints.canvas(192, 192, lid)
    disc = packaging.fitted(disc, "PUSH DOWN", (0.5, 0.4), (0.7, 0.12), dark)
    disc = packaging.fitted(disc, "& TURN", (0.5, 0.6), (0.45, 0.12), dark)
    parts = [
        paint(solids.revolved([*body, (0, shoulder)], 40), glass, around(), roughness=0.2),
        paint(paper, label, around(), roughness=0.6),
        paint(solids.revolved(cap, 40), packaging.striped([lid, dark], 64), around(), roughness=0.45),
        paint(solids.revolved(top, 40), disc, from_above(), roughness=0.45),
    ]
    hulls = [
        pieces.stack([(radius - 0.001, 0), (radius + 0.0003, 0.002), (radius + 0.0003, shoulder)]),
        pieces.stack([(0.0225, shoulder), (0.0225, height)]),
    ]
    return BuiltObject(parts, hulls, mass=0.07, friction=0.6)


def cotton_jar(variant: str) -> BuiltObject:
    """A glass jar of cotton with a wooden lid and a knob."""
    rng = variant_rng("cotton_jar", variant)
    if variant == "balls":
        inside, timber, words = packaging.cotton(rng), materials.BEECH, "cotton balls"
    else:
        inside = packaging.swabs(rng, {"swabs": (120, 176, 216)}[variant])
        timber, words = materials.WALNUT, "cotton swabs"
    radius, seam, lid = 0.0315, 0.072, 0.081
    jar = [(0, 0), (radius - 0.003, 0), (radius, 0.003), (radius, seam - 0.005), (radius - 0.002, seam), (0, seam)]
    inside = prints.rectangle(inside, (0, 0.95), (1, 1), (206, 220, 226))
    for x in (0.0, 0.5, 1.0):
        low, high = max(0.0, x - 0.14), min(1.0, x + 0.14)
        inside = prints.rectangle(inside, (low, 0.42), (high, 0.66), (250, 248, 240))
        inside = packaging.fitted(inside, words, (x, 0.54), (0.24, 0.12), (70, 66, 60))
    top = [(0, seam), (radius, seam), (radius, lid - 0.002), (radius - 0.002, lid), (0, lid)]
    knob = [(0, lid - 0.001), (0.006, lid - 0.001), (0.006, lid + 0.003)]
    knob = np.concatenate([knob, solids.arc((0, lid + 0.012), (0.0115, 0.0095), -55, 90, 10)])
    wood = solids.union(solids.revolved(top, 44), solids.revolved(knob, 28))
    parts = [
        paint(solids.revolved(jar, 44), inside, around(), roughness=0.12),
        paint(wood, materials.wood(rng, timber), tiled(0.1), roughness=0.65),
    ]
    hulls = [
        pieces.stack([(radius - 0.002, 0), (radius, 0.003), (radius, seam)]),
        pieces.stack([(radius, seam), (radius, lid)]),
        pieces.stack([(0.006, lid - 0.001), (0.006, lid + 0.005)], 12),
        pieces.coarse(solids.revolved(knob[3:], 24).vertices, 90),
    ]
    return BuiltObject(parts, hulls, mass=0.2, friction=0.7)


def hairbrush(variant: str) -> BuiltObject:
    """A brush that lies on its back along x, bristles up at the left, thick handle to the right."""
    rng = variant_rng("hairbrush", variant)
    cushion_colour = {"wood": (176, 60, 66), "black": (60, 62, 68), "teal": (238, 240, 240)}[variant]
    outline = solids.circle(1.0, 40) * (0.046, 0.03)
    head = shells.levelled(outline, [(0, 0.86), (0.004, 0.98), (0.008, 1.0), (0.012, 0.96)])
    cushion = shells.levelled(outline, [(0.0115, 0.85), (0.0145, 0.8), (0.016, 0.66), (0.0164, 0.4)])
    x = np.linspace(0.0415, 0.14, 16)
    scale = np.interp(x, [0.0415, 0.06, 0.095, 0.13, 0.14], [0.62, 0.72, 1.0, 0.9, 0.45])
    path = np.stack([x, np.zeros(16), np.interp(x, [0.0415, 0.08, 0.14], [0.0075, 0.0098, 0.0098])], axis=1)
    bar = solids.sweep(path, solids.circle(1.0, 20) * (0.0112, 0.0098), scale)
    bristles, tips = [], []
    for row, y in enumerate(np.linspace(-0.019, 0.019, 7)):
        for at in np.linspace(-0.033, 0.033, 11) + 0.0016 * (row % 2):
            if (at / 0.038) ** 2 + (y / 0.023) ** 2 < 1:
                bristles.append(solids.box((0.0011, 0.0011, 0.0135), (at, y, 0.015)))
                tips.append(solids.box((0.0021, 0.0021, 0.0021), (at, y, 0.0278)))
    wood = materials.wood(rng, materials.BEECH) if variant == "wood" else None
    skin = (
        wood if wood is not None else materials.plastic(rng, {"black": (42, 42, 46), "teal": (34, 150, 150)}[variant])
    )
    parts = [
        paint(solids.union(head, bar), skin, tiled(0.12), roughness=0.5 if wood is not None else 0.3),
        paint(cushion, materials.plastic(rng, cushion_colour), tiled(0.05), roughness=0.8),
        paint(solids.union(*bristles), materials.plastic(rng, (52, 44, 42)), tiled(0.05), roughness=0.7),
        paint(solids.union(*tips), materials.plastic(rng, (228, 200, 150)), tiled(0.05), roughness=0.6),
    ]
    half = x > 0.085
    foot = [(at, y, z) for at in (0.04, 0.132) for y in (-0.005, 0.005) for z in (0.0, 0.003)]
    hulls = [
        shells.levelled_hull(outline, [(0, 0.86), (0.004, 0.97), (0.008, 0.985), (0.012, 0.95)]),
        shells.levelled_hull(outline, [(0.0115, 0.85), (0.016, 0.7)]),
        pieces.hull(*[solid.vertices for solid in (*bristles, *tips)]),
        pieces.coarse(bar.vertices[bar.vertices[:, 0] <= x[half][0] + 1e-6]),
        pieces.coarse(bar.vertices[bar.vertices[:, 0] >= x[~half][-1] - 1e-6]),
        pieces.hull(foot),
    ]
    return BuiltObject(parts, hulls, mass=0.08, friction=0.7)


BUILDERS = {
    "cotton_jar": cotton_jar,
    "cream_jar": cream_jar,
    "hairbrush": hairbrush,
    "perfume_bottle": perfume_bottle,
    "pill_bottle": pill_bottle,
}
