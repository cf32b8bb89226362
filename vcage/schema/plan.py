"""A reasoner's answers about a scene: the selection of assets and the layout plan L."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, ClassVar

from pydantic import Field, model_validator

from vcage.base.graphs import circles
from vcage.goals.kind import TABLE as TABLE
from vcage.schema.base import Identifier, Record, RunPath, StageDocument
from vcage.schema.goals import RelationWord
from vcage.schema.scene import Role


class SelectedAsset(Record):
    """One object that a reasoner chose for the instruction."""

    asset: Identifier
    variant: Identifier
    role: Role
    reason: str = ""
    starts_in: Identifier | None = Field(default=None, description="asset of the object that it starts in or on")
    starts_in_part: Identifier | None = Field(default=None, description="moving part of that object: a drawer")


class Selection(Record):
    """The paper's A*: the objects chosen for an instruction."""

    objects: list[SelectedAsset] = Field(min_length=1)
    notes: list[str] = Field(default=[], description="what a person should know about the choice")

    @model_validator(mode="after")
    def _check_starting_containers(self) -> Selection:
        complaints = starting_complaints((o.asset, o.starts_in) for o in self.objects)
        if complaints:
            raise ValueError("; ".join(complaints))
        return self


SelectionCheck = Callable[[Selection], list[str]]
"""Returns complaints about a selection, one sentence each."""


def starting_complaints(chosen: Iterable[tuple[str, str | None]]) -> list[str]:
    """Complaints about the starting places of chosen assets, one sentence each.

    Args:
        chosen: (asset, asset of its starting container) of each object, in order. Of an asset chosen more than once
            the first object is the container.
    """
    chosen = list(chosen)
    assets = {asset for asset, _ in chosen}
    found = [
        f"{asset} starts in {place!r}, which is not another chosen object"
        for asset, place in chosen
        if place and (place not in assets or place == asset)
    ]
    first: dict[str, str | None] = {}
    for asset, place in chosen:
        first.setdefault(asset, place)
    rings = circles((asset, place) for asset, place in first.items() if place and place != asset)
    return found + [f"{' starts in '.join([*ring, ring[0]])}: that is a circle" for ring in rings]


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

    instruction: str | None
    text: str = Field(min_length=1)
    relations: list[Relation] = Field(min_length=1)
    target: RunPath = Field(description="path of the target picture in the run folder")
    checks: dict[str, Any] = Field(default={}, description="relations_solvable: share that can be kept at once…")
    notes: list[str] = Field(default=[], description="what a person should know about the picture")
