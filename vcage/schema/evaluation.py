"""``evaluation.json``: how a policy did in the environment of a run."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field

from vcage.base.proportions import wilson
from vcage.schema.base import Document, Record


class Rollout(Record):
    """One episode of a policy."""

    seed: int = Field(description="number of its start: a seed, or a recorded episode")
    instruction: str
    success: bool
    actions: int = Field(ge=0, description="that were carried out")
    seconds: float = Field(ge=0, description="of simulated time")
    goals: dict[str, bool] = Field(description="goal → true at the end, or happened")
    touched: list[str] = Field(description="objects of the task that a hand touched")
    lifted: list[str] = Field(description="objects of the task that a hand lifted")
    collisions: list[str] = Field(description="what arms hit besides the objects of the task")

    @property
    def furthest(self) -> str:
        """How far it came, in a word."""
        if self.success:
            return "done"
        if any(self.goals.values()):
            return "some goals"
        return "lifted" if self.lifted else "touched" if self.touched else "nothing touched"


class Evaluation(Document):
    """All episodes of a policy in one run."""

    SCHEMA: ClassVar[str] = "vcage.evaluation/1"

    policy: str = Field(description="as it was named: an address, a factory, 'replay' or 'expert'")
    run: str
    task: str = Field(description="the instruction")
    options: dict[str, object] = Field(description="of the environment and of the asking")
    rollouts: list[Rollout]
    left_out: dict[int, str] = Field(description="seed → why its start is not counted: the expert fails there too")

    @property
    def successes(self) -> int:
        """Number of successful episodes."""
        return sum(rollout.success for rollout in self.rollouts)

    def facts(self) -> dict[str, object]:
        """Figures for programs and people; ``pc_`` are percent, with Wilson's interval at 95 %."""
        count = len(self.rollouts)
        low, high = wilson(self.successes, count)
        names = dict.fromkeys(goal for rollout in self.rollouts for goal in rollout.goals)
        came = [rollout.furthest for rollout in self.rollouts]
        return {
            "n_episodes": count,
            "n_success": self.successes,
            "pc_success": round(100 * self.successes / count, 2) if count else None,
            "pc_success_ci95": [round(100 * low, 2), round(100 * high, 2)],
            "goals": {n: sum(r.goals.get(n, False) for r in self.rollouts) for n in names},
            "furthest": {word: came.count(word) for word in dict.fromkeys(sorted(came))},
            "with_collisions": sum(bool(rollout.collisions) for rollout in self.rollouts),
            "seconds": round(sum(r.seconds for r in self.rollouts) / count, 2) if count else None,
            "left_out": len(self.left_out),
        }
