"""Bottles, tubes and sticks of a bathroom shelf."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import pieces, shells, solids
from vcage.objects.builders.mappings import around, from_above, six_sides, tiled
from vcage.objects.builders.parts import BuiltObject, paint, variant_rng
from vcage.objects.textures import materials, packaging, prints

WHITE = (248, 248, 245)


def shampoo_bottle(variant: str) -> BuiltObject:
    """A tall oval bottle with an oval flip cap, wide face to the front."""
    rng = variant_rng("shampoo_bottle", variant)
    ground, accent = {
        "blue": ((44, 112, 186), (196, 226, 246)),
        "green": ((70, 142, 82), (226, 240, 190)),
        "purple": ((118, 74, 150), (238, 206, 236)),
    }[variant]
    height, shoulder = 0.168, 0.128
    outline, lid = solids.circle(1.0, 40) * (0.032, 0.0215), solids.circle(1.0, 32) * (0.0205, 0.0155)
    levels = [(0, 0.93), (0.003, 1), (shoulder - 0.032, 1), (shoulder - 0.012, 0.92), (shoulder - 0.003, 0.74)]
    levels += [(shoulder, 0.64)]
    cap = [
        (shoulder - 0.0005, 0.97),
        (shoulder + 0.002, 1),
        (height - 0.004, 1),
        (height - 0.001, 0.94),
        (height, 0.85),
    ]
    lines = [("SHAMPOO", 0.53, 0.34, 0.1, WHITE), ("LUMINA", 0.38, 0.24, 0.09, accent)]
    lines += [("daily care", 0.66, 0.2, 0.06, accent), ("300 ml", 0.88, 0.1, 0.04, accent)]
    label = packaging.label((768, 512), ground, lines, [(0.74, 0.765, accent), (0.79, 0.8, accent)])
    parts = [
        paint(shells.levelled(outline, levels), label, around(), roughness=0.3),
        paint(shells.levelled(lid, cap), materials.plastic(rng, WHITE), tiled(0.05), roughness=0.35),
        paint(
            solids.box((0.013, 0.0008, 0.004), (0, -0.0155, height - 0.012)),
            materials.plastic(rng, (190, 190, 188)),
            tiled(0.05),
        ),
    ]
    hulls = [shells.levelled_hull(outline, levels), shells.levelled_hull(lid, cap)]
    return BuiltObject(parts, hulls, mass=0.3, friction=0.6)


def soap_dispenser(variant: str) -> BuiltObject:
    """A round bottle with a pump whose spout looks to the front."""
    rng = variant_rng("soap_dispenser", variant)
    ground, ink, metal = {
        "white": ((238, 236, 230), (70, 74, 82), (198, 200, 204)),
        "amber": ((128, 70, 26), (246, 236, 214), (44, 44, 46)),
        "grey": ((128, 132, 136), (240, 240, 236), (212, 178, 110)),
    }[variant]
    radius, top = 0.035, 0.142
    body = [(0, 0), (radius - 0.002, 0), (radius, 0.002), (radius, 0.078)]
    body = np.concatenate([body, solids.arc((0.0145, 0.078), (radius - 0.0145, 0.016), 10, 90, 7), [(0, 0.094)]])
    collar = [(0, 0.0935), (0.0145, 0.0935), (0.0155, 0.0945), (0.0155, 0.115), (0.0145, 0.116), (0, 0.116)]
    stem = solids.revolved([(0, 0.115), (0.0045, 0.115), (0.0045, 0.132), (0, 0.132)], 20)
    head = solids.revolved([(0, 0.13), (0.011, 0.13), (0.012, 0.132), (0.011, top - 0.001), (0.009, top), (0, top)], 28)
    spout = solids.rounded_box((0.009, 0.04, 0.008), 0.003, (0, -0.024, 0.1315))
    tip = solids.box((0.006, 0.006, 0.008), (0, -0.04, 0.1255))
    label = packaging.label(
        (640, 288), ground, [("HAND SOAP", 0.53, 0.2, 0.12, ink), ("fig & cedar", 0.66, 0.15, 0.08, ink)]
    )
    for x in (0.0, 0.5, 1.0):
        frame = [(x - 0.12, 0.4), (x + 0.12, 0.4), (x + 0.12, 0.76), (x - 0.12, 0.76)]
        label = packaging.stroke(label, frame, 0.012, ink, closed=True)
    steel = materials.brushed(rng, metal)
    parts = [
        paint(solids.revolved(body, 44), label, around(), roughness=0.25),
        paint(solids.revolved(collar, 36), steel, tiled(0.02, along=2), roughness=0.3, metallic=0.4),
        paint(solids.union(stem, head, spout, tip), steel, tiled(0.05), roughness=0.3, metallic=0.4),
    ]
    hulls = [
        pieces.stack([(radius, 0), (radius, 0.08), (0.029, 0.0895), (0.0145, 0.094)]),
        pieces.stack([(0.0155, 0.0935), (0.0155, 0.116)]),
        pieces.stack([(0.0045, 0.115), (0.0045, 0.132)], 8),
        pieces.stack([(0.012, 0.13), (0.012, top)]),
        spout.convex_hull,
        tip,
    ]
    return BuiltObject(parts, hulls, mass=0.3, friction=0.7)


def toothpaste_tube(variant: str) -> BuiltObject:
    """A tube that stands on its wide cap; the folded end is on top, along x."""
    rng = variant_rng("toothpaste_tube", variant)
    accent, words = {
        "mint": ((28, 150, 130), "MINTY"),
        "red": ((206, 38, 44), "DENTO"),
        "blue": ((30, 86, 176), "AQUAFRESCA"),
    }[variant]
    shoulder, fold, top = 0.026, 0.128, 0.14
    outline = solids.circle(1.0, 40)
    share = np.linspace(0, 1, 9)
    levels: list[shells.Level] = [(0.019, 0.009, 0.009)]
    levels += [(shoulder + (fold - shoulder) * s, 0.0175 + 0.0085 * s, 0.0175 * np.sqrt(1 - s) + 0.0016) for s in share]
    levels += [(top, 0.026, 0.0016)]
    cap = [(0, 0), (0.0165, 0), (0.018, 0.0015), (0.017, 0.021), (0.0155, 0.022), (0, 0.022)]
    face = packaging.label((224, 512), WHITE, [], [(0.0, 0.08, accent), (0.76, 1.0, accent), (0.72, 0.74, accent)])
    face = packaging.fitted(face, words, (0.5, 0.42), (0.5, 0.3), accent, upright=True)
    face = packaging.fitted(face, "toothpaste", (0.68, 0.42), (0.34, 0.12), (60, 70, 84), upright=True)
    side = packaging.label((64, 512), WHITE, [], [(0.0, 0.08, accent), (0.76, 1.0, accent), (0.72, 0.74, accent)])
    picture = prints.atlas({"front": face, "back": face, "left": side, "right": side}, accent, (224, 512))
    ribs = packaging.striped([(232, 232, 230), (206, 206, 204)], 72)
    parts = [
        paint(shells.levelled(outline, levels), picture, six_sides(), roughness=0.3),
        paint(solids.revolved(cap, 40), ribs, around(), roughness=0.4),
        paint(
            solids.box((0.05, 0.0036, 0.0006), (0, 0, top - 0.004)), materials.plastic(rng, WHITE), tiled(0.05)
        ),  # the seam of the folded end
    ]
    convex = [levels[:5], levels[4:8], levels[7:]]  # the whole narrows unevenly
    hulls = [pieces.stack([(0.0165, 0), (0.018, 0.0015), (0.017, 0.022)])]
    hulls += [shells.levelled_hull(outline, part) for part in convex]
    return BuiltObject(parts, hulls, mass=0.11, friction=0.7)


def toothpaste_box(variant: str) -> BuiltObject:
    """The closed carton of a tube of toothpaste, lying along x."""
    accent, second, words = {
        "red": ((204, 34, 42), (250, 246, 240), "DENTO"),
        "mint": ((22, 146, 128), (244, 250, 246), "MINTY"),
        "blue": ((28, 84, 172), (244, 248, 252), "AQUAFRESCA"),
    }[variant]
    size = (0.165, 0.048, 0.038)
    face = packaging.label((512, 144), accent, [(words, 0.42, 0.42, 0.36, second)], places=(0.36,))
    face = packaging.polygon(face, [(0.68, 0), (1, 0), (1, 1), (0.58, 1)], second)
    face = packaging.polygon(face, [(0.65, 0), (0.67, 0), (0.57, 1), (0.55, 1)], second)
    face = packaging.fitted(face, "toothpaste", (0.34, 0.78), (0.3, 0.2), second)
    face = packaging.fitted(face, "75 ml", (0.9, 0.8), (0.1, 0.14), accent)
    for x, tone in ((0.74, 0.8), (0.8, 1.0), (0.86, 1.2)):
        shade = tuple(int(min(255, c * tone)) for c in accent)
        face = packaging.stroke(face, [(x - 0.02, 0.6), (x, 0.3), (x + 0.03, 0.55)], 0.08, shade)
    end = packaging.fitted(prints.canvas(96, 96, second), words[:5], (0.5, 0.5), (0.8, 0.3), accent)
    sides = {"front": face, "back": face, "top": face, "bottom": face, "left": end, "right": end}
    box = solids.rounded_box(size, 0.0012, steps=2)
    picture = prints.atlas(sides, accent, (512, 144))
    return BuiltObject([paint(box, picture, six_sides(), roughness=0.45)], [solids.box(size)], mass=0.12, friction=0.6)


def mouthwash_bottle(variant: str) -> BuiltObject:
    """A flat bottle of coloured liquid with a ribbed measuring cap."""
    rng = variant_rng("mouthwash_bottle", variant)
    liquid, deep, words = {
        "blue": ((92, 170, 220), (24, 96, 176), "ARCTIC"),
        "green": ((120, 206, 150), (20, 128, 86), "SPEARMINT"),
    }[variant]
    outline = solids.rounded_rectangle((0.068, 0.044), 0.014, 6)
    levels = [(0, 0.95), (0.003, 1), (0.098, 1), (0.11, 0.88, 0.9), (0.119, 0.6, 0.74), (0.122, 0.52, 0.72)]
    glass = packaging.frosted(rng, deep, liquid)
    glass = prints.rectangle(glass, (0, 0), (1, 0.13), tuple(int(0.5 * c + 0.5 * 250) for c in liquid))
    front = packaging.label((320, 320), WHITE, [(words, 0.2, 0.8, 0.14, deep)], [(0.32, 0.72, deep)], (0.5,))
    front = packaging.fitted(front, "MOUTH", (0.5, 0.44), (0.62, 0.14), WHITE)
    front = packaging.fitted(front, "WASH", (0.5, 0.61), (0.5, 0.14), WHITE)
    front = packaging.fitted(front, "fresh breath  500 ml", (0.5, 0.84), (0.7, 0.08), deep)
    plate = [
        solids.box((0.046, 0.0006, 0.062), (0, sign * 0.0221, 0.018)) for sign in (-1, 1)
    ]  # the labels, front and back
    cap = [(0, 0.1215), (0.019, 0.1215), (0.019, 0.123), (0.0185, 0.156), (0.0165, 0.158), (0, 0.158)]
    rim = tuple(int(0.82 * c) for c in deep)
    parts = [
        paint(shells.levelled(outline, levels), glass, around(), roughness=0.12),
        paint(solids.union(*plate), prints.atlas({"front": front, "back": front}, WHITE, (320, 320)), six_sides()),
        paint(solids.revolved(cap, 40), packaging.striped([deep, rim], 60), around(), roughness=0.4),
    ]
    hulls = [shells.levelled_hull(outline, levels), pieces.stack([(0.019, 0.1215), (0.0185, 0.157), (0.0165, 0.158)])]
    return BuiltObject(parts, hulls, mass=0.35, friction=0.7)


def deodorant_stick(variant: str) -> BuiltObject:
    """An oval stick with a domed cap and a dial at its foot."""
    rng = variant_rng("deodorant_stick", variant)
    ground, lid = {"navy": ((32, 48, 86), (176, 184, 194)), "pink": ((244, 244, 242), (238, 150, 178))}[variant]
    ink = (232, 240, 248) if variant == "navy" else (196, 80, 124)
    outline = solids.circle(1.0, 40) * (0.03, 0.0165)
    foot = solids.revolved([(0, 0), (0.0145, 0), (0.0145, 0.008), (0, 0.008)], 36)
    body = [(0.006, 0.93), (0.0075, 1), (0.064, 1)]
    cap = [(0.0645, 0.985), (0.066, 1.0), (0.1, 0.985), (0.108, 0.92), (0.112, 0.74), (0.113, 0.5)]
    lines = [("NORDA" if variant == "navy" else "BLOOM", 0.36, 0.3, 0.26, ink), ("deodorant", 0.66, 0.26, 0.15, ink)]
    label = packaging.label((512, 224), ground, lines, [(0.84, 0.88, ink)])
    parts = [
        paint(foot, packaging.striped([(70, 72, 78), (50, 52, 58)], 44), around(), roughness=0.5),
        paint(shells.levelled(outline, body), label, around(), roughness=0.35),
        paint(shells.levelled(outline, cap), materials.plastic(rng, lid), from_above(), roughness=0.25),
    ]
    dial = pieces.stack([(0.0145, 0), (0.0145, 0.0075)])
    hulls = [dial, shells.levelled_hull(outline, body), shells.levelled_hull(outline, cap)]
    return BuiltObject(parts, hulls, mass=0.1, friction=0.6)


BUILDERS = {
    "deodorant_stick": deodorant_stick,
    "mouthwash_bottle": mouthwash_bottle,
    "shampoo_bottle": shampoo_bottle,
    "soap_dispenser": soap_dispenser,
    "toothpaste_box": toothpaste_box,
    "toothpaste_tube": toothpaste_tube,
}
