"""Objects of a scene in the slots of a template: one unit of the search."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

from vcage.plans.actions import HOLDING
from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE
from vcage.schema.subtasks import Check, PairQuestion, Refusal, Subtask, TemplateName
from vcage.tasks.asked_arms import arm_for, bound_to
from vcage.tasks.findings import Feasibility
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.wording import wordings
from vcage.tasks.workplace import Workplace


@dataclass(frozen=True)
class Proposal(ABC):
    """An object, and its wanted goal.

    Args:
        name: of the template.
        thing: its object.
        goal: the goal it would achieve.
    """

    name: TemplateName
    thing: SceneObject
    goal: Goal

    @property
    def candidates(self) -> int:
        """Number of ways to try it: one for each contact point that the object is carried by."""
        return len(self.thing.asset.annotation.carrying_points)

    @property
    def goals(self) -> list[Goal]:
        """Goals it would achieve, its own first."""
        return [self.goal]

    @property
    def hand_to(self) -> str | None:
        """The arm that puts it down, if another one takes it."""
        return None

    def impossible(self) -> Refusal | None:
        """The refusal of a proposal that can be ruled out without asking; None for the others."""
        return None

    def question(self) -> PairQuestion | None:
        """The question to the reasoner; None where no question is needed."""
        return None

    @property
    def templates(self) -> tuple[TemplateName, ...]:
        """Templates that its sub-task may name."""
        return (self.name,)

    def offers(self, subtask: Subtask) -> bool:
        """True where a sub-task is this one with a way to do it."""
        same_goals = {self.goal} <= {*subtask.goals} <= {*self.goals}
        return same_goals and subtask.object == self.thing.id and subtask.receptacle in (None, TABLE)

    def examine_for(self, arms: Mapping[Goal, str], workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """As :meth:`examine`, restricted to the arm that one of its goals requires, if any.

        Args:
            arms: the required ones, by goal.
            workplace: see :meth:`examine`.
        """
        arm, why = arm_for(self.goals, arms, self.hand_to)
        if why is not None:
            return None, [self.refusal(why)]
        found, refused = self.examine(workplace.with_arms(arm, self.hand_to))
        return (None if found is None else bound_to(found, arm)), refused

    @abstractmethod
    def examine(self, workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task if a candidate is feasible, and a refusal for each that is not.

        Args:
            workplace: with all objects of the scene.
        """

    def refusal(self, reason: str, contact: int | None = None, checks: Sequence[Check] = ()) -> Refusal:
        """A refusal of the proposal, or of one contact point."""
        return Refusal(
            template=self.name,
            object=self.thing.id,
            contact=contact,
            goal=self.goal,
            reason=reason,
            checks=list(checks),
        )

    def not_carried(self) -> Refusal:
        """The refusal of an object without a contact point to carry it by."""
        return self.refusal(f"{self.thing.record.phrase} has no contact point to carry it by")

    def judged(self, findings: Mapping[int, Feasibility]) -> tuple[list[Feasibility], list[Refusal]]:
        """The feasible ones of some findings, by contact point, and the refusals of the others."""
        refused = [self.refusal(f.reason, contact, f.checks) for contact, f in findings.items() if not f.feasible]
        return [finding for finding in findings.values() if finding.feasible], refused

    def subtask(self, identifier: str, objects: Sequence[SceneObject], **slots: Any) -> Subtask:
        """The sub-task, in the words of its goal.

        Args:
            identifier: of the sub-task.
            objects: all of the scene.
            slots: fields of the sub-task, in place of the usual ones.
        """
        text, *others = wordings(self.goal, {o.id: o.record.phrase for o in objects}, tool=slots.get("tool"))
        usual: dict[str, Any] = {"template": self.name, "text": text, "texts": others, "goals": [self.goal]}
        return Subtask(id=identifier, object=self.thing.id, script=f"subtasks/{identifier}.py", **(usual | slots))


def stood_up(thing: SceneObject) -> list[Goal]:
    """The goal that is true besides where a thing that starts on its side is put down; none of others."""
    return [] if thing.asset.standing is None else [Goal(subject=thing.id, relation="upright")]


def stands_up_elsewhere(subtask: Subtask, asked: Collection[Goal]) -> bool:
    """True where something is stood up as asked, in or on a thing that nobody named."""
    place, *others = subtask.goals
    unasked = place.relation in HOLDING and place.reference != TABLE and place not in asked
    return unasked and any(goal in asked for goal in others)


P = TypeVar("P", bound=Proposal)


def carried(
    kind: Callable[[TemplateName, SceneObject, Goal], P],
    name: TemplateName,
    word: str,
    objects: Sequence[SceneObject],
    asked: Collection[Goal],
) -> tuple[list[P], list[Refusal]]:
    """A proposal for each requested goal of a word, and the refusals of those whose object cannot be carried.

    Args:
        kind: makes a proposal.
        name: of the template.
        word: of the goals.
        objects: of the scene.
        asked: the requested goals.
    """
    by_id = {o.id: o for o in objects}
    goals = sorted((goal for goal in asked if goal.relation == word and goal.subject in by_id), key=str)
    found = [kind(name, by_id[goal.subject], goal) for goal in goals]
    return [one for one in found if one.candidates], [one.not_carried() for one in found if not one.candidates]
