"""Differences between episodes: the ranges of one file, and a draw from them for one episode.

``look`` is only seen, so recorded states can be drawn again under another one; ``world`` is part of the simulation.
"""

from __future__ import annotations

from math import ceil, floor
from typing import Annotated, ClassVar, Literal, get_args

from pydantic import AfterValidator, Field

from vcage.schema.base import Document, Finite, Identifier, Metres, Point3, Record, UnitVec3, Vec3


def _in_order(ends: tuple[float, float]) -> tuple[float, float]:
    if ends[0] > ends[1]:
        raise ValueError(f"expected the lower end first, got {ends[0]:g} … {ends[1]:g}")
    return ends


Range = Annotated[tuple[Finite, Finite], AfterValidator(_in_order)]
"""Drawn uniformly between both ends."""


def _within(lowest: float, highest: float) -> AfterValidator:
    """Require both ends to lie between two bounds."""

    def check(ends: tuple[float, float]) -> tuple[float, float]:
        if not lowest <= ends[0] <= ends[1] <= highest:
            raise ValueError(f"expected {lowest:g} to {highest:g}, got {ends[0]:g} … {ends[1]:g}")
        return ends

    return AfterValidator(check)


Above = Annotated[Finite, Field(gt=0)]
Factor = Annotated[tuple[Above, Above], AfterValidator(_in_order)]
UpTo5 = Annotated[Range, _within(0, 5)]
Shares = Annotated[Range, _within(-0.5, 0.5)]
Tenfold = Annotated[Factor, _within(0.1, 10)]
Tone = Annotated[Factor, _within(0, 1)]
Count = Annotated[tuple[Annotated[int, Field(ge=0)], Annotated[int, Field(ge=0)]], AfterValidator(_in_order)]
Offset = Annotated[Finite, Field(ge=-7, le=7)]
"""Of a joint, radians: more than a turn, as no arm begins farther from home."""

Share = Annotated[Finite, Field(ge=0, le=1)]

MOST_LIGHTS = 3
"""The key light and two more."""

MOST_CLUTTER = 10

FARTHEST_HEIGHT = 0.1
"""Metres by which a table may be higher or lower than its scene says."""

HEIGHT_STEP = 0.01
"""Heights of a table differ by whole steps, as what arms reach is worked out for each, metres."""


# --- the file: assets/randomisation/<name>.yml ---------------------------------------------------------------


class LightRanges(Record):
    """Of the lights of an episode: the first is the key light."""

    number: Annotated[Count, _within(1, MOST_LIGHTS)] = Field(
        default=(1, 1), description=f"of lights, at most {MOST_LIGHTS}"
    )
    heading_deg: Annotated[Range, _within(-360, 360)] = Field(default=(-58.0, -58.0), description="from +x over +y")
    slant: UpTo5 = Field(default=(0.47, 0.47), description="tangent of the angle between a light and straight down")
    strength: UpTo5 = Field(default=(1.55, 1.55), description="of the key light; others have their share of it")
    others: UpTo5 = Field(default=(0.2, 0.5), description="strength of each further light, share of the key light's")
    warmth: Shares = Field(default=(0.03, 0.03), description="by which share red is stronger, and blue weaker")
    ambient: UpTo5 = Field(default=(0.45, 0.45), description="light from everywhere")
    shadows: Share = Field(default=1.0, description="how often the key light throws shadows")


class SurfaceRanges(Record):
    """Of table, wall and floor."""

    table: list[Identifier] = Field(default=[], description="painted textures to choose from; the scene's own if none")
    wall: list[Identifier] = Field(default=[], description="the same; plain if none")
    floor: list[Identifier] = Field(default=[], description="the same; plain if none")
    wall_tone: Tone = Field(default=(0.56, 0.56), description="of a plain wall, linear, 1 is white")
    floor_tone: Tone = Field(default=(0.29, 0.29), description="the same of a plain floor")
    tint: Tenfold = Field(default=(1.0, 1.0), description="factor of each colour channel of wall and floor")


class CameraRanges(Record):
    """Of the cameras of the recording, about where the robot's file puts them."""

    shift: Finite = Field(default=0.0, ge=0, le=0.2, description="largest along each axis, metres")
    turn_deg: Finite = Field(default=0.0, ge=0, le=45, description="largest about each axis, degrees")
    fovy: Annotated[Factor, _within(0.5, 1.5)] = Field(default=(1.0, 1.0), description="factor of the field of view")


class ColourRanges(Record):
    """Colours of objects: their names stay true under any draw."""

    hue_deg: Finite = Field(default=0.0, ge=0, le=180, description="largest turn of the hue, degrees")
    saturation: Tenfold = (1.0, 1.0)
    lightness: Tenfold = (1.0, 1.0)


class LookRanges(Record):
    """Of appearance only."""

    light: LightRanges = LightRanges()
    surfaces: SurfaceRanges = SurfaceRanges()
    cameras: CameraRanges = CameraRanges()
    colours: ColourRanges = ColourRanges()


def _holding_a_height(ends: tuple[float, float]) -> tuple[float, float]:
    lowest, highest = heights_within(ends)
    if lowest > highest:
        raise ValueError(f"no whole centimetre lies in {ends[0]:g} … {ends[1]:g} m")
    return ends


