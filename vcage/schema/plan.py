"""What a reasoner answers about a scene: the selection of assets and the layout plan L."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field

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


class Selection(Record):
    """The paper's A*: the objects chosen for an instruction."""

    objects: list[SelectedAsset] = Field(min_length=1)


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
