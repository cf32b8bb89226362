"""Several trainings of each row of the policy benchmark, pooled."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from benchmarks import policy
from benchmarks._policy.pooled import difference, pooled
from vcage.base.errors import UsageError
from vcage.evaluation.evaluate import RECORD
from vcage.schema.evaluation import Evaluation, Rollout, SeedSplit

RIVALS = {"compressed": "raw"}


def evaluation(outcomes: str, first: int = 100_000, **starts: Any) -> Evaluation:
    """An evaluation whose starts end as the letters say: x for a success."""
    rollouts = [
        Rollout(
            seed=first + number,
            instruction="Put the block on the plate.",
            success=letter == "x",
            actions=9,
            seconds=1.0,
            goals={"block on plate": letter == "x"},
            touched=[],
            lifted=[],
            collisions=[],
        )
        for number, letter in enumerate(outcomes)
    ]
    return Evaluation(
        policy="p",
        run="r",
        task="Put the block on the plate",
        seeds=SeedSplit(scene=3, stream=2, first=first),
        starts={"max_steps": 80, **starts},
        asking={},
        rollouts=rollouts,
        left_out={},
    )


TRAININGS = {
    ("raw", 0): evaluation("xxxx.xxxx."),
    ("compressed", 0): evaluation("xxx..xxxxx"),
    ("raw", 1): evaluation("xxxxxxxxxx"),
    ("compressed", 1): evaluation("xxxxx....."),
}


def test_the_trainings_of_a_row_count_as_one() -> None:
    raw, compressed = pooled(TRAININGS, RIVALS)["pooled"]
    assert (raw["trainings"], raw["n_success"], raw["n_episodes"], raw["n_success_by_seed"]) == (2, 18, 20, [8, 10])
    assert raw["pc_success_ci95"] == [69.9, 97.21]
    assert (compressed["n_success"], compressed["n_success_by_seed"]) == (13, [8, 5])


def test_a_row_and_its_rival_are_paired_by_seed_and_start() -> None:
    (found,) = pooled(TRAININGS, RIVALS)["against_rivals"]
    assert (found["trained_on"], found["rival"]) == ("compressed", "raw")
    assert (found["n_pairs"], found["b"], found["c"]) == (20, 1, 6)
    assert found["mcnemar_p"] == pytest.approx(2 * (1 + 7) / 2**7)  # by hand, of 7 that differ
    assert (found["points"], found["points_by_seed"]) == (-25.0, [0.0, -50.0])


def test_trainings_of_one_row_are_paired_by_start() -> None:
    raw, compressed = pooled(TRAININGS, RIVALS)["between_trainings"]
    assert (raw["trained_on"], raw["seed"], raw["other_seed"], raw["b"], raw["c"]) == ("raw", 0, 1, 0, 2)
    assert (compressed["b"], compressed["c"], compressed["mcnemar_p"]) == (5, 2, pytest.approx(58 / 2**7))


def test_a_row_without_its_rival_is_compared_with_none() -> None:
    alone = {key: found for key, found in TRAININGS.items() if key != ("raw", 1)}
    assert pooled(alone, RIVALS)["against_rivals"] == []


def test_trainings_from_other_starts_are_not_compared() -> None:
    other = {**TRAININGS, ("raw", 1): evaluation("xx", max_steps=90)}
    with pytest.raises(UsageError, match="max_steps is 80 here and 90 there"):
        pooled(other, RIVALS)


def test_the_interval_of_a_paired_difference_is_that_of_agresti_and_min() -> None:
    low, high = difference(150, 86, 1600)  # 944 of 1600 people approve at first, 880 later (Agresti)
    assert (low, high) == (pytest.approx(0.0212, abs=1e-4), pytest.approx(0.0587, abs=1e-4))
    assert difference(0, 0, 10) == (pytest.approx(-0.1633, abs=1e-4), pytest.approx(0.1633, abs=1e-4))
    assert difference(1, 0, 1)[1] == 1.0


def test_a_benchmark_of_several_seeds_pools_its_evaluations(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def row(bench: policy._Bench, name: str, seed: int) -> dict[str, Any]:
        folder = bench.evaluation(name, seed)
        folder.mkdir(parents=True)
        TRAININGS[name, seed].write(folder / RECORD)
        return {"trained_on": name, "seed": seed}

    monkeypatch.setattr(policy._Bench, "row", row)
    found = policy.run(quick=True, rows="raw,compressed", data=tmp_path / "two", seeds=2)
    assert [row["n_success"] for row in found["pooled"]] == [18, 13] and len(found["between_trainings"]) == 2
    assert "pooled" not in policy.run(quick=True, rows="raw", data=tmp_path / "one")
