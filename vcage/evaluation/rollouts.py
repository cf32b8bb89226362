"""Episodes of a policy in the environment of a run, one for each start."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import InfeasibleScene, UnknownName
from vcage.base.files import RunFolder
from vcage.datasets.reader import EpisodeReader
from vcage.evaluation.environment import EnvironmentOptions, Observation, RunEnv
from vcage.evaluation.payload import Payload, payload
from vcage.evaluation.policy import Policy, checked_actions, made_by
from vcage.evaluation.remote_policy import RemotePolicy
from vcage.runs.accepted import accepted_episodes
from vcage.schema.evaluation import Rollout
from vcage.tasks.assemble import recorded_actions

EXPERT, REPLAY = "expert", "replay"
"""Names of the two policies that need no program: the scripts, and the recorded actions from their own starts."""


@dataclass(frozen=True)
class Order:
    """How a policy is asked, and where.

    Args:
        run: folder of the run.
        policy: ``ws://HOST:PORT``, ``MODULE:FACTORY``, ``replay`` or ``expert``.
        environment: of the episodes.
        payload: words of the observations that are sent.
        execute: actions of an answer that are carried out before the policy is asked again.
        solvable: count only starts from which the expert does the task.
    """

    run: Path
    policy: str
    environment: EnvironmentOptions = field(default_factory=EnvironmentOptions)
    payload: Payload = "generic"
    execute: int = 8
    solvable: bool = True


@dataclass(frozen=True)
class Outcome:
    """The outcome of one start: a rollout, or why it is not counted."""

    seed: int
    rollout: Rollout | None
    left_out: str | None = None


class Rollouts:
    """The episodes of an order, in one process.

    Args:
        order: what to run.

    Raises:
        MissingStage, UnknownName, NoRenderer: see :class:`RunEnv`.
        UsageError, InputFileError: the policy cannot be made.
    """

    def __init__(self, order: Order):
        self.order = order
        self.env = RunEnv(order.run, order.environment)

    @cached_property
    def policy(self) -> Policy:
        """The policy, made or connected when it is first needed."""
        name = self.order.policy
        return RemotePolicy(name) if "://" in name else made_by(name)

    def outcome(self, seed: int) -> Outcome:
        """Run the episode of a start.

        Args:
            seed: of a drawn start; for ``replay``, the number of a recorded episode.

        Raises:
            PolicyFailed: the policy answers wrongly, or not at all.
        """
        if self.order.policy == REPLAY:
            return Outcome(seed, self._followed(seed, self._recorded_actions(seed), {"episode": seed}))
        try:
            observation, _ = self.env.reset(seed=seed)
        except InfeasibleScene as error:
            return Outcome(seed, None, error.message)
        shown = self.env.expert() if self.order.solvable or self.order.policy == EXPERT else None
        if self.order.policy == EXPERT and shown is not None:
            return Outcome(seed, self._followed(seed, recorded_actions(shown.log)))
        if shown is not None and not shown.accepted:
            return Outcome(seed, None, f"the expert fails: {shown.reason}")
        self.policy.reset()
        return Outcome(seed, self._played(seed, observation, self._asked))

    def recorded(self) -> list[int]:
        """Numbers of the accepted episodes of the task."""
        chain = self.order.environment.chain
        return [e.index for e in accepted_episodes(RunFolder(self.order.run)) if e.chain == chain]

    def _played(
        self, seed: int, observation: Observation, ask: Callable[[Observation], NDArray[np.float64]]
    ) -> Rollout:
        """Act until the episode ends."""
        sentence, over, actions, info = observation["instruction"], False, 0, {}
        while not over:
            for action in ask(observation)[: self.order.execute]:
                observation, _, done, late, info = self.env.step(action)
                actions, over = actions + 1, done or late
                if over:
                    break
        kept = {key: info[key] for key in ("success", "seconds", "goals", "touched", "lifted", "collisions")}
        return Rollout(seed=seed, instruction=sentence, actions=actions, **kept)

    def _asked(self, observation: Observation) -> NDArray[np.float64]:
        answer = self.policy.infer(payload(observation, self.order.payload))
        return checked_actions(answer, len(self.env.joint_names), self.order.policy)

    def _recorded_actions(self, index: int) -> NDArray[np.float64]:
        """(T, D) of a recorded episode."""
        run = RunFolder(self.order.run)
        found = {e.index: e for e in accepted_episodes(run)}
        if index not in found:
            raise UnknownName("accepted episode", str(index), map(str, found))
        with EpisodeReader(run.file(str(found[index].file))) as reader:
            return reader.episode.action

    def _followed(self, seed: int, actions: NDArray[np.float64], start: Mapping[str, int] | None = None) -> Rollout:
        """Carry recorded actions out; when they are over, the arms stay."""
        observation, _ = self.env.reset(seed=None if start else seed, options=dict(start or {}))
        left = iter(actions)
        return self._played(seed, observation, lambda _: next(left, actions[-1])[None])


@lru_cache(maxsize=1)
def rollouts(order: Order) -> Rollouts:
    """The rollouts of an order, kept by this process."""
    return Rollouts(order)


def outcome(task: tuple[Order, int]) -> Outcome:
    """Run one start of an order; for worker processes."""
    order, seed = task
    return rollouts(order).outcome(seed)
