"""Small cabinets for the table top: one to three drawers, or a door with a shelf behind it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vcage.objects.builders import joinery, solids
from vcage.objects.builders.joinery import Assembly, Carcass, DrawerLook, Finish, Foot, Grip
from vcage.objects.builders.mappings import from_front
from vcage.objects.builders.parts import BuiltObject, MovingPart, paint, variant_rng
from vcage.objects.textures import materials, prints
from vcage.objects.textures.noise import Colour, shaded
from vcage.schema.asset import Joint

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
    style: Grip = "bar"
    foot: Foot = "plinth"
    framed: bool = False
    labels: bool = False


def cabinet_one_drawer(variant: str) -> BuiltObject:
    """A low cabinet with one drawer."""
    return _with_drawers("cabinet_one_drawer", variant, 1, mass=3.2)


def cabinet_two_drawers(variant: str) -> BuiltObject:
    """A cabinet with two drawers, one above the other."""
    return _with_drawers("cabinet_two_drawers", variant, 2, mass=4.2)


def cabinet_three_drawers(variant: str) -> BuiltObject:
    """A cabinet with three drawers, one above the other."""
    return _with_drawers("cabinet_three_drawers", variant, 3, mass=5.2)


def hinged_cabinet(variant: str) -> BuiltObject:
    """A cabinet with a shelf behind a door, hinged on the left."""
    rng = variant_rng("hinged_cabinet", variant)
    look = _look(rng, variant)
    carcass = Carcass(WIDTH, DEPTH, bays=(0.115, 0.115), recess=0.014)  # the shelf ends behind the door
    shell = carcass.build(look.body, look.top, look.body, look.foot)
    left = -carcass.clear / 2
    for z in (carcass.floor(0) + 0.03, carcass.under_top - 0.05):
        knuckle = solids.prism(solids.circle(0.0026, 12, (left + joinery.GAP / 2, carcass.face)), 0.02, z)
        shell.parts.append(look.grip.on(knuckle))
    return BuiltObject(shell.parts, shell.hulls, mass=5.0, friction=FRICTION, moving=[_door(carcass, look)])


def _with_drawers(name: str, variant: str, count: int, mass: float) -> BuiltObject:
    rng = variant_rng(name, variant)
    look = _look(rng, variant)
    carcass = Carcass(WIDTH, DEPTH, bays=(BAY,) * count)
    shell = carcass.build(look.body, look.top, look.body, look.foot)
    inside = Finish(materials.wood(rng, materials.PINE), roughness=0.7)
    if look.labels:
        inside = Finish(materials.plastic(rng, (150, 154, 160)), roughness=0.5)
    metal = Finish(materials.brushed(rng, STEEL), 0.05, 0.4, 0.4)
    drawer_look = DrawerLook(look.front, inside, metal, look.grip, look.style, look.framed)
    moving = []
    for bay, drawer_name in enumerate(DRAWER_NAMES[count]):
        assembly, part = joinery.drawer(drawer_name, carcass, bay, drawer_look, mass=0.45)
        if look.labels:
            _add_label(assembly, ("R - Z", "I - Q", "A - H")[bay], (-0.066, carcass.face, carcass.floor(bay) + BAY / 2))
        moving.append(part)
    return BuiltObject(shell.parts, shell.hulls, mass=mass, friction=FRICTION, moving=moving)


def _door(carcass: Carcass, look: Look) -> MovingPart:
    """A door that fills the whole front; it turns about the left edge of its face."""
    thick, edge = 0.012, 0.02
    wide = carcass.clear - 2 * joinery.GAP
    bottom = carcass.floor(0) + joinery.GAP
    high = carcass.under_top - carcass.floor(0) - 2 * joinery.GAP
    door = Assembly()
    joinery.add_front(door, (wide, thick, high), (0, carcass.face, bottom), look.front, look.framed)
    middle = bottom + high / 2
    door.grip(look.style, (wide / 2 - edge, carcass.face, middle), look.grip, height=0.04)
    joint = Joint(
        kind="turn",
        origin=(-carcass.clear / 2 + joinery.GAP / 2, carcass.face, middle),
        axis=(0, 0, -1),
        lower=0.0,
        upper=1.3,
        damping=1.0,
        friction=0.3,
    )
    return MovingPart("door", door.parts, door.hulls, 0.5, joint)


def _add_label(drawer: Assembly, words: str, at: tuple[float, float, float]) -> None:
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
    drawer.parts += [steel.on(frame), paint(card, picture, from_front(), roughness=0.9)]


# --- looks -------------------------------------------------------------------------------------------------


def _look(rng: np.random.Generator, variant: str) -> Look:
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
    style: Grip = "fin" if variant == "blue" else "bar"
    return Look(body, top, front, grip, style=style, foot="legs" if variant == "sage" else "plinth", framed=True)


def _wood(rng: np.random.Generator, tones: tuple[Colour, Colour], tone: float = 1.0) -> Finish:
    picture = materials.wood(rng, tones)
    return Finish(shaded(picture, np.full(picture.shape[:2], tone)), 0.18, 0.6)


def _painted(rng: np.random.Generator, colour: Colour) -> Finish:
    return Finish(materials.plastic(rng, colour, 128), 0.12, 0.45)


def _metal(rng: np.random.Generator, colour: Colour) -> Finish:
    return Finish(materials.brushed(rng, colour), 0.05, 0.35, 0.4)


BUILDERS = {
    "cabinet_one_drawer": cabinet_one_drawer,
    "cabinet_three_drawers": cabinet_three_drawers,
    "cabinet_two_drawers": cabinet_two_drawers,
    "hinged_cabinet": hinged_cabinet,
}
