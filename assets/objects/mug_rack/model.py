"""A post of 0.14 m on a heavy foot, with a peg to the left and one to the right, both rising.

The pegs are smooth and steep: a mug slides down to the post and leans on it, which stops its swinging.
"""

from __future__ import annotations

import numpy as np

from vcage.objects.modelling import materials, pieces, solids
from vcage.objects.modelling.mappings import tiled
from vcage.objects.modelling.parts import BuiltObject, paint, variant_rng

FOOT_RADIUS, FOOT_HEIGHT, POST_RADIUS = 0.075, 0.016, 0.009
PEG_RADIUS, PEG_LENGTH, PEG_HEIGHT, PEG_RISE = 0.004, 0.1, 0.125, np.radians(30.0)
"""Radius of a peg, its length from the post's axis and the height of its root, metres; its rise, radians."""


def build(variant: str) -> BuiltObject:
    rng = variant_rng("mug_rack", variant)
    coat = materials.wood(rng, materials.BEECH) if variant == "wood" else materials.plastic(rng, (38, 38, 40), 128)
    top = PEG_HEIGHT + 0.012
    foot = [(0, 0), (FOOT_RADIUS, 0), (FOOT_RADIUS, FOOT_HEIGHT - 0.004), (FOOT_RADIUS - 0.005, FOOT_HEIGHT)]
    post = [(POST_RADIUS, FOOT_HEIGHT), (POST_RADIUS, top - 0.003), (POST_RADIUS - 0.003, top), (0, top)]
    root = np.array([0.0, 0.0, PEG_HEIGHT])
    ends = [root + PEG_LENGTH * np.array([side * np.cos(PEG_RISE), 0.0, np.sin(PEG_RISE)]) for side in (-1, 1)]
    pegs = [solids.sweep([root, end], solids.circle(PEG_RADIUS, 16)) for end in ends]
    body = solids.union(solids.revolved(foot + post, 48), *pegs)
    hulls = [pieces.stack([(FOOT_RADIUS, 0), (FOOT_RADIUS, FOOT_HEIGHT - 0.004), (FOOT_RADIUS - 0.005, FOOT_HEIGHT)])]
    hulls.append(pieces.stack([(POST_RADIUS, FOOT_HEIGHT - 0.002), (POST_RADIUS, top)]))
    hulls += [pieces.hull(peg.vertices) for peg in pegs]
    return BuiltObject([paint(body, coat, tiled(0.15), roughness=0.5)], hulls, mass=1.6, friction=0.3)
