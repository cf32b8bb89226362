"""Sub-tasks: the tried ones, the feasible ones, and the chain that fulfils the instruction."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field, ValidationInfo, field_validator, model_validator

from vcage.schema.base import Finite, Identifier, Point3, Record, RunPath, StageDocument, require_unique
from vcage.schema.goals import Goal

TemplateName = Identifier
"""Name of a kind of sub-task (:data:`vcage.tasks.templates.TEMPLATES`)."""


class Check(Record):
    """One feasibility check of a candidate, with the measured and the allowed value."""

    name: Literal[
        "fits", "opening", "way_free", "reach_grasp", "reach_place", "reach_motion", "drop",
        "room_for_hands", "reach_meeting",
    ]  # fmt: skip
    passed: bool
    message: str = Field(description="one sentence for a person")
    value: Finite | None = None
    limit: Finite | None = None


class Grasp(Record):
    """A contact point that an arm reaches, with how well."""

    contact: int = Field(ge=0, description="id of the contact point, or direction of a push: 30° each from its +x")
    arm: str
    score: Finite = Field(description="higher is better: minus the joint travel of the whole motion, radians")


class Preference(Record):
    """The grasp that a reasoner would rather have."""

    contact: int = Field(ge=0, description="as of a grasp")
    arm: Identifier


StatementWord = Literal["unmoved", "open", "closed", "inside", "on"]
"""States that can be said to stay as it was; ``unmoved``: where and as it stood before the sub-task."""


class Statement(Record):
    """A statement that a sub-task must leave true: checked besides its goals, by the simulator and by the critic."""

    subject: Identifier = Field(description="id of an object")
    word: StatementWord
    reference: Identifier | None = Field(default=None, description="id of the object that it lies in or on")
    part: Identifier | None = Field(default=None, description="moving part of the subject, or of the reference")

    @model_validator(mode="after")
    def _check_fields_of_word(self) -> Statement:
        if (self.reference is not None) != (self.word in ("inside", "on")):
            raise ValueError(f"{self.word!r} takes {'no' if self.reference else 'a'} reference")
        if self.word in ("open", "closed") and self.part is None:
            raise ValueError(f"{self.word!r} needs the moving part")
        if self.word == "unmoved" and self.part is not None:
            raise ValueError("'unmoved' takes no part")
        return self

    @property
    def goal(self) -> Goal | None:
        """The same as a goal; None for unmoved, which is about no single state."""
        if self.word == "unmoved":
            return None
        return Goal(subject=self.subject, relation=self.word, reference=self.reference, part=self.part)

    def __str__(self) -> str:
        """As in ``cabinet/drawer_top closed``."""
        return f"{self.subject} unmoved" if self.goal is None else str(self.goal)


class Subtask(Record):
    """A kept sub-task: proven feasible, with a script of its own."""

    id: Identifier
    template: TemplateName
    text: str = Field(min_length=1, description="the sub-task in words: what the critic is asked about")
    texts: list[str] = Field(default=[], description="the same in other words, for training on language")
    object: Identifier = Field(description="what is moved, or whose part is")
    receptacle: Identifier | None = Field(default=None, description="where it is put; 'table' for the table")
    functional_point: int | None = Field(default=None, ge=0, description="of the receptacle")
    tool: Identifier | None = Field(default=None, description="what it is done with: a scanner")
    grasped: Identifier | None = Field(default=None, description="what the hand takes, where that may be the tool")
    target: Finite | None = Field(default=None, description="target of the joint of a part, metres or radians")
    grasps: list[Grasp] = Field(min_length=1, description="feasible grasps: the preferred one, then by joint travel")
    prefers: Preference | None = Field(default=None, description="grasp to try first if feasible; None: the best")
    arm: Identifier | None = Field(default=None, description="required arm, of a hand-over the giving one; None: any")
    hand_to: Identifier | None = Field(default=None, description="arm that takes it from the one that grasped it")
    requires: list[Goal] = Field(default=[], description="what must be true before")
    goals: list[Goal] = Field(min_length=1, description="what it brings about")
    statements: list[Statement] = Field(default=[], description="what else must be true afterwards: it stays as it was")
    script: RunPath = Field(description="path in the run folder")
    checks: list[Check] = Field(description="of the grasp with the shortest motion")


class Refusal(Record):
    """A candidate that was not kept, and why."""

    template: TemplateName
    object: Identifier
    contact: int | None = Field(default=None, description="as of a grasp; not given where it is not about one")
    receptacle: Identifier | None = Field(default=None, description="object that it would have been put in or on")
    functional_point: int | None = Field(default=None, description="of the receptacle")
    goal: Goal | None = Field(default=None, description="what it would have brought about")
    reason: str = Field(min_length=1)
    checks: list[Check] = []


class Chain(Record):
    """The sub-tasks of an episode, in order, and its name."""

    text: str = Field(min_length=1, description="name of the episodes: the instruction, or the sub-task's words")
    subtasks: list[Identifier] = Field(min_length=1, description="ids of kept sub-tasks T₁…T_k, in order")
    wordings: list[Annotated[str, Field(min_length=1)]] = Field(default=[], description="other sentences for the goals")
    wordings_dropped: int = Field(default=0, ge=0, description="sentences of a model that the review dropped")


class Subtasks(StageDocument):
    """``subtasks/subtasks.json``."""

    SCHEMA: ClassVar[str] = "vcage.subtasks/2"

    instruction: str | None
    candidates: int = Field(ge=0, description="template and contact point, or direction of a push, each counted once")
    kept: list[Subtask]
    refused: list[Refusal]
    chains: list[Chain] = Field(min_length=1, description="for the instruction; without one, one per kept sub-task")

    @field_validator("kept")
    @classmethod
    def _ids_are_unique(cls, kept: list[Subtask]) -> list[Subtask]:
        require_unique("sub-task", kept)
        return kept

    @field_validator("chains")
    @classmethod
    def _check_chain_ids(cls, chains: list[Chain], info: ValidationInfo) -> list[Chain]:
        if "kept" in info.data:
            ids = [subtask.id for subtask in info.data["kept"]]
            unknown = [name for chain in chains for name in chain.subtasks if name not in ids]
            if unknown:
                raise ValueError(f"expected kept sub-tasks ({', '.join(ids) or 'there are none'}), got {unknown[0]!r}")
        return chains


class PairQuestion(Record):
    """Question to a reasoner about a pair: can ``receptacle`` sensibly hold ``object``?"""

    object: Identifier
    object_words: str
    receptacle: Identifier
    receptacle_words: str
    holds: Literal["in", "on"]
    object_size: Point3
    opening_size: Point3 = Field(description="free space at the functional point, metres")


class PairAnswer(Record):
    """A reasoner's answer to a :class:`PairQuestion`."""

    object: Identifier
    receptacle: Identifier
    sensible: bool
    reason: str = Field(min_length=1)


