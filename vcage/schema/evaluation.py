"""``evaluation.json``: how a policy did in the environment of a run."""

from __future__ import annotations

from typing import Any, ClassVar

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
    brushed: list[str] = Field(
        default=[], description="things not of the task that arms pressed on lightly: table, left arm, an id"
    )
    collisions: list[str] = Field(description="the same, with 100 N or more at a look; looks are 40 ms apart")

    @property
    def furthest(self) -> str:
        """The furthest point that it reached, in a word."""
        if self.success:
            return "done"
        if any(self.goals.values()):
            return "some goals"
        return "lifted" if self.lifted else "touched" if self.touched else "nothing touched"


class SeedSplit(Record):
    """The random numbers of the starts, which collecting never uses."""

    scene: int = Field(description="seed of the run's scene")
    stream: int = Field(
        description="start n is drawn from [scene, n, stream]; episode n of a collection from [seed, n]"
    )
    first: int = Field(ge=0, description="n of the first start; the others count up")


class Evaluation(Document):
    """All episodes of a policy in one run."""

    SCHEMA: ClassVar[str] = "vcage.evaluation/1"

    policy: str = Field(description="its name; by default the address, the factory, 'replay' or 'expert'")
    run: str
    task: str = Field(description="the instruction")
    seeds: SeedSplit
    starts: dict[str, Any] = Field(description="what decides where an episode begins and how long it may last")
    asking: dict[str, Any] = Field(description="what the policy observes, and how it is asked")
    rollouts: list[Rollout]
    left_out: dict[int, str] = Field(description="seed → why its start is not counted: the expert fails there too")

    @property
    def successes(self) -> int:
        """Number of successful episodes."""
        return sum(rollout.success for rollout in self.rollouts)

    def facts(self) -> dict[str, Any]:
        """Figures for programs and people; ``pc_`` are percent, with Wilson's interval at 95 %."""
        count = len(self.rollouts)
        names = dict.fromkeys(goal for rollout in self.rollouts for goal in rollout.goals)
        came = [rollout.furthest for rollout in self.rollouts]
        return {
            **success_facts(self.successes, count),
            "goals": {n: sum(r.goals.get(n, False) for r in self.rollouts) for n in names},
            "furthest": {word: came.count(word) for word in dict.fromkeys(sorted(came))},
            "with_collisions": sum(bool(rollout.collisions) for rollout in self.rollouts),
            "only_brushing": sum(bool(rollout.brushed and not rollout.collisions) for rollout in self.rollouts),
            "seconds": round(sum(r.seconds for r in self.rollouts) / count, 2) if count else None,
            "left_out": len(self.left_out),
        }


class Comparison(Record):
    """Two evaluations from the same starts."""

    name: str = Field(description="of the other one: its policy, or the factor that was changed")
    n_episodes: int = Field(ge=0, description="starts that both count")
    n_success: int = Field(ge=0, description="of the evaluation, there")
    n_success_other: int = Field(ge=0, description="of the other one, there")
    b: int = Field(ge=0, description="starts from which the evaluation alone succeeds")
    c: int = Field(ge=0, description="starts from which the other alone succeeds")
    mcnemar_p: float = Field(ge=0, le=1, description="two-sided, exact: of b and c as unlike if the two are equal")

    def facts(self) -> dict[str, Any]:
        """Figures, with Wilson's intervals."""
        other = success_facts(self.n_success_other, self.n_episodes)
        return {
            "name": self.name,
            **success_facts(self.n_success, self.n_episodes),
            **{f"{key}_other": value for key, value in other.items() if key != "n_episodes"},
            "b": self.b,
            "c": self.c,
            "mcnemar_p": self.mcnemar_p,
        }


def success_facts(successes: int, count: int) -> dict[str, Any]:
    """Share of successes in percent, with Wilson's interval at 95 %, under the names of lerobot."""
    low, high = wilson(successes, count)
    return {
        "n_episodes": count,
        "n_success": successes,
        "pc_success": round(100 * successes / count, 2) if count else None,
        "pc_success_ci95": [round(100 * low, 2), round(100 * high, 2)],
    }
