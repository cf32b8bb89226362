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
from vcage.schema.subtasks import Refusal, Subtask, TemplateName
from vcage.sim.kinematics import ArmKinematics
from vcage.tasks.feasibility import Transfer, best_first
from vcage.tasks.ground import Ground
from vcage.tasks.passing import examine_passing
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates.proposal import Proposal

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
        return [Handing(NAME, by_id[goal.subject], goal) for goal in goals], []

    def calls(self, subtask: Subtask) -> list[str]:
        """The lines of the script's ``play``; GRASPS is a constant of the script."""
        point = subtask.functional_point
        where = "" if point is None else f"{subtask.receptacle!r}, point={point}"
        grasps = "[(contact, arm) for contact, arm, _ in GRASPS]"
        return [
            f"task.pick({subtask.object!r}, grasps={grasps}, hand_to={subtask.hand_to!r})",
            f"task.hand_over({subtask.hand_to!r})",
            f"task.place({where})",
            "task.home()",
        ]


@dataclass(frozen=True)
class Handing(Proposal):
    """An object and the arm that shall have it."""

    def impossible(self) -> Refusal | None:
        """What cannot be carried."""
        return None if self.candidates else self.not_carried()

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
            return None, [self.refusal(f"the arms are {', '.join(kinematics)}: none hands anything to {to!r}")]
        others = [o for o in objects if o.id != self.thing.id]
        poses = list(islice(ground.poses(self.thing, self.goal, others, rng), SPOTS))
        if not poses:
            return None, [self.refusal(f"there is no room on the table on the side of the {to} arm")]
        contacts = self.thing.asset.annotation.carrying_points
        transfers = {c.id: Transfer.onto_table(self.thing, c, poses, others) for c in contacts}
        findings, refused = self.judged(
            {contact: examine_passing(t, to, kinematics, ground.height) for contact, t in transfers.items()}
        )
        if not findings:
            return None, refused
        grasps, checks = best_first(findings)
        goals = [self.goal, Goal(subject=self.thing.id, relation="on", reference=TABLE)]
        name = f"{self.thing.id}-handed-{to}"
        return (
            self.subtask(name, objects, receptacle=TABLE, grasps=grasps, hand_to=to, goals=goals, checks=checks),
            refused,
        )
