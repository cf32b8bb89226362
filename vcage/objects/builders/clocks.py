"""Things that tell the time: a kitchen timer with a dial to wind, and an alarm clock."""

from __future__ import annotations

import numpy as np

from vcage.objects.builders import pieces, solids
from vcage.objects.builders.mappings import from_above, from_front, tiled
from vcage.objects.builders.parts import BuiltObject, MovingPart, paint, variant_rng
from vcage.objects.builders.plates import upright
from vcage.objects.textures import materials, screens
from vcage.objects.textures.noise import Colour
from vcage.schema.asset import Joint

# --- kitchen timer -----------------------------------------------------------------------------------------


def kitchen_timer(variant: str) -> BuiltObject:
    """A weighted round timer; a dial with a grip across it turns clockwise on top."""
    rng = variant_rng("kitchen_timer", variant)
    colour, face, ink = {
        "red": ((200, 42, 38), (246, 244, 238), (34, 34, 36)),
        "white": ((238, 236, 230), (60, 64, 70), (244, 244, 240)),
        "mint": ((120, 194, 172), (248, 246, 240), (40, 66, 62)),
    }[variant]
    outer = [(0, 0), (0.031, 0), (0.033, 0.002), (0.033, 0.034), (0.0315, 0.0375), (0.029, 0.0385), (0, 0.0385)]
    foot = solids.revolved([(0, 0), (0.0333, 0), (0.0333, 0.006), (0, 0.006)], 48)
    pointer = solids.box((0.0035, 0.0012, 0.016), (0, -0.0331, 0.019))
    parts = [
        paint(solids.revolved(outer, 48), materials.plastic(rng, colour), tiled(0.05), roughness=0.35),
        paint(foot, materials.plastic(rng, (44, 44, 48)), tiled(0.05), roughness=0.8),
        paint(pointer, materials.plastic(rng, ink if variant != "white" else (200, 40, 36)), tiled(0.05)),
    ]
    hulls = [pieces.stack([(0.0333, 0), (0.0333, 0.006), (0.033, 0.034), (0.029, 0.0385)])]
    return BuiltObject(parts, hulls, mass=0.9, friction=1.0, moving=[_dial(rng, colour, face, ink)])


def _dial(rng: np.random.Generator, colour: Colour, face: Colour, ink: Colour) -> MovingPart:
    """A disc with minutes and a grip that points to the front."""
    disc = solids.revolved([(0, 0.0395), (0.0285, 0.0395), (0.0285, 0.0415), (0.0275, 0.0425), (0, 0.0425)], 48)
    profile = np.concatenate(
        [
            [(-0.016, 0.042), (0.016, 0.042)],
            solids.arc((0.011, 0.062), 0.005, 0, 90, 5),
            solids.arc((-0.011, 0.062), 0.005, 90, 180, 5),
        ]
    )
    grip = upright(profile, 0.012)
    mark = solids.box((0.003, 0.016, 0.0006), (0, -0.004, 0.0669))
    picture = screens.minute_ring(384, face, ink, [str(5 * i) for i in range(12)])
    parts = [
        paint(disc, picture, from_above(), roughness=0.5),
        paint(grip, materials.plastic(rng, colour), tiled(0.05), roughness=0.4),
        paint(mark, materials.plastic(rng, face if face[0] > 100 else ink), tiled(0.05)),
    ]
    hulls = [pieces.stack([(0.0285, 0.0395), (0.0285, 0.0425)]), pieces.hull(grip.vertices)]
    joint = Joint(
        kind="turn",
        origin=(0.0, 0.0, 0.04),
        axis=(0.0, 0.0, -1.0),
        lower=0.0,
        upper=1.6,
        damping=0.3,
        friction=0.08,
    )
    return MovingPart("dial", parts, hulls, mass=0.04, joint=joint)


# --- alarm clock -------------------------------------------------------------------------------------------

AXIS = 0.054
"""Height of an alarm clock's middle, metres."""


