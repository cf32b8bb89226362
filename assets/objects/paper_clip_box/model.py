"""A small clear box, full of paper clips."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from assets.shapes import open_box
from assets.textures import packaging
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import from_above, six_sides, tiled
from vcage.objects.modelling.noise import Colour
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

METALS = {
    "silver": [(206, 208, 212), (176, 180, 186), (228, 230, 232)],
    "coloured": [(214, 44, 48), (40, 110, 200), (246, 200, 40), (60, 160, 80), (240, 240, 240), (230, 110, 40)],
}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("paper_clip_box", variant)
    metals = METALS[variant]
    size, wall, fill = (0.084, 0.058, 0.032), 0.0022, 0.026
    shell, _ = open_box.open_box((size[0] - 2 * wall, size[1] - 2 * wall), wall, 0.002, size[2], 0.004)
    clips = _paper_clips(rng, metals)
    heap = np.linspace(-1, 1, 9)
    rows = []
    for v in heap:
        bulge = 0.0045 * (1 - heap**2) * (1 - v**2)
        rows.append(np.column_stack([heap * (size[0] / 2 - wall), np.full(9, v * (size[1] / 2 - wall)), fill + bulge]))
    top = np.concatenate(rows)
    mound = pieces.hull(top, top * (1, 1, 0) + (0, 0, fill - 0.004))
    wires = _loose_clips(rng, fill)
    tone = (0.4 * clips + 0.6 * np.array([216, 226, 236])).astype(np.uint8)
    front = packaging.fitted(
        prints.rectangle(tone, (0.12, 0.24), (0.88, 0.84), (250, 250, 248)),
        "PAPER CLIPS",
        (0.5, 0.48),
        (0.66, 0.22),
        packaging.GRAPHITE,
    )
    front = packaging.fitted(front, "100", (0.5, 0.7), (0.2, 0.14), (196, 42, 46))
    sides = {"front": front, "back": front, "left": tone, "right": tone}
    parts = [
        paint(shell, prints.atlas(sides, (214, 224, 234), (320, 192)), six_sides(), roughness=0.15),
        paint(mound, clips, from_above(), roughness=0.4, metallic=0.2),
        *[
            paint(wire, materials.brushed(rng, metals[i % len(metals)]), tiled(0.05), roughness=0.3, metallic=0.3)
            for i, wire in enumerate(wires)
        ],
    ]
    return BuiltObject(parts, [solids.box(size)], mass=0.12, friction=0.6)


def _loose_clips(rng: np.random.Generator, fill: float) -> list[solids.Solid]:
    """Some clips of bent wire on top of the heap."""
    bend = (
        np.array([(-13, -4), (10, -4), (14, -2), (14, 2), (10, 4), (-11, 4), (-14, 1.5), (-11, -1.2), (8, -1.2)]) / 1000
    )
    clips = []
    for i, (x, y) in enumerate([(-0.021, 0.008), (0.004, -0.011), (0.021, 0.009), (-0.017, -0.013), (0.001, 0.012)]):
        turn = rng.uniform(0, 2 * np.pi)
        rotation = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        z = fill + 0.0032 + 0.0003 * i + 0.0008 * np.sin(np.arange(len(bend)))
        path = np.column_stack([bend @ rotation + (x, y), z])
        clips.append(solids.sweep(path, solids.circle(0.0007, 6)))
    return clips


def _paper_clips(
    rng: np.random.Generator, colours: Sequence[Colour], count: int = 130, size: tuple[int, int] = (384, 256)
) -> np.ndarray:
    """A heap of paper clips seen from above, ``size`` (width, height)."""
    picture = prints.canvas(*size, (66, 68, 74))
    bend = np.array([(-26, -9), (22, -9), (30, 0), (22, 9), (-22, 9), (-28, 3), (-22, -3), (16, -3), (20, 1), (16, 4)])
    for i in range(count):
        turn, at = rng.uniform(0, np.pi), rng.uniform((0, 0), size)
        rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        wire = np.round(bend @ rotation.T + at).astype(np.int32)
        colour = np.asarray(colours[i % len(colours)])
        cv2.polylines(picture, [wire + 2], False, (30, 30, 34), 3, cv2.LINE_AA)
        cv2.polylines(picture, [wire], False, tuple(int(c) for c in colour), 3, cv2.LINE_AA)
    return picture
