"""Records of assets: the annotation on disk, the catalogue line a model reads, and the physical model."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field, model_validator

from vcage.goals import KINDS
from vcage.schema.base import Document, Finite, Identifier, Point3, Record, UnitVec3, Vec3, require_unique, the

Holds = Literal["in", "on"]
Use = Literal["grasp", "press"]
JointMotion = Literal["slide", "turn"]
Source = Literal["parametric", "sweethome3d", "robosuite", "ycb", "robotwin"]
"""Origin of a model: our own builders, a package that set-up fetches, or an imported folder."""
FETCHED = ("sweethome3d", "robosuite", "ycb")
IMPORTED = ("robotwin",)

TALL_SHARE = 1.2
"""Least height of what may lie on its side and be stood up, as a share of the larger side of its footprint."""

COMPARTMENT = "compartment_"
"""Beginning of the name of every compartment, as the name of a moving part begins with its kind."""


class ContactPoint(Record):
    """Point to grasp an object by, in the object frame (origin: centre of the bottom; x right, y back, z up)."""

    id: int = Field(ge=0)
    name: str = Field(min_length=1)
    position: Point3 = Field(description="point between the finger tips, metres")
    approach: UnitVec3 = Field(description="direction in which the gripper moves towards the object")
    closing: UnitVec3 = Field(description="axis along which the fingers close")
    link: Identifier | None = Field(default=None, description="moving part that has it, joints at 0; None: the body")
    use: Use = Field(default="grasp", description="'grasp': fingers close around it; 'press': they push it, closed")

    @model_validator(mode="after")
    def _check_pressed_part(self) -> ContactPoint:
        if self.use == "press" and self.link is None:
            raise ValueError("expected a 'link' for the use 'press': only a moving part can be pressed")
        return self

    @property
    def carries(self) -> bool:
        """True if the object can be carried by it, unlike handles and buttons of moving parts."""
        return self.link is None and self.use == "grasp"


class FunctionalPoint(Record):
    """Point that receives another object, in the object frame."""

    id: int = Field(ge=0)
    name: str = Field(min_length=1)
    holds: Holds = Field(description="whether things are put 'in' it or 'on' it")
    position: Point3 = Field(description="middle of the floor or surface that receives, metres")
    axis: UnitVec3 = Field(default=(0.0, 0.0, 1.0), description="out of the surface, against the way of placing")
    link: Identifier | None = Field(default=None, description="moving part that has it, joints at 0; None: the body")
    compartment: Identifier | None = Field(default=None, description="name of a fixed compartment; goals may name it")
    weighs: bool = Field(default=False, description="whether what lies there is weighed")

    @model_validator(mode="after")
    def _check_compartment(self) -> FunctionalPoint:
        if self.compartment is not None and (self.link is not None or not self.compartment.startswith(COMPARTMENT)):
            raise ValueError(f"compartment {self.compartment!r}: expected '{COMPARTMENT}…' and no 'link'")
        return self

    @property
    def part(self) -> str | None:
        """The part that it belongs to: a moving one, or a compartment; None for the body."""
        return self.link or self.compartment

    def is_of(self, part: str | None) -> bool:
        """Check if a goal about ``part`` may mean this point; None may mean the body or any compartment."""
        return part in (self.link, self.part)

    @property
    def sideways(self) -> bool:
        """True if things come in from the side: more than 45° off the vertical."""
        return self.axis[2] < 0.7

    @property
    def open_above(self) -> bool:
        """True for the inside of a body that is open at the top: things may lie loose in it, and be poured into it."""
        return self.link is None and self.holds == "in" and not self.sideways


class PointRoom(Record):
    """The room at a functional point: contents must fit into it."""

    point: int = Field(ge=0, description="id of the functional point")
    size: Point3 = Field(description="width and depth of the free rectangle, and the height; 0 on an open top; metres")


class Face(Record):
    """A marked spot of an object: a bar code, the window of the scanner that reads it, the head of a tool to hit with,
    the pad of one to wipe with (the middle of its lower side, as the tool lies in a hand), the middle of the loop of a
    closed handle, the tip of a peg on which such a loop hangs, the middle of a straight hole, or that of a shaft that
    goes into one."""

    kind: Literal["code", "reader", "head", "pad", "loop", "peg", "hole", "shaft"]
    position: Point3 = Field(description="its middle in the object frame, metres")
    axis: UnitVec3 = Field(
        description="out of the surface; through a loop or a hole; along a shaft; out of the tip of a peg; axes of "
        "holes, shafts and pegs lean at least 8 degrees from the vertical"
    )

    @model_validator(mode="after")
    def _slid_along_a_leaning_axis(self) -> Face:
        if self.kind in ("peg", "hole", "shaft") and abs(self.axis[2]) > 0.99:
            raise ValueError(f"axis: expected that of a {self.kind} to lean at least 8 degrees from the vertical")
        return self


class Words(Record):
    """Names of an object."""

    name: str = Field(min_length=1, description="as in a sentence, singular: 'marker pen'")
    plural: str = Field(min_length=1)
    synonyms: list[str] = []
    description: str = Field(min_length=1)
    category: str = Field(min_length=1, description="one word: stationery, food, container, toy…")
    scene_tags: list[str] = Field(default=[], description="where it belongs: kitchen, office_desk…")


class PackageModel(Record):
    """A model of a package that set-up fetches, and how it becomes ours: turned upright, scaled, made solid."""

    model: str = Field(min_length=1, description="its id in the package")
    turn: Vec3 = Field(default=(0.0, 0.0, 0.0), description="degrees about x, y, z, in this order, to stand as we do")
    size: Point3 | None = Field(default=None, description="edge lengths after turning, metres; None: the package's")
    mass: Finite = Field(gt=0, description="kilograms")
    friction: Finite = Field(default=0.6, gt=0, description="Coulomb coefficient")
    colour: tuple[int, int, int] | None = Field(default=None, description="paints a model without colours, sRGB")


class Variant(Record):
    """One look of an object; its geometry comes from a builder, a package or an imported folder."""

    id: Identifier
    colour: str = Field(min_length=1, description="the word for its main colour")
    description: str = ""
    package: PackageModel | None = None
    painted: Identifier | None = Field(default=None, description="variant of which it is another colour")
    laid: Identifier | None = Field(default=None, description="variant of which it is the look on its side")


class Annotation(Document):
    """``assets/objects/<name>/asset.json``: contact points, functional points and words, and no geometry."""

    SCHEMA: ClassVar[str] = "vcage.asset/1"

    name: Identifier
    source: Source = "parametric"
    words: Words
    variants: list[Variant] = Field(min_length=1)
    any_colour: Identifier | None = Field(
        default=None, description="variant with one main colour, which comes in any other; none: no look has one"
    )
    front: bool = Field(default=False, description="whether its side towards -y is a front that can face somebody")
    loose: bool = Field(default=False, description="whether it is a ball that rolls in what holds it, and is poured")
    contact_points: list[ContactPoint] = []
    functional_points: list[FunctionalPoint] = []
    faces: list[Face] = []

    @model_validator(mode="after")
    def _ids_are_unique(self) -> Annotation:
        require_unique("variant", self.variants)
        require_unique("contact point", self.contact_points)
        require_unique("functional point", self.functional_points)
        return self

    @model_validator(mode="after")
    def _the_painted_variant_is_built(self) -> Annotation:
        ids = [variant.id for variant in self.variants]
        if self.any_colour is not None and (self.any_colour not in ids or self.source in IMPORTED):
            raise ValueError(f"any_colour {self.any_colour!r}: expected one of {', '.join(ids)}, not imported")
        for made in ("painted", "laid"):
            if any(getattr(variant, made) for variant in self.variants):
                raise ValueError(f"{made}: such looks are made on demand; expected none in the file")
        return self

    @model_validator(mode="after")
    def _no_hand_takes_what_is_loose(self) -> Annotation:
        if self.loose and (self.contact_points or self.functional_points):
            raise ValueError("loose: expected no contact_points and no functional_points of a ball that is poured")
        return self

    @model_validator(mode="after")
    def _models_come_from_the_source(self) -> Annotation:
        fetched = self.source in FETCHED
        for variant in self.variants:
            if (variant.package is not None) != fetched:
                expected = "a 'package'" if fetched else "no 'package'"
                raise ValueError(f"variant {variant.id!r}: expected {expected} for the source {self.source!r}")
        return self

    def contact_point(self, point_id: int) -> ContactPoint:
        """The contact point with this id.

        Raises:
            UnknownName: there is none.
        """
        return the(f"contact point of {self.name}", self.contact_points, point_id)

    @property
    def carrying_points(self) -> list[ContactPoint]:
        """The contact points by which the object is carried."""
        return [point for point in self.contact_points if point.carries]

    def faces_of(self, kind: str) -> list[Face]:
        """The bar codes (``code``), scanner windows (``reader``), heads (``head``), pads (``pad``), loops of handles
        (``loop``), pegs (``peg``), holes (``hole``) or shafts (``shaft``)."""
        return [face for face in self.faces if face.kind == kind]

    def functional_point(self, point_id: int) -> FunctionalPoint:
        """The functional point with this id.

        Raises:
            UnknownName: there is none.
        """
        return the(f"functional point of {self.name}", self.functional_points, point_id)


class CatalogueEntry(Record):
    """One kind of object as a model sees it: words, sizes and points, no geometry files."""

    name: Identifier
    words: Words
    variants: list[Variant]
    any_colour: Identifier | None = Field(default=None, description="variant that comes in any other colour")
    loose: bool = Field(default=False, description="a ball that rolls in what holds it, and is poured")
    size: Point3 = Field(default=(0.0, 0.0, 0.0), description="bounding box of the first variant, metres; 0: not built")
    contact_points: list[ContactPoint] = []
    functional_points: list[FunctionalPoint] = []
    faces: list[Face] = []
    moving_parts: list[Identifier] = Field(default=[], description="names of drawers, lids, buttons…")
    rooms: list[PointRoom] = Field(default=[], description="at its functional points; none while it is not built")

    @property
    def can_be_carried(self) -> bool:
        """True if it has a contact point to carry it by."""
        return any(point.carries for point in self.contact_points)

    @property
    def tall(self) -> bool:
        """True if it is much higher than wide, as what may lie on its side; or if it is not built yet."""
        x, y, z = self.size
        return z >= TALL_SHARE * max(x, y)

    @property
    def holds_loose(self) -> bool:
        """True if balls lie in it: it is open at the top."""
        return any(point.open_above for point in self.functional_points)

    def takes_poured(self, least_m: float) -> bool:
        """True if an opening at its top is as wide as this, metres; or if it is not built yet, and has one."""
        sides = {room.point: min(room.size[:2]) for room in self.rooms}
        wide = (sides.get(point.id, least_m) >= least_m for point in self.functional_points if point.open_above)
        return any(wide)

    @property
    def parts(self) -> list[str]:
        """Names of its moving parts and compartments."""
        return [*self.moving_parts, *(point.compartment for point in self.functional_points if point.compartment)]

    @property
    def reads_codes(self) -> bool:
        """Check if it has the window of a bar code scanner."""
        return any(face.kind == "reader" for face in self.faces)

    @property
    def hits(self) -> bool:
        """Check if it has a head to hit with."""
        return any(face.kind == "head" for face in self.faces)

    @property
    def wipes(self) -> bool:
        """Check if it has a pad to wipe with."""
        return any(face.kind == "pad" for face in self.faces)

    @property
    def hangs(self) -> bool:
        """Check if a hand takes it, and it has a closed handle to hang it by."""
        return self.can_be_carried and any(face.kind == "loop" for face in self.faces)

    @property
    def pegs(self) -> int:
        """The number of its pegs, on each of which one thing hangs."""
        return sum(face.kind == "peg" for face in self.faces)

    @property
    def goes_into_holes(self) -> bool:
        """Check if a hand takes it, and it has a shaft that goes into a hole."""
        return self.can_be_carried and any(face.kind == "shaft" for face in self.faces)

    @property
    def holes(self) -> int:
        """The number of its holes, into each of which one shaft goes."""
        return sum(face.kind == "hole" for face in self.faces)

    @property
    def weighs(self) -> bool:
        """Check if its contents are weighed."""
        return any(point.weighs for point in self.functional_points)

    @property
    def tool_for(self) -> frozenset[str]:
        """Goal words that need a thing of this kind: ``scanned``, ``weighed``, ``hit``, ``wiped``."""
        return frozenset(kind.word for kind in KINDS.values() if kind.tool and getattr(self, kind.tool))


class Joint(Record):
    """Motion of a moving part, in the object frame with all joints at 0."""

    kind: JointMotion = Field(description="'slide' along the axis, metres; 'turn' about it, radians")
    origin: Point3 = Field(description="a point of the axis, metres")
    axis: UnitVec3
    lower: Finite = Field(description="end of the range; 0, the closed or resting state, lies within it")
    upper: Finite
    damping: Finite = Field(ge=0, description="resistance against speed, N s/m or N m s/rad")
    friction: Finite = Field(ge=0, description="limit of the damping, N or N m; less does not move the part; 0: none")
    spring: Finite = Field(default=0.0, ge=0, description="pulls back to 0, N/m or N m/rad")

    @model_validator(mode="after")
    def _range_holds_rest(self) -> Joint:
        if self.spring and self.friction:
            raise ValueError("expected a spring or friction: a part with a spring does not stay in place")
        if not self.lower <= 0 <= self.upper or self.lower == self.upper:
            raise ValueError(f"expected lower <= 0 <= upper and a range, got {self.lower} … {self.upper}")
        return self

    @property
    def far_end(self) -> float:
        """The end of the range that is farther from rest: open, pressed, or turned on."""
        return self.upper if self.upper >= -self.lower else self.lower


class MovingLink(Record):
    """A part that moves against the body, or against another part; geometry in the object frame, all joints at 0."""

    name: Identifier
    parent: Identifier | None = Field(default=None, description="the part that carries it; the body when not given")
    joint: Joint
    visual: str
    hulls: list[str] = Field(min_length=1)
    mass: Finite = Field(gt=0, description="kilograms")


class PhysicalModel(Record):
    """One variant for the simulator: all geometry is in the object frame, in metres.

    An object with moving links is an articulation: ``visual``, ``hulls`` and ``mass`` are its body's.

    Files lie in the cache and are named by absolute path; records of a run never contain this.
    """

    visual: str = Field(description="path of a GLB with textures, z up")
    hulls: list[str] = Field(min_length=1, description="paths of convex meshes; their union is the collision shape")
    lower: Point3 = Field(description="lower corner of the bounding box; z is 0")
    upper: Point3
    mass: Finite = Field(gt=0, description="kilograms")
    friction: Finite = Field(gt=0, description="Coulomb coefficient, static and dynamic")
    links: list[MovingLink] = Field(default=[], description="moving parts, each after the part that carries it")

    @model_validator(mode="after")
    def _parents_come_first(self) -> PhysicalModel:
        known: set[str | None] = {None}
        for link in self.links:
            if link.parent not in known or link.name in known:
                raise ValueError(f"link {link.name!r}: expected a new name and a parent from before it")
            known.add(link.name)
        return self

    @property
    def total_mass(self) -> float:
        """Kilograms, moving parts included."""
        return self.mass + sum(link.mass for link in self.links)

    def link(self, name: str) -> MovingLink:
        """The moving part with this name.

        Raises:
            UnknownName: there is none.
        """
        return the("moving part", self.links, name, "name")
