"""Hold with both: two arms lift an object together, and still hold it when the episode ends."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from vcage.schema.goals import Goal
from vcage.schema.subtasks import Check, Grasp, Refusal, Subtask, TemplateName
from vcage.sim.motion import MotionFailed
from vcage.tasks.holds_with_both import Hands, holds_with_both
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.stowing import reached
from vcage.tasks.templates.proposal import Proposal, carried
from vcage.tasks.workplace import Workplace

NAME: TemplateName = "hold_with_both"


class HoldWithBoth:
    """The template, on request."""

    name = NAME

    def proposals(
        self, objects: Sequence[SceneObject], asked: Collection[Goal]
    ) -> tuple[list[HoldingWithBoth], list[Refusal]]:
        """Each object that both arms are to hold, and those that cannot be carried."""
        return carried(HoldingWithBoth, NAME, "held_by_both", objects, asked)

    def calls(self, subtask: Subtask) -> list[str]:
        """The lines of the script's ``play``."""
        return [f"task.hold_with_both({subtask.object!r})"]


@dataclass(frozen=True)
class HoldingWithBoth(Proposal):
    """An object for both arms to hold in the air."""

    def examine(self, workplace: Workplace) -> tuple[Subtask | None, list[Refusal]]:
        """The sub-task if two arms can take the object at two places and lift it, else the reason."""
        if len(workplace.kinematics) != 2:
            arms = " and ".join(workplace.kinematics)
            return None, [self.refusal(f"it takes two arms that are free, and only the {arms} arm may do it")]
        there = reached(self.thing, workplace.others(self.thing.id))
        others = [o for o in there.others if o.record.container != self.thing.id]
        try:
            hands = next(holds_with_both(there.thing, workplace.kinematics, others))
        except MotionFailed as error:
            return None, [self.refusal(error.message)]
        slots = {"grasps": self._grasps(hands), "checks": self._checks(hands), "requires": there.requires}
        return self.subtask(f"{self.thing.id}-held-by-both", workplace.objects, **slots), []

    def _grasps(self, hands: Hands) -> list[Grasp]:
        """The contact point from which each hand's place was found."""
        return [Grasp(contact=hand.contact.id, arm=arm, score=0.0) for arm, hand in hands.items()]

    def _checks(self, hands: Hands) -> list[Check]:
        phrase = self.thing.record.phrase
        return [
            Check(name="reach_grasp", passed=True, message=f"the {arm} arm reaches {hand.contact.name!r} of {phrase}")
            for arm, hand in hands.items()
        ]
