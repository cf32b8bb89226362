"""Hand over: one arm takes an object, another takes it from that in the air and puts it down.

It is tried where it is asked for. What goes into or onto another object, where no arm reaches both, changes hands too:
see :mod:`~vcage.tasks.templates.place`.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from vcage.schema.goals import Goal
from vcage.schema.subtasks import Refusal, Subtask, TemplateName
from vcage.tasks.feasibility import Transfer
from vcage.tasks.findings import Feasibility
from vcage.tasks.passing import examine_passing
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates.set_down import Move
from vcage.tasks.workplace import Workplace

NAME: TemplateName = "hand_over"


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
class Handing(Move):
    """An object and the arm that shall have it: that arm puts it down."""

    def impossible(self) -> Refusal | None:
        """Refuse an object that cannot be carried."""
        return None if self.candidates else self.not_carried()

    def examine(self, workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task if another arm can give it and the arm put it down, else a refusal for each contact point."""
        if self.hand_to not in workplace.kinematics or len(workplace.kinematics) == 1:
            reason = f"the arms are {', '.join(workplace.kinematics)}: none hands anything to {self.hand_to!r}"
            return None, [self.refusal(reason)]
        return super().examine(workplace)

    @property
    def hand_to(self) -> str:
        """The arm that shall have it."""
        return str(self.goal.reference)

    @property
    def _wanted(self) -> str:
        return f"on the side of the {self.hand_to} arm"

    def _finding(self, transfer: Transfer, workplace: Workplace) -> Feasibility:
        return examine_passing(transfer, self.hand_to, workplace.kinematics, workplace.ground.height)

    def _identifier(self) -> str:
        return f"{self.thing.id}-handed-{self.hand_to}"
