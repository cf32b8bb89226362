"""Evaluations of policies: what is counted, what is kept, and what is refused."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.evaluation.policy_server import policy_server
from tests.run_folders import Finished, command
from vcage.base.errors import InputFileError, StaleStage, UsageError
from vcage.evaluation.environment import EnvironmentOptions
from vcage.evaluation.evaluate import RECORD, Amount, evaluate
from vcage.evaluation.policy import PolicyFailed
from vcage.evaluation.rollouts import Order
from vcage.schema.evaluation import Evaluation, Rollout

BLIND = EnvironmentOptions(pictures=False, max_steps=3)


class Still:
    """A policy that keeps the arms where they are."""

    def reset(self) -> None:
        pass

    def infer(self, observation: Mapping[str, Any]) -> Mapping[str, Any]:
        return {"actions": np.stack([observation["observation/state"]] * 2)}


def order(finished: Finished, policy: str, **changes: Any) -> Order:
    return replace(Order(finished.run.root, policy, BLIND), **changes)


def test_the_expert_succeeds_from_starts_that_are_drawn(finished: Finished, tmp_path: Path) -> None:
    patient = replace(BLIND, max_steps=80)
    record = evaluate(order(finished, "expert", environment=patient), Amount(episodes=1), tmp_path)
    facts = record.facts()
    assert (facts["n_success"], facts["pc_success"]) == (1, 100.0)
    assert set(facts["goals"].values()) == {1} and facts["furthest"] == {"done": 1}


def test_recorded_actions_succeed_from_their_own_start(finished: Finished, capsys, tmp_path: Path) -> None:
    options = ["--policy", "replay", "--episodes", "1", "--no-pictures", "--out", tmp_path]
    done = command(capsys, "evaluate", finished.run.root, *options)
    assert (done.code, done.record["summary"]["n_success"]) == (0, 1)
    assert Evaluation.read(tmp_path / RECORD).policy == "replay"


def test_a_server_is_asked_and_its_failures_are_counted_once(finished: Finished, tmp_path: Path) -> None:
    with policy_server(Still().infer) as address:
        wanted = order(finished, address, solvable=False)
        evaluate(wanted, Amount(episodes=1), tmp_path)
        first = Evaluation.read(tmp_path / RECORD).rollouts
        record = evaluate(wanted, Amount(episodes=2), tmp_path)  # more of the same
    assert record.rollouts[:1] == first and [r.seed for r in record.rollouts] == [100_000, 100_001]
    assert record.facts()["furthest"] == {"nothing touched": 2} and record.rollouts[0].actions == 3


def test_a_factory_makes_a_policy(finished: Finished, tmp_path: Path) -> None:
    wanted = order(finished, "tests.evaluation.test_evaluate:Still", solvable=False)
    assert evaluate(wanted, Amount(episodes=1), tmp_path).successes == 0


def test_what_is_finished_is_kept_when_a_policy_fails(finished: Finished, tmp_path: Path) -> None:
    answers = iter([Still().infer] * 2)

    def breaking(observation: Mapping[str, Any]) -> Mapping[str, Any]:
        return next(answers)(observation) if observation else {}

    with policy_server(breaking) as address, pytest.raises(PolicyFailed, match="StopIteration"):
        evaluate(order(finished, address, solvable=False), Amount(episodes=2), tmp_path)
    assert len(Evaluation.read(tmp_path / RECORD).rollouts) == 1


def test_another_evaluation_in_the_same_folder_is_refused(finished: Finished, tmp_path: Path) -> None:
    still = order(finished, "tests.evaluation.test_evaluate:Still", solvable=False)
    evaluate(still, Amount(episodes=1), tmp_path)
    with pytest.raises(StaleStage, match="another policy"):
        evaluate(replace(still, execute=1), Amount(episodes=1), tmp_path)
    assert len(evaluate(replace(still, execute=1), Amount(episodes=1), tmp_path, force=True).rollouts) == 1


@pytest.mark.parametrize(
    ("policy", "kind", "complaint"),
    [
        ("pi0", UsageError, "names no policy"),
        ("no_such_module:make", InputFileError, "no_such_module"),
        ("collections:OrderedDict", InputFileError, "without infer"),
    ],
)
def test_a_policy_that_cannot_be_made_is_named(
    finished: Finished, tmp_path: Path, policy: str, kind: type[Exception], complaint: str
) -> None:
    with pytest.raises(kind, match=complaint):
        evaluate(order(finished, policy, solvable=False), Amount(episodes=1), tmp_path)


def test_more_episodes_than_were_recorded_cannot_be_replayed(finished: Finished, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="has 1 accepted episodes of this task, not 5"):
        evaluate(order(finished, "replay"), Amount(episodes=5), tmp_path)


def test_shares_have_intervals_and_failures_say_how_far_they_came() -> None:
    def one(seed: int, success: bool, touched: list[str]) -> Rollout:
        return Rollout(
            seed=seed,
            instruction="Put the block on the plate.",
            success=success,
            actions=9,
            seconds=1.0,
            goals={"block on plate": success},
            touched=touched,
            lifted=[],
            collisions=[],
        )

    rollouts = [one(n, n < 9, ["block"] if n < 9 else []) for n in range(10)]
    record = Evaluation(policy="p", run="r", task="t", options={}, rollouts=rollouts, left_out={17: "the expert fails"})
    facts = record.facts()
    assert (facts["n_episodes"], facts["n_success"], facts["left_out"]) == (10, 9, 1)
    assert facts["pc_success_ci95"] == [59.58, 98.21]  # 59.6 % to 98.2 %: lerobot's own example of 9 in 10
    assert facts["furthest"] == {"done": 9, "nothing touched": 1}
