"""Hand over: one arm takes an object, another takes it from that in the air and puts it down.

It is tried where it is asked for. What goes into or onto another object, where no arm reaches both, changes hands too:
see :mod:`~vcage.tasks.templates.place`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE
from vcage.schema.subtasks import Check, Grasp, Refusal, Subtask, TemplateName
from vcage.sim.kinematics import ArmKinematics
from vcage.tasks.feasibility import Transfer, best_first, carrying_points
from vcage.tasks.ground import Ground
from vcage.tasks.passing import examine_passing
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.wording import wordings

NAME: TemplateName = "hand_over"

SPOTS = 4
"""Places on the table that are tried before a contact point is refused."""


class HandOver:
    """The template."""

    name = NAME

    def proposals(self, objects: Sequence[SceneObject], asked: Collection[Goal]) -> tuple[list[Handing], list[Refusal]]:
        """Each object that shall be handed to an arm."""
        by_id = {o.id: o for o in objects}
        goals = sorted((g for g in asked if g.relation == "handed" and g.subject in by_id), key=str)
        return [Handing(by_id[goal.subject], goal) for goal in goals], []

    def calls(self, subtask: Subtask) -> list[str]:
        """The lines of the script's ``play``; GRASPS and POINT are constants of the script."""
        where = "" if subtask.functional_point is None else f"{subtask.receptacle!r}, point=POINT"
        grasps = "[(contact, arm) for contact, arm, _ in GRASPS]"
        return [
            f"task.pick({subtask.object!r}, grasps={grasps}, hand_to={subtask.hand_to!r})",
            f"task.hand_over({subtask.hand_to!r})",
            f"task.place({where})",
            "task.home()",
        ]


@dataclass(frozen=True)
class Handing:
    """An object and the arm that shall have it: all its contact points are candidates."""

    thing: SceneObject
    goal: Goal

    @property
    def candidates(self) -> int:
        """How many contact points there are."""
        return len(carrying_points(self.thing.asset.annotation))

    def impossible(self) -> Refusal | None:
        """What cannot be carried."""
        if self.candidates:
            return None
        return self._refusal(f"{self.thing.record.phrase} has no contact point to carry it by")

    def question(self) -> None:
        """Nobody is asked: it is tried only where it is asked for."""

    def senseless(self, reason: str) -> Refusal:
        """See :class:`vcage.tasks.templates.Proposal`; nobody is asked."""
        return self._refusal(f"not sensible: {reason}")

    def examine(
        self,
        objects: Sequence[SceneObject],
        kinematics: Mapping[str, ArmKinematics],
        ground: Ground,
        rng: np.random.Generator,
    ) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task if another arm can give it and the arm put it down, else a refusal for each contact point."""
        to = str(self.goal.reference)
        if to not in kinematics or len(kinematics) == 1:
            return None, [self._refusal(f"the arms are {', '.join(kinematics)}: none hands anything to {to!r}")]
        others = [o for o in objects if o.id != self.thing.id]
        poses = list(islice(ground.poses(self.thing, self.goal, others, rng), SPOTS))
        if not poses:
            return None, [self._refusal(f"there is no room on the table on the side of the {to} arm")]
        findings, refused = [], []
        for contact in carrying_points(self.thing.asset.annotation):
            transfer = Transfer.onto_table(self.thing, contact, poses, others)
            finding = examine_passing(transfer, to, kinematics, ground.height)
            if finding.feasible:
                findings.append(finding)
            else:
                refused.append(self._refusal(finding.reason, contact.id, finding.checks))
        phrases = {o.id: o.record.phrase for o in objects}
        return (self._subtask(phrases, *best_first(findings)) if findings else None), refused

    def _subtask(self, phrases: Mapping[str, str], grasps: list[Grasp], checks: list[Check]) -> Subtask:
        text, *others = wordings(self.goal, phrases)
        identifier = f"{self.thing.id}-handed-{self.goal.reference}"
        return Subtask(
            id=identifier,
            template=NAME,
            text=text,
            texts=others,
            object=self.thing.id,
            receptacle=TABLE,
            grasps=grasps,
            hand_to=self.goal.reference,
            goals=[self.goal, Goal(subject=self.thing.id, relation="on", reference=TABLE)],
            script=f"subtasks/{identifier}.py",
            checks=checks,
        )

    def _refusal(self, reason: str, contact: int | None = None, checks: Sequence[Check] = ()) -> Refusal:
        return Refusal(
            template=NAME,
            object=self.thing.id,
            contact=contact,
            receptacle=self.goal.reference,
            reason=reason,
            checks=list(checks),
        )
