"""The scene: what stands on the table, where, and what the cameras that look at it are."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from vcage.base.graphs import circles
from vcage.schema.base import (
    Box,
    CameraRecord,
    Document,
    Identifier,
    Metres,
    Point2,
    PoseRecord,
    Record,
    RunPath,
    StageDocument,
    require_unique,
    the,
)
from vcage.schema.goals import AskedGoal, Description
from vcage.schema.robot import DEFAULT_ROBOT

Role = Literal["content", "receptacle", "tool", "context"]
"""Part of an object in the instruction: moves it, puts things into it, uses it for something else (a scanner, a
scale, a sign), or nothing."""

PLAIN = "table"
"""Name of the scene template that is no place in particular."""

MOST_OF_A_KIND = 40
"""Objects that one record of a template may ask for: more have no place on any table."""


FARTHEST = 10.0
"""Metres from the origin that a workspace reaches: what it is searched in has memory in proportion."""


class Table(Record):
    """The table top: an axis-aligned rectangle."""

    centre: Point2 = (0.0, 0.0)
    size: Point2 = (1.2, 0.7)
    height: Metres = Field(default=0.74, description="z of the top, metres")
    texture: str = Field(default="oak", description="name of a painted texture")

    @model_validator(mode="after")
    def _has_an_area(self) -> Table:
        if min(self.size) <= 0:
            raise ValueError(f"expected a table with an area, got {self.size[0]:g} x {self.size[1]:g} m")
        return self

    @property
    def rectangle(self) -> np.ndarray:
        """(2, 2) lower and upper corner of the top, metres."""
        centre, half = np.array(self.centre), np.array(self.size) / 2
        return np.stack([centre - half, centre + half])

    def topped(self, texture: str | None) -> Table:
        """The table with another top; with its own where there is no name."""
        return self.model_copy(update={"texture": texture or self.texture})


class Workspace(Record):
    """The rectangle of the table that objects may cover, metres in the world frame."""

    lower: Point2
    upper: Point2

    @model_validator(mode="after")
    def _is_not_empty(self) -> Workspace:
        if not (self.lower[0] < self.upper[0] and self.lower[1] < self.upper[1]):
            raise ValueError(f"empty workspace: {self.lower} … {self.upper}")
        if max(map(abs, (*self.lower, *self.upper))) > FARTHEST:
            raise ValueError(f"expected a workspace within {FARTHEST:g} m, got {self.lower} … {self.upper}")
        return self


class Contents(Record):
    """Objects of a place: kinds with all of these tags, or kinds by name."""

    tags: list[str] = Field(default=[], description="categories and scenes of the catalogue; a kind must have all")
    assets: list[Identifier] = Field(default=[], description="names of kinds")
    count: Annotated[tuple[int, int], BeforeValidator(lambda n: (n, n) if isinstance(n, int) else n)] = Field(
        default=(1, 1), description="how many: the least and the most, or one number"
    )
    role: Role = "content"

    @model_validator(mode="after")
    def _check_kinds_and_counts(self) -> Contents:
        least, most = self.count
        if bool(self.tags) == bool(self.assets):
            raise ValueError(f"expected either tags or assets, got {self.tags} and {self.assets}")
        if not (0 <= least <= most and 1 <= most <= MOST_OF_A_KIND):
            raise ValueError(f"expected a count of 1 to {MOST_OF_A_KIND}, the least first, got {least} to {most}")
        return self


class SceneTemplate(Document):
    """``assets/scenes/<name>.yml``: a place to build a scene in, and its typical objects."""

    SCHEMA: ClassVar[str] = "vcage.scene-template/1"

    name: Identifier
    description: str
    robot: Identifier = Field(default=DEFAULT_ROBOT, description="a file of assets/robots")
    table: Table = Table()
    workspace: Workspace
    top_camera: CameraRecord
    contents: list[Contents] = Field(default=[], description="contents of a scene without an instruction")


class ObjectRecord(Record):
    """One object of a scene."""

    id: Identifier = Field(description="unique in the scene")
    asset: Identifier
    variant: Identifier
    phrase: str = Field(min_length=1, description="what to call it in this scene: 'black marker pen'")
    role: Role
    pose: PoseRecord = Field(description="object frame (origin at the centre of the bottom) in the world")
    aabb: Box = Field(description="axis-aligned box in the world, computed when the scene was written")
    joints: tuple[Metres, ...] = Field(default=(), description="of moving parts, metres or radians; (): at rest")
    container: Identifier | None = Field(default=None, description="id of the object that this one lies in or on")
    container_part: Identifier | None = Field(default=None, description="moving part of the container: a drawer")
    heaped: bool = Field(default=False, description="lies loose in its container: a ball among others")

    @property
    def rides(self) -> bool:
        """True for an object without a place of its own in a layout: it goes where its container does."""
        return self.container is not None and (self.heaped or self.container_part is not None)


class Scene(StageDocument):
    """The paper's M (``place/scene.json``) and S* (``optimize/scene.json``).

    Example:
        >>> scene = Scene.read(RunFolder("runs/blocks").layout)
        >>> [(o.id, o.pose.position) for o in scene.objects]
    """

    SCHEMA: ClassVar[str] = "vcage.scene/1"

    instruction: Annotated[str, Field(min_length=1)] | None = Field(default=None, description="None: of the template")
    goals: list[AskedGoal] = Field(default=[], description="what the instruction asks for, with the words for it")
    untouched: list[Identifier] = Field(default=[], description="objects that the instruction wants left alone")
    descriptions: list[Description] = Field(default=[], description="what the instruction says of the start")
    template: Identifier = Field(description="name of the scene template")
    robot: Identifier
    table: Table
    workspace: Workspace
    top_camera: CameraRecord
    objects: list[ObjectRecord] = Field(min_length=1)
    pictures: dict[str, RunPath] = Field(default={}, description="source, background, segmentation → path in the run")
    segmentation_ids: dict[str, int] = Field(
        default={}, description="object id → value in segmentation.png; 0: none; what is heaped has its container's"
    )
    checks: dict[str, Any] = Field(default={}, description="what was measured: settle time, largest drift…")

    @model_validator(mode="after")
    def _names_hold_together(self) -> Scene:
        require_unique("object", self.objects)
        ids = {o.id for o in self.objects}
        for o in self.objects:
            if o.container is not None and (o.container not in ids or o.container == o.id):
                raise ValueError(f"{o.id} lies in {o.container!r}, which is not another object of the scene")
            if o.heaped and (o.container is None or o.container_part is not None):
                raise ValueError(f"{o.id} is heaped, but lies in no object of the scene itself")
        if ring := circles([(o.id, o.container) for o in self.objects if o.container is not None]):
            raise ValueError(f"containers in a circle: {' in '.join(ring[0])}")
        return self

    @model_validator(mode="after")
    def _objects_are_no_larger_than_the_table(self) -> Scene:
        for o in self.objects:
            size = [upper - lower for lower, upper in zip(*o.aabb, strict=True)]
            if size[0] > self.table.size[0] or size[1] > self.table.size[1]:
                raise ValueError(
                    f"{o.id} is {size[0]:.3g} x {size[1]:.3g} m, the table {self.table.size[0]:.3g} x "
                    f"{self.table.size[1]:.3g} m"
                )
        return self

    @property
    def laid_out(self) -> list[Description]:
        """The descriptions of objects with a place of their own, which layouts keep true; the others go along."""
        return [d for d in self.descriptions if d.part is None and not self.object(d.subject).rides]

    def object(self, object_id: str) -> ObjectRecord:
        """The object with this id.

        Raises:
            UnknownName: there is none.
        """
        return the("object", self.objects, object_id)
