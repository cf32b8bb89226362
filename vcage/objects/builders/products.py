"""Cartons and wrapped bars of a shop; each has the bar code of its own number, cartons on the right side."""

from __future__ import annotations

from vcage.objects.builders import pieces, solids
from vcage.objects.builders.mappings import six_sides, tiled
from vcage.objects.builders.parts import BuiltObject, paint, variant_rng
from vcage.objects.textures import materials, prints
from vcage.objects.textures.labels import coded
from vcage.objects.textures.product_faces import (
    CREAM,
    brand,
    chocolate_pieces,
    cookie,
    darker,
    ellipse,
    facts,
    fading,
    flakes,
    fruit,
)


def cereal_box(variant: str) -> BuiltObject:
    """A small box of breakfast cereals that stands, 0.13 m wide and 0.18 m high."""
    rng = variant_rng("cereal_box", variant)
    name, kind, ground, cereals = {
        "honey": ("HONEY", "FLAKES", (244, 190, 44), [(224, 150, 50), (238, 176, 80), (206, 128, 40)]),
        "cocoa": ("COCOA", "RINGS", (112, 62, 36), [(96, 56, 32), (124, 74, 44), (80, 46, 28)]),
        "fruit": ("FRUIT", "RINGS", (58, 152, 206), [(236, 84, 84), (250, 200, 60), (116, 190, 84), (246, 150, 60)]),
    }[variant]
    size, cell = (0.13, 0.052, 0.18), (384, 532)
    light = tuple(min(255, int(c + 0.4 * (255 - c))) for c in ground)
    front = fading(cell, ground, light)
    front = prints.disc(front, (0.5, 0.74), 0.33, tuple(min(255, int(c + 0.6 * (255 - c))) for c in ground))
    front = flakes(front, rng, cereals, ring=kind == "RINGS")
    edge = darker(ground, 0.35)
    front = brand(front, name, (0.5, 0.14), 0.125, CREAM, edge)
    front = brand(front, kind, (0.5, 0.31), 0.125, CREAM, edge)
    side = facts(cell, ground, ("cereal_box", variant), module=3, share=0.3)
    top = brand(prints.canvas(384, 154, ground), f"{name} {kind}", (0.5, 0.5), 0.26, CREAM, edge)
    sides = {"front": front, "back": front, "right": side, "left": side, "top": top}
    box = solids.rounded_box(size, 0.0012, steps=2)
    part = paint(box, prints.atlas(sides, ground, cell), six_sides(), roughness=0.5)
    return BuiltObject([part], [solids.box(size)], mass=0.22, friction=0.6)


def juice_carton(variant: str) -> BuiltObject:
    """A half-litre brick carton of juice with a screw cap on its flat top."""
    rng = variant_rng("juice_carton", variant)
    name, ground, cap_colour = {
        "apple": ("APPLE", (142, 190, 66), (74, 130, 50)),
        "orange": ("ORANGE", (250, 170, 50), (226, 110, 30)),
        "cherry": ("CHERRY", (190, 40, 76), (120, 20, 50)),
    }[variant]
    size, cell = (0.066, 0.058, 0.14), (320, 640)
    front = prints.canvas(*cell, (250, 250, 244))
    front = ellipse(front, (0.5, 0.0), (0.4, 0.33), ground)
    front = prints.rectangle(front, (0, 0.9), (1, 1), ground)
    front = brand(front, name, (0.5, 0.11), 0.088 if len(name) < 6 else 0.075, (255, 255, 250), darker(ground, 0.7))
    front = brand(front, "JUICE", (0.5, 0.235), 0.06, (255, 255, 250), darker(ground, 0.7))
    front = fruit(front, variant, (0.5, 0.6), 0.15)
    front = prints.text(front, "500 ml", (0.5, 0.945), 0.04, (255, 255, 250))
    side = facts(cell, ground, ("juice_carton", variant))
    sides = {"front": front, "back": front, "right": side, "left": side}
    body = solids.rounded_box(size, 0.0015, steps=2)
    at = (0, 0.008)
    cap = solids.moved(solids.revolved([(0, 0), (0.0135, 0), (0.0135, 0.011), (0.0125, 0.0125), (0, 0.0125)], 24))
    collar = solids.revolved([(0, 0), (0.017, 0), (0.0165, 0.003), (0, 0.003)], 24)
    parts = [
        paint(body, prints.atlas(sides, ground, cell), six_sides(), roughness=0.45),
        paint(solids.moved(collar, (*at, size[2] - 0.0005)), materials.plastic(rng, (246, 246, 244)), tiled(0.05)),
        paint(
            solids.moved(cap, (*at, size[2] + 0.002)),
            materials.plastic(rng, cap_colour),
            tiled(0.05),
            roughness=0.4,
        ),
    ]
    hulls = [
        solids.box(size),
        pieces.stack([(0.0165, size[2] - 0.001), (0.0165, size[2] + 0.0025)], centre=at),
        pieces.stack([(0.0135, size[2] + 0.002), (0.0135, size[2] + 0.0145)], centre=at),
    ]
    return BuiltObject(parts, hulls, mass=0.5, friction=0.6)


