"""Jars and squeeze bottles with labels."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import lumps, pieces, solids
from vcage.objects.builders.mappings import around, from_above, tiled
from vcage.objects.builders.parts import BuiltObject, Mapping, paint, variant_rng
from vcage.objects.textures import kitchen, materials, prints
from vcage.objects.textures.noise import Colour


def jam_jar(variant: str) -> BuiltObject:
    """A jar of jam, 0.064 m across and 0.086 m high, with a checked lid."""
    rng = variant_rng("jam_jar", variant)
    words, jam, bits, checks, motif = {
        "strawberry": ("STRAWBERRY", (168, 22, 34), (206, 48, 44), (196, 36, 44), kitchen.strawberry()),
        "apricot": ("APRICOT", (224, 126, 26), (244, 164, 60), (226, 140, 40), kitchen.round_fruit((240, 150, 50))),
        "blueberry": ("BLUEBERRY", (56, 30, 78), (34, 24, 66), (62, 82, 150), kitchen.round_fruit((70, 84, 160))),
    }[variant]
    radius, shoulder = 0.032, 0.064
    glass = [(0, 0.0015), (0.024, 0), (0.03, 0.002), (radius, 0.006), (radius, shoulder - 0.006)]
    glass = np.concatenate(
        [glass, solids.arc((radius - 0.006, shoulder - 0.006), 0.006, 10, 80, 5), [(0.026, 0.068), (0, 0.068)]]
    )
    lid = [
        (0, 0.066),
        (0.0285, 0.066),
        (0.0295, 0.068),
        (0.0295, 0.083),
        (0.028, 0.0855),
        (0.0255, 0.086),
        (0.0245, 0.0852),
        (0, 0.0852),
    ]
    side = [(0.02, 0.067), (0.02975, 0.067), (0.02975, 0.0815), (0.02, 0.0815)]
    band = [(0.02, 0.011), (radius + 0.0003, 0.011), (radius + 0.0003, 0.053), (0.02, 0.053)]
    label = kitchen.jar_label((words, "JAM  340 g"), (250, 244, 228), (110, 40, 36), motif)
    cloth = kitchen.gingham(rng, checks)
    parts = [
        paint(solids.revolved(glass, 44), kitchen.syrup(rng, jam, bits), tiled(0.08), roughness=0.12),
        paint(solids.revolved(lid, 44), cloth, from_above(), roughness=0.45),
        paint(solids.revolved(side, 44), kitchen.gingham(rng, checks, 4), _ribbon(4), roughness=0.45),
        paint(solids.revolved(band, 44), label, around(), roughness=0.6),
    ]
    hulls = [
        pieces.stack([(0.03, 0), (radius, 0.006), (radius, shoulder - 0.004), (0.028, 0.066)]),
        pieces.stack([(0.0295, 0.066), (0.0295, 0.083), (0.0265, 0.086)]),
    ]
    return BuiltObject(parts, hulls, mass=0.45, friction=0.6)


def honey_jar(variant: str) -> BuiltObject:
    """A six-sided jar of honey, 0.062 m across its flats and 0.09 m high, with a golden lid."""
    rng = variant_rng("honey_jar", variant)
    words, honey = {
        "blossom": ("BLOSSOM", (236, 160, 30)),
        "forest": ("FOREST", (130, 66, 20)),
        "cream": ("CREAMED", (240, 214, 150)),
    }[variant]
    apothem, shoulder, height = 0.031, 0.062, 0.09
    six = _hexagon(apothem)
    levels = [
        (0.9, 0.0),
        (0.985, 0.002),
        (1.0, 0.005),
        (1.0, shoulder - 0.004),
        (0.95, shoulder),
        (0.84, shoulder + 0.005),
    ]
    body = solids.closed_rings([np.column_stack([six * s, np.full(6, z)]) for s, z in levels])
    lid = [
        (0, 0.066),
        (0.0268, 0.066),
        (0.028, 0.068),
        (0.028, height - 0.002),
        (0.0265, height),
        (0.0245, height - 0.0008),
        (0, height - 0.0008),
    ]
    golden = prints.disc(materials.plastic(rng, (206, 160, 58), 192), (0.5, 0.5), 0.4, (226, 184, 84))
    golden = kitchen.stamped(golden, kitchen.bee(), (0.5, 0.5), 0.5)
    parts = [
        paint(body, kitchen.syrup(rng, honey), tiled(0.1), roughness=0.1, crease=25),
        paint(solids.revolved(lid, 40), golden, from_above(), roughness=0.3, metallic=0.2),
    ]
    front = prints.canvas(192, 224, (252, 240, 206))
    front = prints.rectangle(front, (0, 0), (1, 0.05), (176, 110, 24))
    front = prints.rectangle(front, (0, 0.95), (1, 1), (176, 110, 24))
    front = kitchen.stamped(front, kitchen.bee(), (0.5, 0.3), 0.44)
    front = prints.text(front, "HONEY", (0.5, 0.64), 0.2, (96, 52, 14))
    front = prints.text(front, words, (0.5, 0.83), 0.11, (140, 84, 24))
    parts += [paint(_panel(turn, apothem), front, _panel_mapping(turn), roughness=0.6) for turn in (0, 120, 240)]
    hulls = [
        pieces.hull(*[np.column_stack([six * s, np.full(6, z)]) for s, z in levels]),
        pieces.stack([(0.0268, 0.064), (0.028, 0.068), (0.028, height - 0.002), (0.0265, height)]),
    ]
    return BuiltObject(parts, hulls, mass=0.5, friction=0.6)


def ketchup_bottle(variant: str) -> BuiltObject:
    """A squeeze bottle of ketchup, oval, 0.168 m high, with a flip cap."""
    rng = variant_rng("ketchup_bottle", variant)
    colour, cap_colour, small = {
        "classic": ((186, 26, 22), (244, 242, 236), "TOMATO"),
        "spicy": ((150, 16, 18), (36, 34, 34), "HOT & SPICY"),
        "organic": ((196, 40, 26), (66, 134, 62), "ORGANIC"),
    }[variant]
    half, depth = 0.031, 0.023
    knots = [
        (0.9, 0),
        (0.985, 0.003),
        (1.0, 0.01),
        (1.0, 0.04),
        (0.93, 0.068),
        (0.97, 0.092),
        (0.95, 0.106),
        (0.74, 0.122),
    ]
    knots += [(0.5, 0.13), (0.46, 0.134)]
    levels = lumps.smooth(knots, 26)
    oval = solids.circle(1.0, 40)
    rings = [np.column_stack([oval * _oval_size(s, half, depth), np.full(40, z)]) for s, z in levels]
    body = solids.closed_rings(rings)
    cap = [
        (0, 0.129),
        (0.0185, 0.129),
        (0.0195, 0.131),
        (0.0185, 0.151),
        (0.0165, 0.154),
        (0.0095, 0.156),
        (0.0075, 0.165),
    ]
    cap += [(0.0055, 0.168), (0, 0.168)]
    label = _ketchup_label(small, colour, cap_colour)
    wrap = solids.closed_rings([ring * (1.012, 1.016, 1) for ring in rings[6:15]])
    parts = [
        paint(body, materials.plastic(rng, colour), tiled(0.1), roughness=0.22),
        paint(wrap, label, around(), roughness=0.45),
        paint(solids.revolved(cap, 36), materials.plastic(rng, cap_colour), tiled(0.05), roughness=0.4),
    ]
    hulls = pieces.chain([rings[i] * (1.008, 1.01, 1) if 6 <= i < 15 else rings[i] for i in (0, 8, 13, 19, 25)])
    hulls[0] = pieces.hull(*rings[:8:2], rings[8] * (1.008, 1.01, 1))
    hulls.append(pieces.stack([(0.0185, 0.129), (0.0195, 0.131), (0.0185, 0.151), (0.0165, 0.154)]))
    hulls.append(pieces.stack([(0.0105, 0.153), (0.0075, 0.165), (0.0055, 0.168)], 8))
    return BuiltObject(parts, hulls, mass=0.42, friction=0.6)


def _ketchup_label(small: str, colour: Colour, accent: Colour) -> np.ndarray:
    """White with a red band, the word, and a tomato; in front and at the back."""
    label = prints.canvas(768, 250, (250, 246, 236))
    accent = accent if sum(accent) < 600 else (196, 150, 60)
    for low, high in ((0.0, 0.05), (0.95, 1.0)):
        label = prints.rectangle(label, (0, low), (1, high), accent)
    for x in (0.25, 0.75):
        label = prints.text(label, "KETCHUP", (x, 0.26), 0.19, colour)
        label = prints.text(label, small, (x, 0.85), 0.11, accent)
        label = prints.disc(label, (x, 0.58), 0.15, (210, 40, 30))
        label = prints.disc(label, (x - 0.02, 0.52), 0.03, (244, 170, 150))
        label = prints.rectangle(label, (x - 0.022, 0.42), (x + 0.022, 0.45), (60, 130, 50))
        label = prints.rectangle(label, (x - 0.004, 0.38), (x + 0.004, 0.45), (60, 130, 50))
    return np.roll(label, 192, axis=1)


def _oval_size(scale: float, half: float, depth: float) -> np.ndarray:
    """Half widths of a bottle's section, never flatter than its neck is round."""
    return np.array([half * scale, max(depth * scale, min(half * scale, 0.0165))])


