"""Goals of an instruction in a scene: a closed vocabulary, in the order of the sentence."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticKnownError

from vcage.goals import KINDS, kind_of, words
from vcage.goals.kind import GoalKind
from vcage.goals.parts import part_words as part_words
from vcage.schema.base import Identifier, Record


def _known_word(word: str) -> str:
    """Refuse a word that is no kind of goal, as pydantic refuses a value outside some literals."""
    if word not in KINDS:
        *most, last = map(repr, words())
        raise PydanticKnownError("literal_error", {"expected": f"{', '.join(most)} or {last}"})
    return word


GoalWord = Annotated[str, AfterValidator(_known_word)]
"""The word of a kind of goal (:data:`vcage.goals.KINDS`)."""

RelationWord = Literal["inside", "on", "left_of", "right_of", "in_front_of", "behind", "beside", "near", "center"]
"""Left and right as the robot sees them (+x is right); in front is towards the robot (−y)."""

PARTS_THAT: dict[str, tuple[str, ...]] = {
    "open": ("drawer", "door", "lid", "screen"),
    "press": ("button",),
    "turn": ("dial", "lever", "knob"),
}
"""Names of parts that open and close, are pressed, or turned: the first word of a part's name."""


def part_that(action: str, part: str) -> bool:
    """Check if a moving part opens, is pressed, or turned."""
    return part.split("_")[0] in PARTS_THAT[action]


class Goal(Record):
    """Something that must be true, or must have been done."""

    subject: Identifier = Field(description="id of an object")
    relation: GoalWord
    reference: Identifier | None = Field(default=None, description="object id, or 'table'; for 'handed' the arm")
    part: Identifier | None = Field(default=None, description="part of the subject, or of the reference")

    @model_validator(mode="after")
    def _check_fields_of_word(self) -> Goal:
        takes = KINDS[self.relation].refers_to is not None
        if (self.reference is not None) != takes:
            raise ValueError(f"{self.relation!r} takes {'a' if takes else 'no'} reference")
        if self.kind.acts_on is not None and self.part is None:
            raise ValueError(f"{self.relation!r} needs the moving part")
        return self

    @property
    def kind(self) -> GoalKind:
        """All that is known of such goals."""
        return kind_of(self)

    def __str__(self) -> str:
        """As in ``marker_red inside cabinet/drawer_top``."""
        if self.kind.acts_on is not None:
            return f"{self.subject}/{self.part} {self.relation}"
        place = f" {self.reference}" if self.reference else ""
        return f"{self.subject} {self.relation}{place}{f'/{self.part}' if self.part else ''}"


def goal_of(values: Sequence[str | None]) -> Goal:
    """A goal from its subject, relation, reference and part; omitted last ones are None."""
    return Goal.model_validate(dict(zip(("subject", "relation", "reference", "part"), values, strict=False)))


class AskedGoal(Record):
    """A goal of an instruction, and the words that it answers."""

    goal: Goal
    step: int = Field(ge=0, description="goals of an earlier step come first; those of one step in any order")
    words: str = Field(min_length=1, description="the words of the instruction that ask for it")
    arm: Identifier | None = Field(default=None, description="the arm that must do it; any arm when not given")


def in_steps(asked: Iterable[AskedGoal]) -> tuple[frozenset[Goal], ...]:
    """The goals by step, in their order."""
    found = list(asked)
    return tuple(frozenset(a.goal for a in found if a.step == step) for step in sorted({a.step for a in found}))


class Description(Record):
    """Place of an object in every starting layout: it identifies the object, or names its source."""

    subject: Identifier = Field(description="id of an object")
    relation: RelationWord = Field(description="to another object, or to the table: a third of it")
    reference: Identifier = Field(description="id of another object, or 'table'")
    part: Identifier | None = Field(default=None, description="moving part of the reference that it lies in: a drawer")
    words: str = Field(min_length=1, description="the words of the instruction that say so")

    @model_validator(mode="after")
    def _is_of_two(self) -> Description:
        if self.subject == self.reference:
            raise ValueError(f"{self.subject} cannot be {self.relation} itself")
        if self.part is not None and self.relation not in ("inside", "on"):
            raise ValueError(f"{self.relation!r} takes no part")
        return self

    def __str__(self) -> str:
        """As in ``plate_white left_of plate_blue``."""
        return f"{self.subject} {self.relation} {self.reference}{f'/{self.part}' if self.part else ''}"


class Reading(Record):
    """A reasoner's understanding of an instruction in a scene."""

    goals: list[AskedGoal] = Field(min_length=1)
    untouched: list[Identifier] = Field(default=[], description="objects that the instruction wants left alone")
    descriptions: list[Description] = Field(default=[], description="what must be true at the start")

    @property
    def stated(self) -> list[Goal | Description]:
        """The goals, and then the facts about the start."""
        return [*(asked.goal for asked in self.goals), *self.descriptions]

    @property
    def in_goals(self) -> set[str | None]:
        """Subjects and references of the goals."""
        return {*named_by(asked.goal for asked in self.goals)}


def named_by(stated: Iterable[Goal | Description]) -> list[str | None]:
    """Subjects and references, in their order."""
    return [name for one in stated for name in (one.subject, one.reference)]