def alarm_clock(variant: str) -> BuiltObject:
    """A round alarm clock with two bells on top, face to the front."""
    rng = variant_rng("alarm_clock", variant)
    colour, face, time = {
        "red": ((196, 44, 40), (248, 246, 240), (10, 9)),
        "black": ((40, 41, 45), (246, 240, 222), (7, 30)),
        "mint": ((126, 196, 180), (250, 250, 248), (8, 20)),
    }[variant]
    drum = [(0, -0.021), (0.042, -0.021), (0.045, -0.018), (0.045, 0.019), (0.0435, 0.021), (0.04, 0.021)]
    drum = _to_front(solids.revolved([*drum, (0.0395, 0.0185), (0, 0.0185)], 56))
    dial = _to_front(solids.revolved([(0, 0.0183), (0.0397, 0.0183), (0.0397, 0.0189), (0, 0.0189)], 56))
    feet = [solids.rounded_box((0.012, 0.038, 0.018), 0.004, (x, 0, 0)) for x in (-0.027, 0.027)]
    bells, posts, hulls = [], [], []
    for side in (-1, 1):
        lean = side * 33
        cup = np.concatenate([[(0, 0), (0.0175, 0)], solids.arc((0, 0.002), (0.0175, 0.0135), 0, 90, 7)])
        bells.append(_leaning(solids.revolved(cup, 28), lean, 0.051))
        posts.append(_leaning(solids.revolved([(0, 0), (0.004, 0), (0.004, 0.010), (0, 0.010)], 14), lean, 0.043))
        hulls.append(
            _leaning(pieces.stack([(0.0175, 0), (0.0175, 0.003), (0.0125, 0.0115), (0.005, 0.0155)], 12), lean, 0.051)
        )
    hammer = solids.union(
        solids.box((0.003, 0.003, 0.018), (0, 0, AXIS + 0.043)), solids.box((0.012, 0.006, 0.005), (0, 0, AXIS + 0.057))
    )
    metal = materials.plastic(rng, (206, 209, 214))
    knob = _to_front(solids.revolved([(0, -0.026), (0.005, -0.026), (0.005, -0.02), (0, -0.02)], 18))
    knobs = [solids.moved(knob, (x, 0, 0.008)) for x in (-0.013, 0.013)]
    parts = [
        paint(solids.union(drum, *feet), materials.plastic(rng, colour), tiled(0.05), roughness=0.3),
        paint(dial, screens.clock_face(512, face, (34, 34, 38), (24, 24, 28), time), from_front(), roughness=0.5),
        paint(solids.union(*bells), metal, tiled(0.05), roughness=0.2, metallic=0.5),
        paint(solids.union(*posts, hammer, *knobs), metal, tiled(0.05), roughness=0.3, metallic=0.4),
    ]
    drum_hull = _to_front(pieces.stack([(0.042, -0.021), (0.045, -0.018), (0.045, 0.019), (0.0435, 0.021)], 24))
    hulls += [drum_hull, *(foot.convex_hull for foot in feet), *(knob.convex_hull for knob in knobs)]
    hulls.append(solids.box((0.012, 0.006, 0.019), (0, 0, AXIS + 0.043)))
    return BuiltObject(parts, hulls, mass=0.28, friction=0.8)


def _to_front(solid: solids.Solid) -> solids.Solid:
    """What is built around the vertical axis, laid so that its top faces the front, at the clock's height."""
    return solids.moved(solid, (0, 0, AXIS), turn=90, axis=(1, 0, 0))


def _leaning(solid: solids.Solid, degrees: float, distance: float) -> solids.Solid:
    """What is built around the vertical axis, put on the clock's rim at an angle from its top."""
    return solids.moved(solids.moved(solid, (0, 0, distance)), (0, 0, AXIS), turn=degrees, axis=(0, 1, 0))


BUILDERS = {
    "alarm_clock": alarm_clock,
    "kitchen_timer": kitchen_timer,
}
