"""Packed food: cans, bottles, cartons and shakers with labels."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import pieces, solids
from vcage.objects.builders.mappings import around, from_above, six_sides, tiled
from vcage.objects.builders.parts import BuiltObject, paint, variant_rng
from vcage.objects.textures import materials, prints
from vcage.objects.textures.labels import coded


def can(variant: str) -> BuiltObject:
    """A tin can with a paper label and a ribbed lid."""
    rng = variant_rng("can", variant)
    words, ground, spot = {
        "tomato": ("TOMATOES", (188, 36, 32), (236, 90, 60)),
        "corn": ("SWEET CORN", (34, 110, 62), (246, 206, 60)),
    }[variant]
    radius, height = 0.0325, 0.09
    rim = [(0, 0.0012), (radius - 0.002, 0.0012), (radius - 0.002, 0), (radius, 0), (radius, 0.003)]
    rim += [(radius - 0.0008, 0.0045), (radius - 0.0008, height - 0.0045), (radius, height - 0.003), (radius, height)]
    rim += [(radius - 0.002, height), (radius - 0.0026, height - 0.003), (0, height - 0.003)]
    tin = solids.revolved(rim, 36)
    paper = solids.revolved(
        [(0.02, 0.008), (radius - 0.0002, 0.008), (radius - 0.0002, height - 0.008), (0.02, height - 0.008)], 36
    )
    label = prints.canvas(1280, 480, ground)
    label = prints.rectangle(label, (0, 0.08), (1, 0.11), (246, 226, 170))
    label = prints.rectangle(label, (0, 0.89), (1, 0.92), (246, 226, 170))
    for x in (0.0, 0.5, 1.0):
        label = prints.disc(label, (x, 0.64), 0.15, spot)
        label = prints.text(label, words, (x, 0.32), 0.15 if variant == "tomato" else 0.12, (250, 244, 228))
    label = coded(label, ("can", variant), (0.75, 0.5))
    parts = [
        paint(tin, materials.brushed(rng), tiled(0.05), roughness=0.35, metallic=0.4),
        paint(paper, label, around(), roughness=0.6),
    ]
    return BuiltObject(parts, [pieces.stack([(radius, 0), (radius, height)])], mass=0.4, friction=0.6)


def bottle(variant: str) -> BuiltObject:
    """A small drink bottle with a screw cap."""
    rng = variant_rng("bottle", variant)
    drink, ground, words = {
        "juice": ((240, 150, 40), (250, 250, 246), "ORANGE"),
        "water": ((178, 212, 230), (40, 110, 180), "WATER"),
    }[variant]
    radius, shoulder, height = 0.03, 0.10, 0.142
    body = [(0, 0.002), (0.022, 0), (radius - 0.002, 0.001), (radius, 0.005), (radius, shoulder)]
    neck = solids.arc((0.013, shoulder), (radius - 0.013, 0.026), 8, 90, 7)
    body = np.concatenate([body, neck, [(0.0125, height - 0.014), (0, height - 0.014)]])
    cap = solids.revolved(
        [(0, height - 0.017), (0.0145, height - 0.017), (0.0145, height - 0.001), (0.0135, height), (0, height)], 24
    )
    band = solids.revolved([(0.02, 0.032), (radius + 0.0003, 0.032), (radius + 0.0003, 0.082), (0.02, 0.082)], 36)
    label = prints.canvas(512, 144, ground)
    ink = (226, 110, 20) if variant == "juice" else (250, 250, 250)
    for x in (0.0, 0.5, 1.0):
        label = prints.text(label, words, (x, 0.42), 0.24, ink)
        label = prints.rectangle(label, (max(0, x - 0.12), 0.68), (min(1, x + 0.12), 0.74), ink)
    parts = [
        paint(solids.revolved(body, 36), materials.plastic(rng, drink), tiled(0.08), roughness=0.15),
        paint(
            cap,
            materials.plastic(rng, (40, 130, 70) if variant == "juice" else (36, 84, 160)),
            tiled(0.05),
            roughness=0.4,
        ),
        paint(band, label, around(), roughness=0.5),
    ]
    hulls = [
        pieces.stack(
            [(radius, 0), (radius + 0.0003, 0.032), (radius + 0.0003, shoulder), (0.025, 0.1195), (0.0145, 0.126)]
        ),
        pieces.stack([(0.0145, 0.12), (0.0145, height)]),
    ]
    return BuiltObject(parts, hulls, mass=0.33, friction=0.6)


def milk_carton(variant: str) -> BuiltObject:
    """A small carton with a gabled top."""
    rng = variant_rng("milk_carton", variant)
    ground = {"whole": (44, 98, 180), "oat": (216, 190, 142)}[variant]
    side, wall, gable = 0.06, 0.1, 0.124
    body = solids.box((side, side, wall))
    outline = np.array([(-side / 2, 0), (side / 2, 0), (0.0012, gable - wall), (-0.0012, gable - wall)])
    roof = solids.moved(solids.prism(outline, side, -side / 2), turn=90, axis=(1, 0, 0))
    roof = solids.moved(roof, (0, 0, wall))
    fin = solids.box((0.0024, side, 0.014), (0, 0, gable - 0.001))
    words = "MILK" if variant == "whole" else "OAT"
    face = prints.canvas(384, 640, (246, 246, 242))
    face = prints.rectangle(face, (0, 0.52), (1, 1), ground)
    face = prints.text(face, words, (0.5, 0.3), 0.16, tuple(int(0.6 * c) for c in ground))
    face = prints.disc(face, (0.5, 0.74), 0.11, (250, 250, 246))
    sides = dict.fromkeys(("front", "back", "left"), face)
    sides["right"] = coded(face, ("milk_carton", variant), (0.5, 0.72))
    carton = prints.atlas(sides, (246, 246, 242), (384, 640))
    parts = [
        paint(body, carton, six_sides(), roughness=0.6),
        paint(roof, materials.plastic(rng, (244, 244, 240)), tiled(0.1), roughness=0.6),
        paint(fin, materials.plastic(rng, ground), tiled(0.1), roughness=0.6),
    ]
    return BuiltObject(parts, [body, roof.convex_hull, fin], mass=0.3, friction=0.6)


def tea_box(variant: str) -> BuiltObject:
    """A closed cardboard box of tea bags."""
    rng = variant_rng("tea_box", variant)
    ground, words = {"green": (70, 124, 70), "black": (120, 40, 36)}[variant], variant.upper()
    size = (0.1, 0.062, 0.068)
    front = materials.plastic(rng, ground, 256)
    front = prints.rectangle(front, (0.08, 0.14), (0.92, 0.86), (244, 232, 204))
    front = prints.text(front, words, (0.5, 0.35), 0.17, tuple(int(0.7 * c) for c in ground))
    front = prints.text(front, "TEA", (0.5, 0.62), 0.26, tuple(int(0.7 * c) for c in ground))
    top = prints.text(materials.plastic(rng, ground, 256), "TEA", (0.5, 0.5), 0.34, (244, 232, 204))
    cell = (384, 384)
    end = coded(prints.canvas(*cell, ground), ("tea_box", variant), (0.5, 0.55))
    picture = prints.atlas({"front": front, "back": front, "top": top, "right": end}, ground, cell)
    box = solids.rounded_box(size, 0.0012, steps=2)
    return BuiltObject([paint(box, picture, six_sides(), roughness=0.6)], [solids.box(size)], mass=0.12, friction=0.6)


def salt_shaker(variant: str) -> BuiltObject:
    """A shaker with a metal top; salt is white, pepper dark."""
    rng = variant_rng("salt_shaker", variant)
    colour, letter = {"salt": ((240, 240, 238), "S"), "pepper": ((58, 52, 50), "P")}[variant]
    body = [(0, 0), (0.019, 0), (0.0205, 0.002), (0.0195, 0.012), (0.0165, 0.036), (0.0158, 0.056), (0, 0.056)]
    cap = np.concatenate(
        [[(0, 0.055), (0.0165, 0.055), (0.0168, 0.064)], solids.arc((0, 0.064), (0.0165, 0.012), 10, 90, 7)]
    )
    ink = (60, 60, 64) if variant == "salt" else (230, 230, 226)
    print_ = materials.plastic(rng, colour, 256)
    for x in (0.25, 0.5, 0.75):
        print_ = prints.text(print_, letter, (x, 0.5), 0.3, ink)
    holes = materials.brushed(rng)
    for i in range(7):
        turn = 2 * np.pi * i / 6
        at = (0.5, 0.5) if i == 6 else (0.5 + 0.2 * np.cos(turn), 0.5 + 0.2 * np.sin(turn))
        holes = prints.disc(holes, at, 0.04, (30, 30, 32))
    parts = [
        paint(solids.revolved(body, 32), print_, around(), roughness=0.25),
        paint(solids.revolved(cap, 32), holes, from_above(), roughness=0.3, metallic=0.4),
    ]
    hulls = [
        pieces.stack([(0.019, 0), (0.0205, 0.002), (0.0195, 0.012), (0.0165, 0.036)]),
        pieces.stack([(0.0165, 0.034), (0.0168, 0.064), (0.0120, 0.0725), (0.004, 0.0758)]),
    ]
    return BuiltObject(parts, hulls, mass=0.12, friction=0.6)


BUILDERS = {"bottle": bottle, "can": can, "milk_carton": milk_carton, "salt_shaker": salt_shaker, "tea_box": tea_box}
