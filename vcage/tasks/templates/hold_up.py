"""Hold up: an object is lifted, and still held when the episode ends."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from vcage.base.geometry import Pose
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Refusal, Subtask, TemplateName
from vcage.tasks.feasibility import Transfer, examine
from vcage.tasks.findings import best_first
from vcage.tasks.holding import SETTINGS as HOLDING
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.stowing import reached
from vcage.tasks.templates.proposal import Proposal, carried
from vcage.tasks.workplace import Workplace

NAME: TemplateName = "hold_up"


class HoldUp:
    """The template, on request."""

    name = NAME

    def proposals(self, objects: Sequence[SceneObject], asked: Collection[Goal]) -> tuple[list[Holding], list[Refusal]]:
        """Each object to hold up, and those that cannot be carried."""
        return carried(Holding, NAME, "held_up", objects, asked)

    def calls(self, subtask: Subtask) -> list[str]:
        """The lines of the script's ``play``; GRASPS is a constant of the script."""
        return [
            f"task.pick({subtask.object!r}, grasps=[(contact, arm) for contact, arm, _ in GRASPS])",
            "task.hold()",
        ]


@dataclass(frozen=True)
class Holding(Proposal):
    """An object to hold in the air."""

    def examine(self, workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task if an arm can lift the object, else a refusal for each contact point."""
        there = reached(self.thing, workplace.others(self.thing.id))
        thing, others = there.thing, tuple(there.others)
        up = [Pose(thing.pose.p + [0.0, 0.0, HOLDING.lift_m], thing.pose.q)]
        contacts = thing.asset.annotation.carrying_points
        transfers = {c.id: Transfer(thing, c, "its place in the air", up, [], (), others) for c in contacts}
        findings, refused = self.judged({c: examine(t, workplace) for c, t in transfers.items()})
        if not findings:
            return None, refused
        grasps, checks = best_first(findings)
        slots = {"grasps": grasps, "checks": checks, "grasped": thing.id, "requires": there.requires}
        return self.subtask(f"{self.thing.id}-held-up", workplace.objects, **slots), refused
