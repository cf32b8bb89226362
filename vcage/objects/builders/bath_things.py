"""Paper, towels, holders and a toy of a bathroom."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import pieces, shells, solids
from vcage.objects.builders.mappings import around, from_above, six_sides, tiled
from vcage.objects.builders.parts import BuiltObject, Mapping, paint, variant_rng
from vcage.objects.textures import materials, packaging, prints


def toothbrush_holder(variant: str) -> BuiltObject:
    """An open cup for toothbrushes, a brush drawn on it."""
    rng = variant_rng("toothbrush_holder", variant)
    ground, ink = {
        "white": ((242, 241, 236), (52, 128, 150)),
        "aqua": ((122, 190, 190), (248, 248, 244)),
        "stone": ((126, 124, 122), (240, 238, 232)),
    }[variant]
    radius, height, wall, floor = 0.0345, 0.092, 0.0032, 0.006
    profile = [(0, 0), (radius - 0.003, 0), (radius, 0.003), (radius, height - 0.001), (radius - 0.001, height)]
    profile += [(radius - wall, height - 0.0005), (radius - wall, floor), (0, floor)]
    outside, inside = solids.split_by_facing(solids.revolved(profile, 44))
    glaze = materials.speckled(rng, ground, tuple(int(0.7 * c) for c in ground), 0.02 if variant != "stone" else 0.16)
    picture = np.tile(glaze, (1, 2, 1))[:, :512]
    picture = prints.rectangle(picture, (0, 0.06), (1, 0.08), ink)
    for x in (0.02, 0.27, 0.52, 0.77):
        for shift, lean in ((0.0, 0.03), (0.09, -0.03)):
            foot, neck, tip = (x + shift, 0.8), (x + shift + lean * 0.7, 0.36), (x + shift + lean, 0.22)
            picture = packaging.stroke(picture, [foot, neck], 0.05, ink)
            picture = packaging.stroke(picture, [neck, tip], 0.028, ink)
            side = 0.016 if lean > 0 else -0.016
            bristle = [(tip[0] + side, tip[1]), (neck[0] + side, neck[1] - 0.03)]
            picture = packaging.stroke(picture, bristle, 0.06, (226, 120, 90))
    parts = [
        paint(outside, picture, around(), roughness=0.3),
        paint(inside, glaze, tiled(0.1), roughness=0.3),
    ]
    hulls = [pieces.stack([(radius - 0.002, 0), (radius, 0.003), (radius, floor)])]
    hulls += pieces.ring([(radius - wall, floor), (radius, floor), (radius, height), (radius - wall, height)])
    return BuiltObject(parts, hulls, mass=0.22, friction=0.6)


def toilet_paper_roll(variant: str) -> BuiltObject:
    """A half-used roll that stands upright, with its cardboard core and a loose end."""
    rng = variant_rng("toilet_paper_roll", variant)
    colour = {"white": (246, 245, 241), "natural": (216, 190, 152)}[variant]
    outer, inner, height = 0.0335, 0.0205, 0.096
    paper = [(inner + 0.0015, 0), (outer - 0.001, 0), (outer, 0.001), (outer, height - 0.001), (outer - 0.001, height)]
    side = solids.revolved([*paper, (inner + 0.0015, height)], 48)
    flat = np.abs(side.face_normals[:, 2]) > 0.5
    ends, wrap = side.copy(), side.copy()
    ends.update_faces(flat)
    wrap.update_faces(~flat)
    core = [(inner, 0), (inner + 0.0016, 0), (inner + 0.0016, height + 0.0004), (inner, height + 0.0004)]
    angle = np.radians(np.linspace(-120, -84, 7))  # the loose end of the paper, in front
    sheet = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    reach = np.linspace(outer - 0.0003, outer + 0.0012, 7)[:, None]
    leaf = solids.prism(np.concatenate([sheet * (reach + 0.0004), (sheet * (reach - 0.0004))[::-1]]), 0.09, 0.003)
    pattern = packaging.quilted(rng, colour)
    parts = [
        paint(wrap, pattern, around(), roughness=0.95),
        paint(ends, packaging.windings(colour, 16, 0.72), from_above(), roughness=0.95),
        paint(leaf, pattern, tiled(0.1), roughness=0.95),
        paint(solids.revolved(core, 40), materials.cardboard(rng, (172, 136, 96)), tiled(0.1), roughness=0.9),
    ]
    hulls = pieces.ring([(inner, 0), (outer, 0), (outer, height), (inner, height)])
    return BuiltObject(parts, hulls, mass=0.06, friction=0.8)


def tissue_box(variant: str) -> BuiltObject:
    """A slim box of tissues, the first one standing out of the slot."""
    rng = variant_rng("tissue_box", variant)
    ground, bloom, ink = {
        "blue": ((150, 196, 226), (246, 248, 250), (34, 84, 140)),
        "floral": ((250, 236, 226), (226, 120, 140), (150, 60, 84)),
        "green": ((170, 206, 164), (250, 250, 240), (48, 104, 66)),
    }[variant]
    size = (0.17, 0.066, 0.066)
    face = packaging.label((512, 200), ground, [], [(0.84, 0.87, ink)])
    for _ in range(26):
        x, y, reach = rng.uniform(0, 1), rng.uniform(0, 0.76), rng.uniform(0.035, 0.075)
        for turn in np.arange(5) * 2 * np.pi / 5:
            petal = (x + reach * np.cos(turn) * 200 / 512, y + reach * np.sin(turn))
            face = prints.disc(face, petal, 0.62 * reach, bloom)
        face = prints.disc(face, (x, y), 0.4 * reach, (246, 206, 90))
    front = prints.rectangle(face, (0.28, 0.28), (0.72, 0.68), bloom if variant != "floral" else ground)
    front = packaging.fitted(front, "TISSUES", (0.5, 0.46), (0.36, 0.2), ink)
    front = packaging.fitted(front, "soft & strong", (0.5, 0.61), (0.26, 0.08), ink)
    top = face.copy()
    for colour, wide, tall in ((ink, 0.29, 0.31), ((236, 240, 242), 0.275, 0.27)):
        slot = solids.circle(1.0, 40) * (wide, tall) + 0.5
        top = packaging.polygon(top, [tuple(p) for p in slot], colour)
    picture = prints.atlas({"front": front, "back": front, "top": top, "left": face, "right": face}, ground, (512, 200))
    box = solids.rounded_box(size, 0.0015, steps=2)
    tuft = _tuft(size[2])
    parts = [
        paint(box, picture, six_sides(), roughness=0.6),
        paint(tuft, packaging.quilted(rng, (252, 252, 250)), tiled(0.08), roughness=0.95, crease=25),
    ]
    return BuiltObject(parts, [solids.box(size), pieces.coarse(tuft.vertices)], mass=0.14, friction=0.6)


def _tuft(z: float) -> solids.Solid:
    """A pulled-up tissue that rises from the height ``z``: a creased flame, wide along x."""
    angle = np.arange(28) * 2 * np.pi / 28
    folds = 1 + 0.16 * np.cos(5 * angle + 0.6) + 0.08 * np.cos(9 * angle)
    rings = []
    for share in np.linspace(0, 1, 6):
        wide = 0.023 + 0.005 * np.sin(np.pi * share) - 0.009 * share
        deep = 0.009 + 0.003 * np.sin(np.pi * share) - 0.006 * share
        lift = z - 0.001 + 0.026 * share + 0.0025 * share * np.cos(3 * angle)
        rings.append(np.column_stack([np.cos(angle) * folds * wide, np.sin(angle) * folds * deep, lift]))
    return solids.closed_rings(rings)


def soap_dish(variant: str) -> BuiltObject:
    """A shallow dish with drain slots drawn on its floor."""
    rng = variant_rng("soap_dish", variant)
    inner, wall, floor, height = (0.116, 0.08), 0.009, 0.007, 0.028
    body, hulls = shells.open_box(inner, wall, floor, height, 0.013)
    if variant == "bamboo":
        skin = materials.wood(rng, materials.PINE)
    else:
        skin = materials.speckled(
            rng, {"white": (240, 239, 234), "grey": (140, 146, 152)}[variant], (120, 122, 126), 0.02
        )
    dark = tuple(int(0.55 * c) for c in skin.reshape(-1, 3).mean(axis=0))
    slots = np.tile(skin, (1, 2, 1))[:, : skin.shape[1] * 3 // 2]
    for x in np.linspace(0.12, 0.88, 8):
        slots = packaging.stroke(slots, [(x, 0.2), (x, 0.8)], 0.05, dark)
    grate = solids.prism(solids.rounded_rectangle((inner[0] - 0.004, inner[1] - 0.004), 0.003), 0.0006, floor - 0.0003)
    parts = [
        paint(body, skin, tiled(0.12), roughness=0.35 if variant != "bamboo" else 0.7),
        paint(grate, slots, from_above(), roughness=0.5),
    ]
    return BuiltObject(parts, hulls, mass=0.22, friction=0.6)


def rubber_duck(variant: str) -> BuiltObject:
    """A bath duck that looks to the front."""
    rng = variant_rng("rubber_duck", variant)
    colour, beak_colour = {"yellow": ((250, 206, 40), (238, 120, 30)), "pink": ((246, 150, 180), (246, 190, 60))}[
        variant
    ]
    body = solids.above(solids.ellipsoid((0.0315, 0.041, 0.0265), (0, 0.004, 0.0245), 28), 0.0012)
    head = solids.ellipsoid((0.0205, 0.021, 0.0205), (0, -0.014, 0.0575), 26)
    tail = solids.moved(solids.ellipsoid((0.012, 0.018, 0.007), count=14), (0, 0.04, 0.039), turn=38, axis=(1, 0, 0))
    wings = [
        solids.moved(
            solids.ellipsoid((0.006, 0.02, 0.012), count=16), (side * 0.0295, 0.009, 0.029), turn=14, axis=(1, 0, 0)
        )
        for side in (-1, 1)
    ]
    beak = solids.union(
        solids.ellipsoid((0.0105, 0.0125, 0.0038), (0, -0.036, 0.0545), 16),
        solids.ellipsoid((0.0085, 0.01, 0.003), (0, -0.034, 0.0505), 16),
    )
    skin = solids.union(body, head, tail, *wings)
    parts = [
        paint(skin, materials.plastic(rng, colour), tiled(0.1), roughness=0.35),
        paint(beak, materials.plastic(rng, beak_colour), tiled(0.1), roughness=0.35),
    ]
    for reach, radius, tint in ((0.0, 0.0046, (250, 250, 250)), (0.0019, 0.0034, (20, 20, 24))):
        eyes = []
        for side in (-1, 1):
            out = np.array([side * 0.52, -0.76, 0.4]) / np.linalg.norm([0.52, 0.76, 0.4])
            eyes.append(solids.ellipsoid([radius] * 3, np.array([0, -0.014, 0.0575]) + out * (0.0182 + reach), 10))
        parts.append(paint(solids.union(*eyes), materials.plastic(rng, tint), tiled(0.1), roughness=0.15))
    hulls = [pieces.coarse(_visible(skin, solid), 90) for solid in (body, head, tail, *wings)]
    hulls.append(pieces.coarse(beak.vertices))
    return BuiltObject(parts, hulls, mass=0.06, friction=0.8)


def _visible(skin: solids.Solid, solid: solids.Solid) -> np.ndarray:
    """The corners (n, 3) of a union that lie on the surface of one of its convex solids."""
    offsets = np.einsum("ij,ij->i", solid.face_normals, solid.triangles[:, 0])
    outside = (skin.vertices @ solid.face_normals.T - offsets).max(axis=1)
    return skin.vertices[np.abs(outside) < 1e-5]


def towel_roll(variant: str) -> BuiltObject:
    """A rolled-up hand towel that lies along x."""
    rng = variant_rng("towel_roll", variant)
    colour, band = {
        "white": ((244, 242, 236), (150, 176, 196)),
        "teal": ((44, 138, 142), (232, 238, 232)),
        "rose": ((222, 150, 156), (246, 232, 226)),
    }[variant]
    radius, half = 0.034, 0.082
    ring = solids.circle(radius, 44)
    ring[:, 1] = np.maximum(ring[:, 1], 0.0025 - radius)  # lies flat
    stations = [(-half, 0.9), (-half + 0.004, 1.0), (half - 0.004, 1.0), (half, 0.9)]
    rings = [np.column_stack([np.full(44, x), ring * s]) + (0, 0, radius - 0.0025) for x, s in stations]
    roll = solids.closed_rings(rings)
    flat = np.abs(roll.face_normals[:, 0]) > 0.9
    ends, wrap = roll.copy(), roll.copy()
    ends.update_faces(flat)
    wrap.update_faces(~flat)
    cloth = packaging.terry(rng, colour)
    cloth = np.tile(cloth, (1, 2, 1))
    for low, high in ((0.1, 0.13), (0.15, 0.19), (0.21, 0.24), (0.76, 0.79), (0.81, 0.85), (0.87, 0.9)):
        cloth[round(low * 256) : round(high * 256)] = (
            0.25 * cloth[round(low * 256) : round(high * 256)] + 0.75 * np.asarray(band)
        ).astype(np.uint8)
    flap = [solids.circle(radius + 0.0012, 88)[8:18], solids.circle(radius - 0.001, 88)[8:18][::-1]]
    hem = shells.across(np.concatenate(flap) + (0, radius - 0.0025), 2 * half - 0.01)
    parts = [
        paint(wrap, cloth, around(0, (0.0, radius - 0.0025)), roughness=0.95),
        paint(ends, packaging.windings(colour, 7, 0.55), _end_on(), roughness=0.95),
        paint(hem, packaging.terry(rng, tuple(int(0.92 * c) for c in colour)), tiled(0.06), roughness=0.95),
    ]
    return BuiltObject(parts, [pieces.hull(*[r[::2] for r in rings])], mass=0.15, friction=0.9)


def _end_on() -> Mapping:
    """The picture lies over the bounding rectangle as seen along x."""

    def mapping(corners: np.ndarray, _normals: np.ndarray) -> np.ndarray:
        flat = corners[..., 1:]
        low, high = flat.reshape(-1, 2).min(axis=0), flat.reshape(-1, 2).max(axis=0)
        return (flat - low) / (high - low)

    return mapping


BUILDERS = {
    "rubber_duck": rubber_duck,
    "soap_dish": soap_dish,
    "tissue_box": tissue_box,
    "toilet_paper_roll": toilet_paper_roll,
    "toothbrush_holder": toothbrush_holder,
    "towel_roll": towel_roll,
}
