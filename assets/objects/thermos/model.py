"""A vacuum flask, 0.215 m high, with its cup as a lid and a handle to the right."""

from __future__ import annotations

import numpy as np

from assets.textures import kitchen
from vcage.objects.modelling import materials, pieces, prints, solids
from vcage.objects.modelling.mappings import around, tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

COATS = {"steel": None, "green": (52, 86, 68), "blue": (36, 72, 118)}


def build(variant: str) -> BuiltObject:
    rng = variant_rng("thermos", variant)
    radius, shoulder, height = 0.034, 0.152, 0.215
    body = [(0, 0), (0.032, 0), (radius, 0.002), (radius, shoulder - 0.006), (0.0325, shoulder), (0, shoulder)]
    collar = [(0, shoulder - 0.001), (0.0315, shoulder - 0.001), (0.0315, shoulder + 0.006), (0, shoulder + 0.006)]
    lid = [(0, shoulder + 0.005), (0.0325, shoulder + 0.005), (0.033, shoulder + 0.008), (0.0305, height - 0.004)]
    lid += [(0.0285, height - 0.0005), (0.027, height), (0.0255, height - 0.0015), (0, height - 0.0015)]
    foot = [(0.02, 0.003), (radius + 0.0004, 0.003), (radius + 0.0004, 0.014), (0.02, 0.014)]
    coat = COATS[variant]
    metal = kitchen.steel(rng)
    print_ = materials.plastic(rng, coat, 384) if coat else kitchen.steel(rng, 384)
    for x in (0.25, 0.75):
        print_ = prints.text(print_, "KOLDE", (x, 0.44), 0.075, (240, 240, 236) if coat else (60, 62, 66))
        print_ = prints.rectangle(print_, (x - 0.1, 0.53), (x + 0.1, 0.545), (236, 150, 50))
    print_ = np.roll(print_, 96, axis=1)  # a print in front and one at the back
    dark = materials.plastic(rng, (40, 42, 44))
    parts = [paint(solids.revolved(body, 44), print_, around(), roughness=0.35, metallic=0.0 if coat else 0.4)]
    parts += [paint(solids.revolved(p, 44), dark, tiled(0.05), roughness=0.6) for p in (collar, foot)]
    parts.append(paint(solids.revolved(lid, 44), metal, tiled(0.06), roughness=0.3, metallic=0.5))
    bow = np.array([(0.0, 0.132), (0.012, 0.134), (0.021, 0.131), (0.0255, 0.122), (0.026, 0.105), (0.0245, 0.075)])
    bow = np.concatenate([bow, [(0.0205, 0.05), (0.0135, 0.039), (0.0, 0.034)]])
    path = np.column_stack([radius - 0.002 + bow[:, 0], np.zeros(len(bow)), bow[:, 1]])
    count = 14
    handle = solids.sweep(path, solids.circle(1.0, count) * (0.0045, 0.009), up=(0, 1, 0))
    parts.append(paint(handle, dark, tiled(0.05), roughness=0.6))
    hulls = [
        pieces.stack([(0.032, 0), (radius + 0.0004, 0.003), (radius, shoulder - 0.006), (0.0325, shoulder)]),
        pieces.stack([(0.0315, shoulder), (0.033, shoulder + 0.008), (0.0305, height - 0.004), (0.027, height)]),
        *pieces.chain(list(np.asarray(handle.vertices)[: len(path) * count].reshape(len(path), count, 3))),
    ]
    return BuiltObject(parts, hulls, mass=0.5, friction=0.6)
