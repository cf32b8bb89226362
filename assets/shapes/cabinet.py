"""Small cabinets for the table top: their looks, and one to three drawers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assets.shapes import joinery
from assets.shapes.joinery import Carcass, DrawerLook, Finish, Foot, HandleShape
from vcage.objects.modelling import materials, prints, solids
from vcage.objects.modelling.mappings import from_front
from vcage.objects.modelling.noise import Colour, shaded
from vcage.objects.modelling.parts import BuiltObject, MovingPart, Part, paint, variant_rng

WIDTH, DEPTH, BAY = 0.26, 0.19, 0.07
"""Of all cabinets, and the clear height behind one drawer's front, metres."""

DRAWER_NAMES = {1: ("drawer",), 2: ("drawer_bottom", "drawer_top"), 3: ("drawer_bottom", "drawer_middle", "drawer_top")}
"""From the lowest drawer upwards."""

FRICTION = 1.0
"""Rubber feet."""

BRASS, STEEL, BLACK = (204, 166, 92), (196, 198, 202), (48, 48, 52)


@dataclass(frozen=True)
class Look:
    """How one variant of a cabinet looks.

    Args:
        body, top, front, grip: finishes.
        style: of the handles.
        foot: what it stands on.
        framed: whether fronts are framed.
        labels: whether drawers carry label holders.
    """

    body: Finish
    top: Finish
    front: Finish
    grip: Finish
    style: HandleShape = "bar"
    foot: Foot = "plinth"
    framed: bool = False
    labels: bool = False


def with_drawers(
    name: str, variant: str, bays: tuple[float, ...], mass: float, foot_height: float = Carcass.foot
) -> BuiltObject:
    """A cabinet with drawers one above the other.

    Args:
        name: of the object, for the seed of its textures.
        variant: a look of :func:`cabinet_look`.
        bays: clear height behind each drawer's front, the lowest first, metres; 1 to 3.
        mass: of the carcass, kilograms.
        foot_height: of plinth or legs, metres.
    """
    rng = variant_rng(name, variant)
    look = cabinet_look(rng, variant)
    carcass = Carcass(WIDTH, DEPTH, bays, foot_height)
    shell = carcass.build(look.body, look.top, look.body, look.foot)
    inside = Finish(materials.wood(rng, materials.PINE), roughness=0.7)
    if look.labels:
        inside = Finish(materials.plastic(rng, (150, 154, 160)), roughness=0.5)
    metal = Finish(materials.brushed(rng, STEEL), 0.05, 0.4, 0.4)
    drawer_look = DrawerLook(look.front, inside, metal, look.grip, look.style, look.framed)
    moving = []
    for bay, drawer_name in enumerate(DRAWER_NAMES[len(bays)]):
        drawer = joinery.drawer(carcass, bay, drawer_look)
        if look.labels:
            at = (-0.066, carcass.face, carcass.floor(bay) + bays[bay] / 2)
            drawer.parts += _label(("R - Z", "I - Q", "A - H")[bay], at)
        moving.append(MovingPart(drawer_name, drawer.parts, drawer.hulls, 0.45, joinery.slide(carcass, bay)))
    return BuiltObject(shell.parts, shell.hulls, mass=mass, friction=FRICTION, moving=moving)


def _label(words: str, at: tuple[float, float, float]) -> list[Part]:
    """A card in a metal frame on a drawer's face; ``at`` is its middle."""
    x, y, z = at
    wide, high = 0.06, 0.024
    frame = solids.cut(
        solids.box((wide, 0.002, high), (x, y - 0.001, z - high / 2)),
        solids.box((wide - 0.006, 0.01, high - 0.006), (x, y, z - high / 2 + 0.003)),
    )
    card = solids.box((wide - 0.004, 0.001, high - 0.004), (x, y - 0.0003, z - high / 2 + 0.002))
    picture = prints.text(prints.canvas(240, 90, (246, 243, 232)), words, (0.5, 0.5), 0.6, (40, 44, 60))
    steel = Finish(np.full((8, 8, 3), STEEL, dtype=np.uint8), 0.05, 0.35, 0.5)
    return [steel.on(frame), paint(card, picture, from_front(), roughness=0.9)]


def cabinet_look(rng: np.random.Generator, variant: str) -> Look:
    """The look that a variant's id stands for, the same for all cabinets."""
    woods = {"oak": materials.OAK, "walnut": materials.WALNUT, "pine": materials.PINE}
    if variant in woods:
        tones = woods[variant]
        body, top, front = (_wood(rng, tones, tone) for tone in (0.84, 1.0, 1.1))
        metal = _metal(rng, BRASS if variant == "walnut" else BLACK)
        return Look(body, top, front, metal, style="bar", foot="legs" if variant == "walnut" else "plinth")
    if variant == "steel":
        body, front = (_painted(rng, (122, 130, 136)), _painted(rng, (172, 180, 186)))
        return Look(body, body, front, _metal(rng, STEEL), style="bar", labels=True)
    colour = {"white": (236, 234, 228), "sage": (148, 168, 142), "blue": (70, 100, 138)}[variant]
    body, front = (_painted(rng, tuple(int(tone * c) for c in colour)) for tone in (0.88, 1.0))
    top = front if variant == "white" else _wood(rng, materials.BEECH)
    grip = Finish(materials.wood(rng, materials.BEECH), 0.08, 0.55) if variant == "blue" else _metal(rng, BRASS)
    style: HandleShape = "fin" if variant == "blue" else "bar"
    return Look(body, top, front, grip, style=style, foot="legs" if variant == "sage" else "plinth", framed=True)


def _wood(rng: np.random.Generator, tones: tuple[Colour, Colour], tone: float = 1.0) -> Finish:
    picture = materials.wood(rng, tones)
    return Finish(shaded(picture, np.full(picture.shape[:2], tone)), 0.18, 0.6)


def _painted(rng: np.random.Generator, colour: Colour) -> Finish:
    return Finish(materials.plastic(rng, colour, 128), 0.12, 0.45)


def _metal(rng: np.random.Generator, colour: Colour) -> Finish:
    return Finish(materials.brushed(rng, colour), 0.05, 0.35, 0.4)