class GraspOption(Record):
    """A feasible grasp, to choose from."""

    contact: int
    name: str = Field(description="of the contact point, or the direction of a push")
    arm: str

    def __str__(self) -> str:
        """As in ``2 left``."""
        return f"{self.contact} {self.arm}"


class PlaceOption(Record):
    """A functional point for a sub-task, with the grasps from which it is reached."""

    point: int
    name: str
    subtask: Identifier = Field(description="the kept sub-task that uses it")
    grasps: list[GraspOption]


class SlotQuestion(Record):
    """Choices of a reasoner in one sub-task of a chain: everything in it is feasible and can be checked."""

    subtask: Identifier
    text: str
    held: str = Field(description="what the hand takes, in words")
    grasps: list[GraspOption] = Field(description="best first, at the place that is planned")
    places: list[PlaceOption] = Field(default=[], description="where there are several, the planned one first")
    statements: list[Statement] = Field(default=[], description="what stays as it is, by the plan")

    @property
    def is_open(self) -> bool:
        """Check if there is anything to choose."""
        return len(self.grasps) > 1 or len(self.places) > 1 or bool(self.statements)


class SlotAnswer(Record):
    """A reasoner's answer to a :class:`SlotQuestion`; the ranking decides missing choices."""

    subtask: Identifier
    grasp: Preference | None = None
    point: int | None = None
    statements: list[Statement] = []
