"""Machines of a checkout: scale, bar code scanner, card terminal and receipt printer."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from vcage.objects.builders import pieces, solids
from vcage.objects.builders.mappings import from_above, from_front, six_sides, tiled
from vcage.objects.builders.parts import BuiltObject, Mapping, paint, variant_rng
from vcage.objects.textures import labels, materials, prints, till_faces

GREEN_GLASS, GREEN_INK = (176, 196, 156), (36, 46, 36)
"""Ground and segments of a liquid-crystal display."""


def electronic_scale(variant: str) -> BuiltObject:
    """A shop scale: a steel platform of 0.18 × 0.15 m behind a console with display and keys."""
    rng = variant_rng("electronic_scale", variant)
    colour, ink = {
        "white": ((232, 232, 228), (50, 54, 60)),
        "black": ((44, 46, 50), (230, 230, 226)),
        "blue": ((52, 98, 156), (240, 240, 236)),
    }[variant]
    width, front, gap, edge, back = 0.18, -0.115, -0.063, -0.037, 0.115
    base = solids.rounded_box((width - 0.004, back - front, 0.018), 0.005, (0, (front + back) / 2, 0.0))
    low, high = (front + 0.002, 0.026), (gap - 0.01, 0.046)
    outline = [(front + 0.002, 0.01), (gap, 0.01), (gap, 0.044), (gap - 0.003, 0.046), high, low]
    console = _along_x(outline, width)
    neck = solids.box((0.11, 0.09, 0.015), (0, (edge + back) / 2, 0.014))
    plate = solids.rounded_box((width, back - edge, 0.007), 0.003, (0, (edge + back) / 2, 0.0275), steps=4)
    unit = prints.text(prints.canvas(64, 144, GREEN_GLASS), "kg", (0.42, 0.68), 0.26, GREEN_INK)
    reading = labels.display("0.00", (320, 144), GREEN_INK, GREEN_GLASS, cells=4)
    screen = till_faces.framed(np.hstack([reading, unit]), (28, 30, 34))
    parts = [
        paint(solids.union(base, console), materials.plastic(rng, colour), tiled(0.1), roughness=0.5),
        paint(neck, materials.plastic(rng, (60, 62, 66)), tiled(0.1), roughness=0.6),
        paint(plate, materials.brushed(rng, (204, 206, 210)), tiled(0.12), roughness=0.3, metallic=0.4),
        paint(_on_slope((0.084, 0.036, 0.002), low, high, -0.028), screen, from_above(), roughness=0.2),
    ]
    for x, words, ground in ((0.036, "ON", (70, 160, 90)), (0.067, "TARE", (226, 130, 40))):
        cap = prints.text(prints.canvas(96, 72, ground), words, (0.5, 0.5), 0.36, (255, 255, 250))
        key = _on_slope((0.024, 0.018, 0.004), low, high, x, 0.35, radius=0.0015)
        parts.append(paint(key, cap, from_above(), roughness=0.5))
        dark = prints.text(prints.canvas(96, 40, colour), "MAX 3 kg" if x < 0.05 else "d=1 g", (0.5, 0.5), 0.5, ink)
        parts.append(paint(_on_slope((0.026, 0.01, 0.0012), low, high, x, 0.8), dark, from_above()))
    hulls = [base.convex_hull, console.convex_hull, neck, solids.box(plate.extents, (0, (edge + back) / 2, 0.0275))]
    return BuiltObject(parts, hulls, mass=0.5, friction=0.7)


def barcode_scanner(variant: str) -> BuiltObject:
    """A cordless pistol scanner that lies on its side: the window looks left, the handle points to the front."""
    rng = variant_rng("barcode_scanner", variant)
    colour, guard, trigger = {
        "black": ((46, 48, 52), (70, 72, 78), (200, 50, 44)),
        "yellow": ((60, 62, 66), (246, 196, 40), (246, 196, 40)),
        "white": ((228, 228, 224), (96, 104, 112), (60, 120, 190)),
    }[variant]
    head_outline = [(-0.052, 0.018), (0.03, 0.022), (0.052, 0.028), (0.058, 0.042), (0.05, 0.056), (-0.052, 0.064)]
    head = _pillow(head_outline, 0.042, 0.006)
    bumper = _pillow([(-0.066, 0.013), (-0.046, 0.015), (-0.046, 0.066), (-0.066, 0.069)], 0.044, 0.005)
    handle = _pillow([(0.016, 0.03), (0.032, -0.084), (0.066, -0.078), (0.051, 0.032)], 0.036, 0.007)
    lever = _pillow([(0.004, 0.022), (0.013, -0.012), (0.022, -0.01), (0.02, 0.022)], 0.016, 0.002, z=0.012)
    window = solids.box((0.0012, 0.042, 0.026), (-0.0663, 0.041, 0.009))
    glass = prints.canvas(64, 64, (70, 8, 12))
    glass = prints.rectangle(glass, (0, 0.46), (1, 0.56), (255, 60, 50))
    label = prints.canvas(512, 214, colour)
    label = prints.text(label, "SCANZO", (0.54, 0.53), 0.24, (236, 236, 232) if variant != "white" else (50, 60, 70))
    label = prints.rectangle(label, (0.12, 0.3), (0.24, 0.82), (250, 250, 248))
    label = till_faces.bars(label, (0.135, 0.36), (0.225, 0.76))
    label = prints.disc(label, (0.87, 0.53), 0.09, (80, 220, 110))
    grip = materials.felt(rng, tuple(int(0.8 * c) for c in colour), 128)
    parts = [
        paint(head, label, from_above(), roughness=0.5),
        paint(bumper, materials.plastic(rng, guard), tiled(0.05), roughness=0.6),
        paint(handle, grip, tiled(0.05), roughness=0.8),
        paint(lever, materials.plastic(rng, trigger), tiled(0.05), roughness=0.5),
        paint(window, glass, from_front(), roughness=0.1),
    ]
    return BuiltObject(parts, [head, bumper, handle, lever], mass=0.19, friction=0.7)


def card_terminal(variant: str) -> BuiltObject:
    """A payment terminal, 0.064 m wide, that rises to the back: keys in front, screen behind, a slip at the end."""
    rng = variant_rng("card_terminal", variant)
    colour, key_colour = {"black": ((50, 52, 58), (78, 82, 90)), "white": ((234, 234, 230), (196, 198, 202))}[variant]
    width, front, back = 0.064, -0.08, 0.08
    low, high = (front + 0.002, 0.024), (back - 0.02, 0.052)
    outline = [(front + 0.002, 0), (back - 0.002, 0), (back, 0.004), (back, 0.036), (back - 0.006, 0.048), high]
    outline += [low, (front, 0.02), (front, 0.003)]
    body = _along_x(outline, width)
    parts = [
        paint(body, materials.plastic(rng, colour), tiled(0.1), roughness=0.45, crease=25),
        paint(
            _on_slope((0.054, 0.048, 0.0016), low, high, 0, 0.76),
            till_faces.payment_screen(),
            from_above(),
            roughness=0.15,
        ),
    ]
    for i, key in enumerate("123456789*0#XCO"):
        row, column = divmod(i, 3)
        ground = {"X": (206, 50, 44), "C": (236, 186, 40), "O": (60, 160, 80)}.get(key, key_colour)
        light = sum(ground) < 420
        cap = prints.text(prints.canvas(64, 44, ground), key, (0.5, 0.5), 0.62, (250,) * 3 if light else (40, 42, 46))
        share = 0.5 - 0.095 * row
        button = _on_slope((0.0145, 0.0095, 0.0036), low, high, -0.0175 + 0.0175 * column, share, radius=0.0014)
        parts.append(paint(button, cap, from_above(), roughness=0.5))
    slot = solids.box((0.046, 0.004, 0.004), (0, front - 0.0015, 0.011))
    card = solids.box((0.044, 0.0016, 0.016), (0, back - 0.0115, 0.046))
    parts += [
        paint(slot, materials.plastic(rng, (24, 24, 26)), tiled(0.05), roughness=0.5),
        paint(card, till_faces.receipt((256, 96), rows=2), from_front(), roughness=0.9),
    ]
    return BuiltObject(parts, [body.convex_hull, slot, card], mass=0.3, friction=0.7)


def receipt_printer(variant: str) -> BuiltObject:
    """A narrow counter printer with a printed receipt that curls out of its top to the front."""
    rng = variant_rng("receipt_printer", variant)
    colour = {"black": (52, 54, 58), "white": (230, 230, 226)}[variant]
    width, depth, height, paper = 0.112, 0.062, 0.08, 0.048
    body = solids.rounded_box((width, depth, height), 0.006)
    lid = solids.rounded_box((width - 0.012, 0.032, 0.005), 0.002, (0, 0.0125, height - 0.002))
    mouth = solids.box((paper + 0.008, 0.008, 0.0014), (0, -0.0095, height - 0.0004))
    front = prints.canvas(384, 256, colour)
    ink = (236, 236, 232) if variant == "black" else (60, 64, 70)
    front = prints.text(front, "PRINTIX", (0.36, 0.78), 0.09, ink)
    front = prints.rectangle(front, (0.04, 0.3), (0.96, 0.32), tuple(int(0.6 * c) for c in colour))
    for x, light in ((0.7, (80, 220, 110)), (0.78, (240, 170, 50)), (0.9, (60, 130, 220))):
        front = prints.disc(front, (x, 0.78), 0.022 if x < 0.85 else 0.045, light)
    curl = np.concatenate(
        [solids.arc((-0.0275, height + 0.001), 0.018, 0, 160, 9), [(-0.0462, 0.07), (-0.0455, 0.056)]]
    )
    strip, sections = _strip(curl, paper, 0.0012)
    parts = [
        paint(body, prints.atlas({"front": front}, colour, (384, 256)), six_sides(), roughness=0.5),
        paint(lid, materials.plastic(rng, tuple(int(0.85 * c) for c in colour)), tiled(0.05), roughness=0.5),
        paint(mouth, materials.plastic(rng, (20, 20, 22)), tiled(0.05), roughness=0.6),
        paint(strip, till_faces.receipt((256, 352), rows=8), _down(curl), roughness=0.9),
    ]
    return BuiltObject(parts, [body.convex_hull, lid.convex_hull, *pieces.chain(sections)], mass=0.35, friction=0.7)


def _along_x(outline: list[tuple[float, float]], width: float) -> solids.Solid:
    """A side view (y, z), counter-clockwise as seen from the right, drawn out along x."""
    return solids.moved(solids.prism(outline, width, -width / 2), turn=120, axis=(1, 1, 1))


def _on_slope(
    size: tuple[float, float, float],
    low: tuple[float, float],
    high: tuple[float, float],
    x: float,
    share: float = 0.5,
    radius: float = 0.0004,
) -> solids.Solid:
    """A plate whose lower half is sunk into a slope that rises to the back.

    Args:
        size: width, length up the slope, thickness.
        low, high: ends (y, z) of the slope.
        x, share: where the plate's middle lies, ``share`` of the way up.
    """
    (y0, z0), (y1, z1) = low, high
    plate = solids.rounded_box(size, radius, (0, 0, -size[2] / 2), steps=1)
    middle = (x, y0 + share * (y1 - y0), z0 + share * (z1 - z0))
    return solids.moved(plate, middle, turn=float(np.degrees(np.arctan2(z1 - z0, y1 - y0))), axis=(1, 0, 0))


def _pillow(outline: list[tuple[float, float]], height: float, bevel: float, z: float = 0.0) -> solids.Solid:
    """A convex outline raised by ``height`` from ``z``, narrower by ``bevel`` at its top and bottom."""
    points = np.asarray(outline, dtype=np.float64)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    inner = middle + (points - middle) * (1 - 2 * bevel / np.ptp(points, axis=0))
    mid = middle + (points - middle) * (1 - 0.6 * bevel / np.ptp(points, axis=0))
    levels = [(0, inner), (0.3 * bevel, mid), (bevel, points), (height - bevel, points)]
    levels += [(height - 0.3 * bevel, mid), (height, inner)]
    return pieces.hull(*[np.column_stack([ring, np.full(len(ring), z + level)]) for level, ring in levels])


def _strip(curve: np.ndarray, width: float, thickness: float) -> tuple[solids.Solid, list[np.ndarray]]:
    """A band along x over a curve (n, 2) of y and z; the solid, and its sections (4, 3) along the curve."""
    forward = np.gradient(curve, axis=0)
    forward /= np.linalg.norm(forward, axis=1, keepdims=True)
    offset = np.stack([forward[:, 1], -forward[:, 0]], axis=1) * thickness / 2
    sections = [
        np.array([(-width / 2, *a), (width / 2, *a), (width / 2, *b), (-width / 2, *b)])
        for a, b in zip(curve - offset, curve + offset, strict=True)
    ]
    return solids.closed_rings(sections), sections


def _down(curve: np.ndarray) -> Mapping:
    """The picture hangs over a curve (n, 2) of y and z, its upper edge at the start; columns along x."""

    def mapping(corners: np.ndarray, _normals: np.ndarray) -> np.ndarray:
        x = corners[..., 0]
        nearest = cKDTree(curve).query(corners[..., 1:])[1]
        return np.stack([(x - x.min()) / np.ptp(x), 1 - nearest / (len(curve) - 1)], axis=-1)

    return mapping


BUILDERS = {
    "barcode_scanner": barcode_scanner,
    "card_terminal": card_terminal,
    "electronic_scale": electronic_scale,
    "receipt_printer": receipt_printer,
}
