"""Scan: a scanner is held before the bar code of an object, or the object's code before a scanner that stays."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property

from vcage.schema.goals import Goal
from vcage.schema.subtasks import Refusal, Subtask, TemplateName
from vcage.tasks.feasibility import Transfer, examine
from vcage.tasks.findings import Feasibility, best_first
from vcage.tasks.reading import free_reading_poses, in_the_way
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates.proposal import Proposal
from vcage.tasks.workplace import Workplace

NAME: TemplateName = "scan"


class Scan:
    """The template: every object that has a bar code with every scanner."""

    name = NAME

    def proposals(self, objects: Sequence[SceneObject], asked: Collection[Goal]) -> tuple[list[Reading], list[Refusal]]:
        """Each code with each scanner, and objects to scan without a code."""
        scanners = [o for o in objects if o.asset.annotation.faces_of("reader")]
        found, refused = [], []
        for thing in objects:
            goal = Goal(subject=thing.id, relation="scanned")
            if thing.asset.annotation.faces_of("code"):
                found += [Reading(NAME, thing, goal, scanner) for scanner in scanners]
            elif goal in asked:
                reason = f"{thing.record.phrase} has no bar code"
                refused.append(Refusal(template=NAME, object=thing.id, goal=goal, reason=reason))
        return found, refused

    def calls(self, subtask: Subtask) -> list[str]:
        """The lines of the script's ``play``; GRASPS is a constant of the script."""
        moved = subtask.grasped or subtask.object
        still = subtask.object if moved == subtask.tool else subtask.tool
        return [
            f"task.show({moved!r}, {still!r}, grasps=[(contact, arm) for contact, arm, _ in GRASPS])",
            "task.home()",
        ]


@dataclass(frozen=True)
class Reading(Proposal):
    """A bar code and a scanner; one is moved to the other, preferably the scanner."""

    scanner: SceneObject

    @cached_property
    def _ways(self) -> list[tuple[SceneObject, SceneObject]]:
        """(moved object, resting object)."""
        both = [(self.scanner, self.thing), (self.thing, self.scanner)]
        return [(mover, still) for mover, still in both if mover.asset.annotation.carrying_points]

    @property
    def candidates(self) -> int:
        """Number of contact points on the objects that can be moved."""
        return sum(len(mover.asset.annotation.carrying_points) for mover, _ in self._ways)

    def offers(self, subtask: Subtask) -> bool:
        """True where a sub-task shows the one to the other."""
        carried = [mover.id for mover, _ in self._ways]
        return super().offers(subtask) and subtask.tool == self.scanner.id and subtask.grasped in carried

    def impossible(self) -> Refusal | None:
        """One of the two must be portable."""
        if self._ways:
            return None
        return self.refusal(f"neither {self.thing.record.phrase} nor {self.scanner.record.phrase} can be carried")

    def examine(self, workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task if an arm can hold the one before the other, else a refusal for each contact point."""
        refused: list[Refusal] = []
        for mover, still in self._ways:
            findings, complaints = self._findings(mover, still, workplace)
            refused += complaints
            if findings:
                grasps, checks = best_first(findings)
                name = f"{self.thing.id}-scanned-by-{self.scanner.id}"
                slots = {"tool": self.scanner.id, "grasped": mover.id}
                return self.subtask(name, workplace.objects, grasps=grasps, checks=checks, **slots), refused
        return None, refused

    def _findings(
        self, mover: SceneObject, still: SceneObject, workplace: Workplace
    ) -> tuple[list[Feasibility], list[Refusal]]:
        others = tuple(workplace.others(mover.id))
        beside = [o for o in others if o.id != still.id]
        where, refused = f"its place before {still.record.phrase}", list[Refusal]()
        for poses in free_reading_poses(mover, still, beside, workplace.ground.height):
            contacts = mover.asset.annotation.carrying_points
            transfers = {c.id: Transfer(mover, c, where, poses, [], (), others) for c in contacts}
            findings, refused = self.judged({c: examine(t, workplace) for c, t in transfers.items()})
            if findings:
                return findings, refused
        return [], refused or [self._without_room(mover, still, beside, workplace)]

    def _without_room(
        self, mover: SceneObject, still: SceneObject, beside: Sequence[SceneObject], workplace: Workplace
    ) -> Refusal:
        met = in_the_way(mover, still, beside, workplace.ground.height)
        if met is None:
            return self.refusal(f"{mover.record.phrase} cannot be held before {still.record.phrase}")
        return self.refusal(f"{mover.record.phrase} would touch {met.record.phrase} before {still.record.phrase}")