def heights_within(ends: tuple[float, float]) -> tuple[int, int]:
    """The first and the last whole :data:`HEIGHT_STEP` between two heights in metres; none where they are crossed."""
    lower, upper = (round(end / HEIGHT_STEP, 6) for end in ends)
    return ceil(lower), floor(upper)


Heights = Annotated[Range, _within(-FARTHEST_HEIGHT, FARTHEST_HEIGHT), AfterValidator(_holding_a_height)]


class WorldRanges(Record):
    """Of the simulation."""

    variants: bool = Field(default=False, description="whether an object may be another variant that its words fit")
    clutter: Annotated[Count, _within(0, MOST_CLUTTER)] = Field(
        default=(0, 0), description=f"objects that the task does not touch, at most {MOST_CLUTTER}"
    )
    table_height: Heights = Field(default=(0.0, 0.0), description="added to the table's in whole centimetres, metres")
    mass: Tenfold = Field(default=(1.0, 1.0), description="factor of each object's mass")
    friction: Tenfold = Field(default=(1.0, 1.0), description="factor of each object's friction")
    start: Finite = Field(default=0.0, ge=0, le=0.3, description="largest offset of each joint from home, radians")


class Randomisation(Document):
    """``assets/randomisation/<name>.yml``, or a file of one's own: ``--randomise none|light|full|FILE``."""

    SCHEMA: ClassVar[str] = "vcage.randomisation/1"

    name: Identifier
    description: str
    look: LookRanges = LookRanges()
    world: WorldRanges = WorldRanges()


# --- random draws of one episode -----------------------------------------------------------------------------


class Light(Record):
    """A light that shines in one direction."""

    direction: UnitVec3 = Field(description="in which it shines, world frame")
    colour: Vec3 = Field(description="linear RGB; above 1 is brighter")
    shadows: bool


class Tint(Record):
    """Change of an object's colours."""

    hue_deg: Finite
    saturation: Finite
    lightness: Finite


class CameraShift(Record):
    """Offset of a camera from its place in the robot's file."""

    shift: Point3 = Field(description="in the frame of what carries it, metres")
    turn_deg: Vec3 = Field(description="about the camera's own x (forward), y (left) and z (up), degrees")
    fovy: Finite = Field(description="factor of the field of view")


class Surface(Record):
    """Look of a surface."""

    texture: Identifier | None = Field(description="painted; none for a plain one")
    colour: Vec3 = Field(description="linear RGB of a plain one, and the factors of a painted one's channels")


Where = Literal["table", "wall", "floor"]


def _of_each(surfaces: dict[Where, Surface]) -> dict[Where, Surface]:
    if missing := set(get_args(Where)) - set(surfaces):
        raise ValueError(f"nothing is said of {', '.join(sorted(missing))}")
    return surfaces


class Look(Record):
    """Look of an episode."""

    lights: list[Light] = Field(min_length=1, max_length=MOST_LIGHTS)
    ambient: Vec3 = Field(description="light from everywhere, linear RGB")
    surfaces: Annotated[dict[Where, Surface], AfterValidator(_of_each)]
    cameras: dict[str, CameraShift] = {}
    tints: dict[Identifier, Tint] = Field(default={}, description="by object; none where its colours are its own")

    @property
    def table_top(self) -> str | None:
        """The painted texture of the table, if it has one."""
        return self.surfaces["table"].texture


class WorldDraw(Record):
    """Differences of an episode's simulation from the run's scene."""

    variants: dict[Identifier, Identifier] = Field(default={}, description="object → its variant, where another")
    clutter: dict[Identifier, Identifier] = Field(default={}, description="object that is added → its asset")
    clutter_drawn: int = Field(default=0, ge=0, description="how many of these were to be there; fewer have no room")
    table_height: Metres = Field(default=0.0, description="added to the scene's, metres")
    mass: dict[Identifier, Above] = Field(default={}, description="object → kilograms, moving parts included")
    friction: dict[Identifier, Above] = Field(default={}, description="object → Coulomb coefficient")
    start: dict[str, list[Offset]] = Field(default={}, description="arm → offset of each joint from home, radians")

    @property
    def summary(self) -> str:
        """The differences, in a line for a person."""
        beside = f"{len(self.clutter)} objects beside" + (f" of {self.clutter_drawn}" if self.short_of_room else "")
        facts = {
            f"other variants of {', '.join(self.variants)}": self.variants,
            beside: self.clutter_drawn,
            f"table {100 * self.table_height:+.0f} cm": self.table_height,
            "mass": self.mass,
            "friction": self.friction,
            "arms beside home": self.start,
        }
        return ", ".join(fact for fact, is_so in facts.items() if is_so)

    @property
    def short_of_room(self) -> bool:
        """True if there was no room for all of the clutter."""
        return len(self.clutter) < self.clutter_drawn


class Drawn(Record):
    """Draw for one episode; its file and exports hold it."""

    ranges: str = Field(description="name of the file of ranges")
    look: Look
    world: WorldDraw = WorldDraw()
