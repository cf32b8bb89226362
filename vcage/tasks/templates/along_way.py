"""Along a way: a thing in a hand is brought to another one, and goes through some poses there.

Pouring, hanging and inserting are such sub-tasks: each says which ways there are, and what rules them out.
"""

from __future__ import annotations

from abc import abstractmethod
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

from vcage.base.geometry import Pose
from vcage.schema.asset import ContactPoint
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Check, Refusal, Subtask, TemplateName
from vcage.sim.kinematics import ArmKinematics
from vcage.tasks.feasibility import Pick, opens_wide_enough, picks
from vcage.tasks.findings import Feasibility, Report, best_first, reach_check, travel
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates.proposal import Proposal, carried
from vcage.tasks.ways import continuous_path
from vcage.tasks.workplace import Workplace


@dataclass(frozen=True)
class AlongWay(Proposal):
    """A thing, and its goal at a target to which an arm brings it along a way.

    Args:
        target: the object of the goal's reference.

    Attributes:
        done: words between the two in the identifier of the sub-task.
    """

    target: SceneObject
    done: ClassVar[str]

    @abstractmethod
    def misfit(self) -> str | None:
        """Why the two do not suit each other wherever they stand; None where they may."""

    @abstractmethod
    def unfit(self, others: Sequence[SceneObject]) -> str | None:
        """Why it is not done as all others stand now, whatever an arm can do; None where it may be."""

    @abstractmethod
    def suitable(
        self, contact: ContactPoint, kinematics: Mapping[str, ArmKinematics]
    ) -> tuple[dict[str, ArmKinematics], str]:
        """The arms that hold the thing at a contact point as it must be held; why there is none otherwise."""

    @abstractmethod
    def ways(self, contact: ContactPoint, others: Sequence[SceneObject]) -> Iterable[Sequence[Pose]]:
        """Poses of the thing that is held at a contact point, from before the target on; in the order to try."""

    @property
    @abstractmethod
    def where(self) -> str:
        """The place to which an arm must reach, in words."""

    def too_many(self, number: int) -> str | None:
        """Why that many things do not go to the target; None where they may."""
        return None

    def around(self, others: Sequence[SceneObject]) -> tuple[SceneObject, ...]:
        """Those of all others that do not move with the thing."""
        return tuple(others)

    def impossible(self) -> Refusal | None:
        """Refuse two that do not suit each other, and a thing that does not stand on the table."""
        if (why := self.misfit()) is not None:
            return self.refusal(why)
        if self.thing.record.container is not None:
            return self.refusal(f"{self.thing.record.phrase} does not stand on the table; put it there first")
        return None

    def examine(self, workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task if an arm can bring the thing along a way, else a refusal for each contact point."""
        others = workplace.others(self.thing.id)
        if (why := self.unfit(others)) is not None:
            return None, [self.refusal(why)]
        found, refused = dict[int, Feasibility](), list[Refusal]()
        for contact in self.thing.asset.annotation.carrying_points:
            arms, why = self.suitable(contact, workplace.kinematics)
            if arms:
                found[contact.id] = self._examined(contact, arms, others, workplace.ground.height)
            else:
                refused.append(self.refusal(why, contact.id))
        findings, others_refused = self.judged(found)
        if not findings:
            return None, [*refused, *others_refused]
        grasps, checks = best_first(findings)
        slots = {"grasps": grasps, "checks": checks, "grasped": self.thing.id}
        identifier = f"{self.thing.id}-{self.done}-{self.target.id}"
        return self.subtask(identifier, workplace.objects, **slots), [*refused, *others_refused]

    def _examined(
        self,
        contact: ContactPoint,
        kinematics: Mapping[str, ArmKinematics],
        others: Sequence[SceneObject],
        table_height: float,
    ) -> Feasibility:
        """The findings for some arms: one must grasp the thing at a contact point, and follow a way."""
        wide = opens_wide_enough(self.thing, contact, kinematics)
        if not wide.passed:
            return Feasibility([wide], [])
        ways, around = list(self.ways(contact, others)), self.around(others)
        reports = {
            arm: self._report(ways, picks(self.thing, contact.id, around, arm, one, table_height), arm, one)
            for arm, one in kinematics.items()
        }
        return Feasibility.of_arms(contact.id, [wide], reports)

    def _report(
        self, ways: Sequence[Sequence[Pose]], picked: Sequence[Pick], arm: str, kinematics: ArmKinematics
    ) -> Report:
        """The checks of an arm, and the score of its straightest grasp with which it follows a way."""
        found = list[Check]()
        for pick in picked:
            if pick.path is None:
                found = found or pick.checks
                continue
            held, start = pick.grasp.in_object, pick.path[-1]
            paths = (continuous_path(kinematics, way, held, start) for way in ways)
            path = next((path for path in paths if path is not None), None)
            found = [*pick.checks, reach_check("reach_motion", self.where, path is not None, arm)]
            if path is not None:
                return found, -travel([kinematics.home, *pick.path, *path, kinematics.home])
        return found, None


@dataclass(frozen=True)
class AlongTemplate:
    """A template that brings a thing along a way to another one, on request.

    Args:
        name: of the template, and of the call of the task API.
        word: the goal that it achieves.
        kind: of its proposals.
    """

    name: TemplateName
    word: str
    kind: type[AlongWay]

    def proposals(
        self, objects: Sequence[SceneObject], asked: Collection[Goal]
    ) -> tuple[list[AlongWay], list[Refusal]]:
        """Each requested thing with the target that stands there; the refusals of those that cannot be carried, or are
        too many for their target."""
        by_id = {o.id: o for o in objects}
        goals = [goal for goal in asked if goal.relation == self.word and goal.reference in by_id]
        number = Counter(str(goal.reference) for goal in goals)

        def proposal(name: TemplateName, thing: SceneObject, goal: Goal) -> AlongWay:
            return self.kind(name, thing, goal, by_id[str(goal.reference)])

        found, refused = carried(proposal, self.name, self.word, objects, goals)
        possible = list[AlongWay]()
        for one in found:
            if (why := one.too_many(number[one.target.id])) is None:
                possible.append(one)
            else:
                refused.append(one.refusal(why))
        return possible, refused

    def calls(self, subtask: Subtask) -> list[str]:
        """The lines of the script's ``play``; GRASPS is a constant of the script."""
        grasps, target = "[(contact, arm) for contact, arm, _ in GRASPS]", subtask.goals[0].reference
        return [f"task.{self.name}({subtask.object!r}, {target!r}, grasps={grasps})", "task.home()"]