def cookie_box(variant: str) -> BuiltObject:
    """A flat-lying carton of cookies, 0.17 m long, with their picture on top."""
    rng = variant_rng("cookie_box", variant)
    dark = variant == "cream"
    name, ground = {"cream": ("CREAM DUOS", (38, 74, 150)), "chip": ("CHOCO CHIP", (222, 168, 96))}[variant]
    ink, edge = ((255, 255, 250), (20, 36, 84)) if dark else ((255, 250, 236), (110, 58, 24))
    size, cell = (0.17, 0.06, 0.05), (768, 272)
    top = fading(cell, ground, darker(ground, 0.8))
    for x, y in ((0.82, 0.44), (0.93, 0.72), (0.72, 0.74)):
        top = cookie(top, rng, (x, y), 0.27, dark=dark)
    first, second = name.split()
    top = brand(top, first, (0.31, 0.32), 0.3, ink, edge)
    top = brand(top, second, (0.31, 0.68), 0.3, ink, edge)
    front = brand(prints.canvas(*cell, ground), name, (0.4, 0.5), 0.28, ink, edge)
    front = cookie(front, rng, (0.87, 0.5), 0.36, dark=dark)
    # The end is almost square but its cell is long, so the code is drawn wide and flat.
    end = coded(prints.canvas(*cell, ground), ("cookie_box", variant), (0.5, 0.5), module=5, share=0.33)
    sides = {"front": front, "back": front, "top": top, "bottom": top, "left": end, "right": end}
    box = solids.rounded_box(size, 0.0012, steps=2)
    part = paint(box, prints.atlas(sides, ground, cell), six_sides(), roughness=0.45)
    return BuiltObject([part], [solids.box(size)], mass=0.2, friction=0.6)


def chocolate_bar(variant: str) -> BuiltObject:
    """A thick chocolate bar in a foil wrapper with crimped ends, lying along x."""
    name, ground, ink = {
        "milk": ("MILKY", (96, 60, 140), (250, 236, 200)),
        "dark": ("NOIR 70%", (54, 34, 26), (226, 184, 96)),
        "nut": ("NUTTY", (200, 48, 40), (255, 240, 200)),
    }[variant]
    length, width, height, seam = 0.128, 0.046, 0.024, 0.011
    body = solids.rounded_box((length, width, height), 0.007, steps=4)
    ends = [_crimped_end(side, length / 2 - 0.003, width, height, seam) for side in (-1, 1)]
    wrapper = solids.union(body, *ends)
    picture = fading((896, 288), darker(ground, 1.2), darker(ground, 0.85))
    picture = prints.rectangle(picture, (0, 0.16), (1, 0.19), ink)
    picture = prints.rectangle(picture, (0, 0.81), (1, 0.84), ink)
    picture = brand(picture, name, (0.4, 0.5), 0.34 if len(name) < 6 else 0.27, ink, darker(ground, 0.4))
    picture = chocolate_pieces(picture, (0.74, 0.5))
    for x in (0.0, 0.93):
        for i in range(8):
            at = x + 0.009 * i
            picture = prints.rectangle(picture, (at, 0), (at + 0.004, 1), darker(ground, 0.6))
    letters = 0.4 if len(name) < 6 else 0.27
    front = brand(prints.canvas(896, 288, ground), name, (0.3, 0.5), letters, ink, darker(ground, 0.4))
    front = coded(front, ("chocolate_bar", variant), (0.7, 0.5))
    sides = {"front": front, "back": front, "top": picture}
    part = paint(wrapper, prints.atlas(sides, ground, (896, 288)), six_sides(), roughness=0.3, crease=30)
    hulls = [body.convex_hull, *ends]
    return BuiltObject([part], hulls, mass=0.1, friction=0.6)


def _crimped_end(side: int, start: float, width: float, height: float, seam: float) -> solids.Solid:
    """The pressed end of a wrapper: thick where it leaves the bar, thin at its edge."""
    middle = height / 2
    inner = [(side * start, y, middle + z) for y in (-0.42 * width, 0.42 * width) for z in (-0.004, 0.004)]
    outer = [(side * (start + seam), y, middle + z) for y in (-0.48 * width, 0.48 * width) for z in (-0.0008, 0.0008)]
    return pieces.hull(inner, outer)


BUILDERS = {
    "cereal_box": cereal_box,
    "chocolate_bar": chocolate_bar,
    "cookie_box": cookie_box,
    "juice_carton": juice_carton,
}
