"""The truth of a target picture: ``truth.json`` of a case (see ``docs/match-pictures.md``)."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field, model_validator

from vcage.schema.base import Document, Finite, Identifier, Point2, Record


class TrueObject(Record):
    """Pose of one object of the scene in the target picture."""

    id: Identifier
    present: bool = Field(description="false: the target picture does not show it")
    position: Point2 | None = Field(default=None, description="x, y of the object's origin, metres")
    yaw: Finite | None = Field(default=None, description="heading of the object's x axis, radians")
    symmetry: int = Field(default=1, ge=0, description="turns by 1/n look the same from above; 0: any turn does")
    visible: Finite = Field(default=1.0, ge=0, le=1, description="share of its silhouette that nothing hides")

    @model_validator(mode="after")
    def _is_somewhere(self) -> TrueObject:
        if self.present and (self.position is None or self.yaw is None):
            raise ValueError(f"{self.id} is present, but has no position and yaw")
        return self


class Stranger(Record):
    """Something that the target picture shows and the scene does not have."""

    name: str = Field(description="what it is")
    position: Point2 = Field(description="x, y of its origin, metres")


class Truth(Document):
    """``truth.json``."""

    SCHEMA: ClassVar[str] = "vcage.match-truth/1"

    level: Identifier = Field(description="row of the table that the case counts for")
    objects: list[TrueObject] = Field(min_length=1)
    strangers: list[Stranger] = []
    changes: dict[str, Any] = Field(default={}, description="what was done to the picture, for whoever reads it")

    @model_validator(mode="after")
    def _names_every_object_once(self) -> Truth:
        ids = [o.id for o in self.objects]
        if len(set(ids)) != len(ids):
            raise ValueError(f"an object id occurs twice in {ids}")
        return self
