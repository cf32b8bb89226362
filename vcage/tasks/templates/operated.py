"""The common part of opening, closing, pressing and turning: a hand brings a moving part to a position."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

from vcage.schema.asset import ContactPoint, Joint
from vcage.schema.goals import Goal, part_that
from vcage.schema.subtasks import Refusal, Subtask, TemplateName
from vcage.tasks.access import shut_above
from vcage.tasks.operating import examine_operation
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates.proposal import Proposal
from vcage.tasks.workplace import Workplace


@dataclass(frozen=True)
class Operated:
    """A template for parts that are operated.

    Args:
        name: of the template.
        action: which parts: those that ``open``, are ``press``-ed, or ``turn``-ed.
        word: the goal that it brings about.
        start, target: where the joint is before and after.
        opposite: the goal that must be true before.
    """

    name: TemplateName
    action: str
    word: str
    start: Callable[[Joint], float]
    target: Callable[[Joint], float]
    opposite: str | None = None

    def proposals(
        self, objects: Sequence[SceneObject], asked: Collection[Goal]
    ) -> tuple[list[Operable], list[Refusal]]:
        """Every part of the kind with each of its contact points, and the parts that have none."""
        found, refused = [], []
        for thing in objects:
            for part in (link.name for link in thing.asset.model.links if part_that(self.action, link.name)):
                contacts = [c for c in thing.asset.annotation.contact_points if c.link == part]
                goal = Goal(subject=thing.id, relation=self.word, part=part)
                if not contacts:
                    reason = f"{thing.record.phrase} has no contact point on its {part} to {self.name} it by"
                    refused.append(Refusal(template=self.name, object=thing.id, goal=goal, reason=reason))
                found += [Operable(self.name, thing, goal, self, part, contact) for contact in contacts]
        return found, refused

    def calls(self, subtask: Subtask) -> list[str]:
        """The line of the script's ``play``; GRASPS is a constant of the script."""
        return [f"task.operate({subtask.object!r}, GRASPS[0][0], {subtask.target}, arms=[arm for _, arm, _ in GRASPS])"]


@dataclass(frozen=True)
class Operable(Proposal):
    """A part of an object with a contact point on it."""

    template: Operated
    part: str
    contact: ContactPoint

    @property
    def candidates(self) -> int:
        """One: a contact point."""
        return 1

    def offers(self, subtask: Subtask) -> bool:
        """True where a sub-task brings the part there."""
        target = round(self.template.target(self.thing.asset.model.link(self.part).joint), 4)
        return super().offers(subtask) and subtask.target == target

    def examine(self, workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task if an arm can follow the part's motion, else the refusal."""
        joint = self.thing.asset.model.link(self.part).joint
        target = self.template.target(joint)
        finding = examine_operation(
            self.thing.with_part(self.part, self.template.start(joint)),
            self.contact,
            target,
            workplace.others(self.thing.id),
            workplace.kinematics,
        )
        if not finding.feasible:
            return None, [self.refusal(finding.reason, self.contact.id, finding.checks)]
        return (
            self.subtask(
                f"{self.name}-{self.thing.id}-{self.part}",
                workplace.objects,
                target=round(target, 4),
                grasps=finding.grasps,
                requires=self._requires(),
                checks=finding.checks,
            ),
            [],
        )

    def _requires(self) -> list[Goal]:
        """Goals that must be true before: the other position, and no open drawer above the hand."""
        opposite = self.template.opposite
        if opposite is None:
            return []
        return [Goal(subject=self.thing.id, relation=opposite, part=self.part), *shut_above(self.thing, self.part)]
