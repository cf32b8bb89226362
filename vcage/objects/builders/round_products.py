"""Round products of a shop: a tube, a jar and a slim can; each has its bar code on the label, to the right."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import pieces, solids
from vcage.objects.builders.mappings import around, from_above, tiled
from vcage.objects.builders.parts import BuiltObject, paint, variant_rng
from vcage.objects.textures import materials, prints
from vcage.objects.textures.labels import coded
from vcage.objects.textures.product_faces import brand, crisps, darker, fading, flash, sweets

CODE_AT = 0.75
"""Where a wrapped label faces to the right, as a share of its width."""


def chips_tube(variant: str) -> BuiltObject:
    """A cardboard tube of stacked potato crisps with a plastic lid."""
    rng = variant_rng("chips_tube", variant)
    flavour, ground = {
        "salted": ("SALTED", (206, 34, 40)),
        "onion": ("ONION", (46, 140, 74)),
        "paprika": ("PAPRIKA", (238, 126, 34)),
    }[variant]
    radius, height = 0.0325, 0.165
    tube = solids.revolved([(0, 0), (radius, 0), (radius, height - 0.01), (0, height - 0.01)], 40)
    lid_outline = [(0, height - 0.014), (radius + 0.001, height - 0.014), (radius + 0.001, height - 0.001)]
    lid_outline += [(radius, height), (radius - 0.004, height), (radius - 0.005, height - 0.002), (0, height - 0.002)]
    rim = solids.revolved([(0.02, 0), (radius + 0.0006, 0), (radius + 0.0006, 0.003), (0.02, 0.003)], 40)
    label = fading((1280, 960), ground, darker(ground, 0.75))
    for x in (0.0, 0.5, 1.0):
        label = brand(label, "KRUNCHO", (x, 0.2), 0.07, (255, 244, 200), darker(ground, 0.3))
        label = crisps(label, rng, (x, 0.42), 0.15)
        label = prints.text(label, flavour, (x, 0.72), 0.06, (255, 250, 236))
        label = prints.text(label, "potato crisps", (x, 0.8), 0.036, (255, 250, 236))
    label = coded(label, ("chips_tube", variant), (CODE_AT, 0.72))
    seal = prints.disc(prints.canvas(256, 256, (238, 238, 234)), (0.5, 0.5), 0.4, ground)
    seal = brand(seal, "KRUNCHO", (0.5, 0.5), 0.13, (255, 244, 200), darker(ground, 0.3))
    parts = [
        paint(tube, label, around(), roughness=0.5),
        paint(rim, materials.brushed(rng), tiled(0.05), roughness=0.35, metallic=0.4),
        paint(solids.revolved(lid_outline, 40), seal, from_above(), roughness=0.35),
    ]
    hulls = [
        pieces.stack([(radius + 0.0006, 0), (radius, 0.004), (radius, height - 0.013)]),
        pieces.stack([(radius + 0.001, height - 0.014), (radius + 0.001, height)]),
    ]
    return BuiltObject(parts, hulls, mass=0.13, friction=0.6)


def gum_jar(variant: str) -> BuiltObject:
    """A clear jar full of chewing gum with a wide screw lid."""
    rng = variant_rng("gum_jar", variant)
    words, ground, colours = {
        "mint": ("MINT", (40, 150, 150), [(236, 246, 244), (206, 236, 230), (180, 224, 220)]),
        "fruit": ("FRUIT", (226, 70, 130), [(236, 84, 84), (250, 200, 60), (116, 190, 84), (84, 150, 220)]),
    }[variant]
    radius, height, lid = 0.031, 0.088, 0.0215
    jar = [(0, 0), (radius - 0.003, 0), (radius, 0.003), (radius, height - lid - 0.006)]
    jar += [(radius - 0.004, height - lid + 0.002), (0, height - lid + 0.002)]
    low = height - lid
    cap = [(0, low), (radius - 0.001, low), (radius - 0.001, height - 0.0015), (radius - 0.003, height), (0, height)]
    ribbed = solids.cut(
        solids.revolved(cap, 48),
        *[
            solids.prism(solids.circle(0.0011, 6, (radius * np.cos(a), radius * np.sin(a))), 0.014, low + 0.002)
            for a in np.linspace(0, 2 * np.pi, 28, endpoint=False)
        ],
    )
    label_low, label_high = 0.011, 0.048
    band = [(0.02, label_low), (radius + 0.0003, label_low), (radius + 0.0003, label_high), (0.02, label_high)]
    label = prints.canvas(1280, 256, ground)
    label = prints.rectangle(label, (0, 0.05), (1, 0.09), (250, 250, 246))
    label = prints.rectangle(label, (0, 0.91), (1, 0.95), (250, 250, 246))
    for x in (0.0, 0.5, 1.0):
        label = brand(label, "BUBBO", (x, 0.34), 0.3, (255, 255, 250), darker(ground, 0.5))
        label = prints.text(label, f"{words} GUM", (x, 0.7), 0.18, (255, 255, 250))
    label = coded(label, ("gum_jar", variant), (CODE_AT, 0.5))
    top = materials.plastic(rng, (246, 246, 244), 256)
    top = prints.disc(top, (0.5, 0.5), 0.42, ground)
    top = brand(top, "GUM", (0.5, 0.5), 0.26, (255, 255, 250), darker(ground, 0.5))
    parts = [
        paint(solids.revolved(jar, 40), sweets(rng, (768, 256), colours, 0.07), around(), roughness=0.12),
        paint(solids.revolved(band, 40), label, around(), roughness=0.5),
        paint(ribbed, top, from_above(), roughness=0.4),
    ]
    hulls = [
        pieces.stack([(radius - 0.003, 0), (radius + 0.0003, 0.003), (radius + 0.0003, low - 0.006), (0.028, low)]),
        pieces.stack([(radius - 0.001, low), (radius - 0.001, height - 0.001), (radius - 0.002, height)]),
    ]
    return BuiltObject(parts, hulls, mass=0.15, friction=0.6)


def energy_drink(variant: str) -> BuiltObject:
    """A slim drink can with a necked top and a ring-pull."""
    rng = variant_rng("energy_drink", variant)
    name, ground, ink = {
        "volt": ("VOLTA", (24, 26, 30), (150, 230, 50)),
        "ice": ("GLACIO", (206, 214, 222), (30, 90, 190)),
        "berry": ("RUSH", (150, 24, 70), (255, 214, 90)),
    }[variant]
    radius, neck, height = 0.0265, 0.0235, 0.134
    can = [(0, 0.003), (0.0195, 0.003), (0.021, 0), (0.0225, 0), (radius, 0.009), (radius, height - 0.013)]
    can += [(neck, height - 0.003), (neck + 0.0006, height - 0.001), (neck, height), (neck - 0.0015, height)]
    can += [(neck - 0.002, height - 0.004), (0, height - 0.004)]
    band = [(0.015, 0.009), (radius + 0.0002, 0.009), (radius + 0.0002, height - 0.013), (0.015, height - 0.013)]
    label = fading((1024, 688), ground, darker(ground, 0.8))
    for x in (0.0, 0.5, 1.0):
        label = flash(label, (x, 0.6), 0.5, ink)
        label = brand(label, name, (x, 0.22), 0.115 if len(name) < 6 else 0.1, ink, darker(ground, 0.4))
        label = prints.text(label, "ENERGY DRINK", (x, 0.35), 0.045, ink)
    label = coded(label, ("energy_drink", variant), (CODE_AT, 0.72))
    pull = solids.prism(solids.circle(1.0, 20) * (0.0075, 0.011), 0.0012, height - 0.0042)
    pull = solids.cut(pull, solids.prism(solids.circle(1.0, 16, (0, -0.5)) * (0.0042, 0.005), 0.01, height - 0.006))
    tin = materials.brushed(rng, (214, 216, 220))
    parts = [
        paint(solids.revolved(can, 40), tin, tiled(0.05), roughness=0.3, metallic=0.4),
        paint(solids.revolved(band, 40), label, around(), roughness=0.3),
        paint(pull, materials.brushed(rng, (176, 178, 184)), tiled(0.02), roughness=0.3, metallic=0.4),
    ]
    outline = [(0.0225, 0), (radius, 0.009), (radius, height - 0.013), (neck + 0.0003, height - 0.003), (neck, height)]
    return BuiltObject(parts, [pieces.stack(outline)], mass=0.27, friction=0.6)


BUILDERS = {"chips_tube": chips_tube, "energy_drink": energy_drink, "gum_jar": gum_jar}