def _hexagon(apothem: float) -> np.ndarray:
    """(6, 2) corners, counter-clockwise, with flats to the front and to the back."""
    angle = np.radians(np.arange(6) * 60)
    return np.stack([np.cos(angle), np.sin(angle)], axis=1) * apothem / np.cos(np.pi / 6)


def _panel(turn: float, apothem: float) -> solids.Solid:
    """A thin label on one flat of the hexagonal jar; 0 is the front."""
    return solids.moved(solids.box((0.0335, 0.0006, 0.04), (0, -apothem, 0.011)), turn=turn)


def _panel_mapping(turn: float) -> Mapping:
    """The picture upright on a panel that was turned about the z axis."""

    def mapping(corners: np.ndarray, _normals: np.ndarray) -> np.ndarray:
        angle = np.radians(turn)
        across = corners[..., 0] * np.cos(angle) + corners[..., 1] * np.sin(angle)
        return np.stack([across / 0.0335 + 0.5, (corners[..., 2] - 0.011) / 0.04], axis=-1)

    return mapping


def _ribbon(period: int) -> Mapping:
    """Repeats a square picture around a lid's side; ``period`` times on each third of the way."""
    wrap = around()

    def mapping(corners: np.ndarray, normals: np.ndarray) -> np.ndarray:
        return wrap(corners, normals) * (3 * period, 1)

    return mapping


BUILDERS = {"honey_jar": honey_jar, "jam_jar": jam_jar, "ketchup_bottle": ketchup_bottle}
