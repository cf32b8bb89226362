"""Episodes of a policy in the environment of a run, one for each start."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vcage.base.errors import InfeasibleScene, UnknownName
from vcage.base.files import RunFolder
from vcage.datasets.reader import EpisodeReader
from vcage.evaluation.environment import Observation, RunEnv
from vcage.evaluation.environment_options import EnvironmentOptions
from vcage.evaluation.payload import Payload, names_in, payload, require_possible
from vcage.evaluation.policy import LocalPolicy, Policy, PolicyFailed, checked_actions
from vcage.evaluation.remote_policy import RemotePolicy
from vcage.runs.accepted import accepted_episodes
from vcage.schema.evaluation import Rollout
from vcage.tasks.assemble import recorded_actions

EXPERT, REPLAY = "expert", "replay"
"""Names of the two policies that need no program: the scripts, and the recorded actions from their own starts."""


Ask = Callable[[Observation], NDArray[np.float64]]
"""Observation → (n, D) actions to carry out before the next look."""


@dataclass(frozen=True)
class Order:
    """A policy, the way to ask it, and the environment.

    Args:
        run: folder of the run.
        policy: ``ws://HOST:PORT``, ``MODULE:FACTORY``, ``replay`` or ``expert``.
        environment: of the episodes.
        payload: words of the observations that are sent.
        execute: actions of an answer that are carried out before the policy is asked again.
        solvable: count only starts from which the expert does the task.
        name: of the policy in the record; None for ``policy``.
    """

    run: Path
    policy: str
    environment: EnvironmentOptions = field(default_factory=EnvironmentOptions)
    payload: Payload = "generic"
    execute: int = 8
    solvable: bool = True
    name: str | None = None


@dataclass(frozen=True)
class Outcome:
    """The outcome of one start.

    Args:
        seed: of the start.
        rollout: the episode; None if it is not counted.
        actions: (T, D) that were carried out.
        left_out: why it is not counted.
    """

    seed: int
    rollout: Rollout | None = None
    actions: NDArray[np.float64] | None = None
    left_out: str | None = None


class Rollouts:
    """The episodes of an order, in one process.

    Args:
        order: what to run.

    Attributes:
        policy: is made or connected when it is first asked; None for ``replay`` and ``expert``.

    Raises:
        MissingStage, UnknownName, NoRenderer: see :class:`RunEnv`.
        UsageError: the order names no policy, or its observations cannot be sent as it says.
    """

    def __init__(self, order: Order):
        self.order = order
        self.policy = _policy(order.policy)
        self.env = RunEnv(order.run, order.environment)
        if self.policy is not None:
            require_possible(order.payload, len(self.env.joint_names), self.env.cameras)

    def outcome(self, seed: int) -> Outcome:
        """Run the episode of a start.

        Args:
            seed: of a drawn start; for ``replay``, the number of a recorded episode.

        Raises:
            InputFileError: the policy cannot be made.
            PolicyFailed, EndpointFailed: it answers wrongly, or not at all.
        """
        try:
            observation = self.begun(seed)
        except InfeasibleScene as error:
            return Outcome(seed, left_out=error.message)
        if self.order.policy == REPLAY:
            return self._played(seed, observation, self.following(self._recorded_actions(seed)))
        shown = self.env.expert() if self.order.solvable or self.order.policy == EXPERT else None
        if shown is not None and self.order.policy == EXPERT:
            return self._played(seed, observation, self.following(recorded_actions(shown.log)))
        if shown is not None and not shown.accepted:
            return Outcome(seed, left_out=f"the expert fails: {shown.reason}")
        assert self.policy is not None
        self.policy.reset()
        return self._played(seed, observation, partial(self._asked, self.policy))

    def begun(self, seed: int) -> Observation:
        """Begin the episode of a start; its first observation.

        Raises:
            InfeasibleScene: the objects do not stay where they are put.
        """
        start: dict[str, Any] = {"options": {"episode": seed}} if self.order.policy == REPLAY else {"seed": seed}
        return self.env.reset(**start)[0]

    @staticmethod
    def following(actions: NDArray[np.float64]) -> Ask:
        """Carries actions out; when they are over, the arms stay."""
        left = iter([actions])
        return lambda _: next(left, actions[-1:])

    def recorded(self) -> list[int]:
        """Numbers of the accepted episodes of the task."""
        chain = self.order.environment.chain
        return [e.index for e in accepted_episodes(RunFolder(self.order.run)) if e.chain == chain]

    def _played(self, seed: int, observation: Observation, ask: Ask) -> Outcome:
        """Act until the episode ends."""
        sentence, over, done, info = observation["instruction"], False, [], {}
        while not over:
            for action in ask(observation if not done else self.env.observe()):
                success, late, info = self.env.act(action)
                done.append(action)
                over = success or late
                if over:
                    break
        names = ("success", "seconds", "goals", "touched", "lifted", "brushed", "collisions")
        kept = {key: info[key] for key in names}
        return Outcome(seed, Rollout(seed=seed, instruction=sentence, actions=len(done), **kept), np.array(done))

    def _asked(self, policy: Policy, observation: Observation) -> NDArray[np.float64]:
        sent = payload(observation, self.order.payload)
        try:
            answer = policy.infer(sent)
        except PolicyFailed as error:
            error.hint = error.hint or f"it was sent {', '.join(names_in(sent))}"
            raise
        return checked_actions(answer, len(self.env.joint_names), self.order.policy)[: self.order.execute]

    def _recorded_actions(self, index: int) -> NDArray[np.float64]:
        """(T, D) of a recorded episode."""
        run = RunFolder(self.order.run)
        found = {e.index: e for e in accepted_episodes(run)}
        if index not in found:
            raise UnknownName("accepted episode", str(index), map(str, found))
        with EpisodeReader(run.file(str(found[index].file))) as reader:
            return reader.episode.action


def _policy(name: str) -> Policy | None:
    """The policy of a name.

    Raises:
        UsageError: it names none.
    """
    if name in (EXPERT, REPLAY):
        return None
    return RemotePolicy(name) if "://" in name else LocalPolicy(name)


@lru_cache(maxsize=1)
def rollouts(order: Order) -> Rollouts:
    """The rollouts of an order, kept by this process."""
    return Rollouts(order)


def outcome(task: tuple[Order, int]) -> Outcome:
    """Run one start of an order; for worker processes."""
    order, seed = task
    return rollouts(order).outcome(seed)
