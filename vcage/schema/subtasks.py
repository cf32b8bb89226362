"""Sub-tasks: what was tried, what is feasible, and the chain that fulfils the instruction."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field

from vcage.schema.asset import CatalogueEntry
from vcage.schema.base import Finite, Identifier, Record, StageDocument, Vec3
from vcage.schema.plan import RelationWord

TemplateName = Literal["pick_and_place"]


class Check(Record):
    """One feasibility check of a candidate, with what was measured against what is allowed."""

    name: Literal["fits", "opening", "way_free", "reach_grasp", "reach_place", "drop"]
    passed: bool
    message: str = Field(description="one sentence for a person")
    value: Finite | None = None
    limit: Finite | None = None


class Grasp(Record):
    """A contact point that an arm reaches, with how well."""

    contact: int = Field(ge=0)
    arm: str
    score: Finite = Field(description="higher is better: minus the joint travel of the whole motion, radians")


class Goal(Record):
    """What must be true afterwards, in the closed vocabulary of relations."""

    subject: Identifier
    relation: RelationWord
    reference: Identifier


class Subtask(Record):
    """A kept sub-task: proven feasible, with a script of its own."""

    id: Identifier
    template: TemplateName
    text: str = Field(min_length=1, description="the sub-task in words: what the critic is asked about")
    object: Identifier
    receptacle: Identifier
    functional_point: int = Field(ge=0)
    grasps: list[Grasp] = Field(min_length=1, description="feasible grasps, best first")
    goals: list[Goal] = Field(min_length=1)
    script: str = Field(description="path in the run folder")
    checks: list[Check] = Field(description="of the best grasp")


class Refusal(Record):
    """A candidate that was not kept, and why."""

    template: TemplateName
    object: Identifier
    contact: int | None = None
    receptacle: Identifier
    functional_point: int | None = None
    reason: str = Field(min_length=1)
    checks: list[Check] = []


class Subtasks(StageDocument):
    """``subtasks/subtasks.json``."""

    SCHEMA: ClassVar[str] = "vcage.subtasks/1"

    instruction: str
    candidates: int = Field(ge=0, description="ordered pairs × contact points × functional points that were examined")
    kept: list[Subtask]
    refused: list[Refusal]
    chain: list[Identifier] = Field(
        description="ids of the kept sub-tasks T₁…T_k that fulfil the instruction, in order"
    )


class PairQuestion(Record):
    """What a reasoner is asked about a pair: can ``receptacle`` sensibly hold ``object``?"""

    object: Identifier
    object_words: str
    receptacle: Identifier
    receptacle_words: str
    holds: Literal["in", "on"]
    object_size: Vec3
    opening_size: Vec3 = Field(description="free space at the functional point, metres")


class PairAnswer(Record):
    """A reasoner's answer to a :class:`PairQuestion`: the filter, and the slots of the template."""

    object: Identifier
    receptacle: Identifier
    sensible: bool
    reason: str = Field(min_length=1)
    text: str = Field(default="", description="the sub-task as an imperative sentence; empty when not sensible")
    relation: Literal["inside", "on"] = Field(default="inside", description="what must hold afterwards")


class ChainOption(Record):
    """A feasible sub-task as a reasoner sees it when it composes the task."""

    id: Identifier
    text: str
    object: Identifier
    receptacle: Identifier
    object_kind: CatalogueEntry = Field(description="the catalogue's entry of the object, with the look that it has")
    receptacle_kind: CatalogueEntry = Field(description="likewise of the receptacle")

    @classmethod
    def of(cls, subtask: Subtask, object_kind: CatalogueEntry, receptacle_kind: CatalogueEntry) -> ChainOption:
        """The option of a kept sub-task."""
        return cls(
            id=subtask.id,
            text=subtask.text,
            object=subtask.object,
            receptacle=subtask.receptacle,
            object_kind=object_kind,
            receptacle_kind=receptacle_kind,
        )
