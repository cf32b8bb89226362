"""Records of assets: the annotation on disk, the catalogue line a model reads, and the physical model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Literal, TypeVar

from pydantic import Field, model_validator

from vcage.errors import UnknownName
from vcage.schema.base import Document, Finite, Identifier, Record, UnitVec3, Vec3

Holds = Literal["in", "on"]


class ContactPoint(Record):
    """Where a parallel gripper may grasp, in the object frame (origin: centre of the bottom; x right, y back, z up)."""

    id: int = Field(ge=0)
    name: str = Field(min_length=1)
    position: Vec3 = Field(description="point between the finger tips, metres")
    approach: UnitVec3 = Field(description="direction in which the gripper moves towards the object")
    closing: UnitVec3 = Field(description="axis along which the fingers close")


class FunctionalPoint(Record):
    """Where another object may be put, in the object frame."""

    id: int = Field(ge=0)
    name: str = Field(min_length=1)
    holds: Holds = Field(description="whether things are put 'in' it or 'on' it")
    position: Vec3 = Field(description="middle of the floor or surface that receives, metres")
    axis: UnitVec3 = Field(default=(0.0, 0.0, 1.0), description="out of the surface, against the way of placing")


class Words(Record):
    """What an object is called."""

    name: str = Field(min_length=1, description="as in a sentence, singular: 'marker pen'")
    plural: str = Field(min_length=1)
    synonyms: list[str] = []
    description: str = Field(min_length=1)
    category: str = Field(min_length=1, description="one word: stationery, food, container, toy…")
    scene_tags: list[str] = Field(default=[], description="where it belongs: kitchen, office_desk…")


class Variant(Record):
    """One look of an object; its geometry comes from the builder."""

    id: Identifier
    colour: str = Field(min_length=1, description="the word for its main colour")
    description: str = ""


class Annotation(Document):
    """``assets/objects/<name>/asset.json``: contact points, functional points and words, and no geometry."""

    SCHEMA: ClassVar[str] = "vcage.asset/1"

    name: Identifier
    words: Words
    variants: list[Variant] = Field(min_length=1)
    contact_points: list[ContactPoint] = []
    functional_points: list[FunctionalPoint] = []

    @model_validator(mode="after")
    def _ids_are_unique(self) -> Annotation:
        for what, ids in (
            ("variant", [v.id for v in self.variants]),
            ("contact point", [p.id for p in self.contact_points]),
            ("functional point", [p.id for p in self.functional_points]),
        ):
            if len(set(ids)) != len(ids):
                raise ValueError(f"a {what} id occurs twice in {ids}")
        return self

    def contact_point(self, point_id: int) -> ContactPoint:
        """The contact point with this id.

        Raises:
            UnknownName: there is none.
        """
        return _by_id(f"contact point of {self.name}", self.contact_points, point_id)

    def functional_point(self, point_id: int) -> FunctionalPoint:
        """The functional point with this id.

        Raises:
            UnknownName: there is none.
        """
        return _by_id(f"functional point of {self.name}", self.functional_points, point_id)


P = TypeVar("P", ContactPoint, FunctionalPoint)


def _by_id(what: str, points: Sequence[P], point_id: int) -> P:
    for point in points:
        if point.id == point_id:
            return point
    raise UnknownName(what, str(point_id), [str(point.id) for point in points])


class CatalogueEntry(Record):
    """One kind of object as a model sees it: words, sizes and points, no geometry files."""

    name: Identifier
    words: Words
    variants: list[Variant]
    size: Vec3 = Field(description="size of the first variant's bounding box, metres")
    contact_points: list[ContactPoint] = []
    functional_points: list[FunctionalPoint] = []


class PhysicalModel(Record):
    """What the simulator needs of one variant: all geometry is in the object frame, in metres.

    Files lie in the cache and are named by absolute path; records of a run never contain this.
    """

    visual: str = Field(description="path of a GLB with textures, z up")
    hulls: list[str] = Field(min_length=1, description="paths of convex meshes; their union is the collision shape")
    lower: Vec3 = Field(description="lower corner of the bounding box; z is 0")
    upper: Vec3
    mass: Finite = Field(gt=0, description="kilograms")
    friction: Finite = Field(gt=0, description="Coulomb coefficient, static and dynamic")
