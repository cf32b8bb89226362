"""What a reasoner answers about a scene: the selection of assets and the layout plan L."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from pydantic import Field, model_validator

from vcage.schema.base import Identifier, Record, StageDocument
from vcage.schema.scene import Role

RelationWord = Literal["inside", "on", "left_of", "right_of", "in_front_of", "behind", "beside", "near", "center"]
"""Left and right as the robot sees them (+x is right); in front is towards the robot (−y)."""

TABLE = "table"
"""The reference of a relation to the table itself (``center``)."""


class SelectedAsset(Record):
    """One object that a reasoner chose for the instruction."""

    asset: Identifier
    variant: Identifier
    role: Role
    reason: str = ""
    starts_in: Identifier | None = Field(
        default=None, description="asset of another chosen object that it lies in or on at the start"
    )


class Selection(Record):
    """The paper's A*: the objects chosen for an instruction."""

    objects: list[SelectedAsset] = Field(min_length=1)

    @model_validator(mode="after")
    def _starts_in_what_was_chosen(self) -> Selection:
        assets = {o.asset for o in self.objects}
        for o in self.objects:
            if o.starts_in is not None and (o.starts_in not in assets or o.starts_in == o.asset):
                raise ValueError(f"{o.asset} starts in {o.starts_in!r}, which is not another chosen asset")
        return self


class Relation(Record):
    """``subject`` stands in ``relation`` to ``reference`` (an object id, or ``table``)."""

    subject: Identifier
    relation: RelationWord
    reference: Identifier


class LayoutPlan(Record):
    """A reasoner's answer: the plan in words and in typed relations."""

    text: str = Field(min_length=1)
    relations: list[Relation] = Field(min_length=1)


class Plan(StageDocument):
    """``inpaint/plan.json``: the paper's L, and the picture I_tgt made from it."""

    SCHEMA: ClassVar[str] = "vcage.plan/1"

    instruction: str
    text: str
    relations: list[Relation]
    target: str = Field(description="path of the target picture in the run folder")
    checks: dict[str, Any] = Field(default={}, description="relations_solvable: share that can be kept at once…")
    notes: list[str] = Field(default=[], description="what a person should know about the picture")
