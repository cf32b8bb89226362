"""A cabinet with a shelf behind a door, hinged on the left."""

from __future__ import annotations

from assets.shapes import joinery
from assets.shapes.cabinet import DEPTH, FRICTION, WIDTH, Look, cabinet_look
from assets.shapes.joinery import Assembly, Carcass
from vcage.objects.modelling import solids
from vcage.objects.modelling.parts import BuiltObject, MovingPart, variant_rng
from vcage.schema.asset import Joint


def build(variant: str) -> BuiltObject:
    rng = variant_rng("hinged_cabinet", variant)
    look = cabinet_look(rng, variant)
    carcass = Carcass(WIDTH, DEPTH, bays=(0.115, 0.115), recess=0.014)  # the shelf ends behind the door
    shell = carcass.build(look.body, look.top, look.body, look.foot)
    left = -carcass.clear / 2
    for z in (carcass.floor(0) + 0.03, carcass.under_top - 0.05):
        knuckle = solids.prism(solids.circle(0.0026, 12, (left + joinery.GAP / 2, carcass.face)), 0.02, z)
        shell.parts.append(look.grip.on(knuckle))
    return BuiltObject(shell.parts, shell.hulls, mass=5.0, friction=FRICTION, moving=[_door(carcass, look)])


def _door(carcass: Carcass, look: Look) -> MovingPart:
    """A door that fills the whole front; it turns about the left edge of its face."""
    thick, edge = 0.012, 0.02
    wide = carcass.clear - 2 * joinery.GAP
    bottom = carcass.floor(0) + joinery.GAP
    high = carcass.under_top - carcass.floor(0) - 2 * joinery.GAP
    door = Assembly()
    door.front((wide, thick, high), (0, carcass.face, bottom), look.front, look.framed)
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
