"""Planted failures, and the counts of the loop that meets them."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks._loop.chain import Chain
from benchmarks._loop.counted import STEP, attempts, counted
from benchmarks._loop.planted import Causes, Chance, befallen
from benchmarks.loop import Tally, _compared
from tests.example_scenes import GROUND, ON_PLATE, TABLE_TOP, block_and_plate, subtask
from vcage.plans.relations import holds
from vcage.schema.episodes import Failure
from vcage.tasks.ground import Ground

SEEDS = range(60)
GRASP = (0, "left")


# --- what is planted -----------------------------------------------------------------------------------


def test_the_requested_share_of_attempts_fails_by_chance() -> None:
    chance = Chance(0.75, np.random.default_rng(0))
    failures = [chance.failure(STEP, GRASP, ON_PLATE) for _ in range(2000)]
    assert failures.count("lost") / 2000 == pytest.approx(0.25, abs=0.03)
    assert set(failures) == {None, "lost"}


def test_a_cause_stays_as_long_as_the_episode_does() -> None:
    for seed in SEEDS:
        assert len({Causes(0.5, seed).failure(STEP, GRASP, ON_PLATE) for _ in range(3)}) == 1


def test_a_bad_grasp_loses_its_object_and_a_bad_slot_rejects_it() -> None:
    told = [Causes(0.7, seed) for seed in SEEDS]
    failures = [causes.failure(STEP, GRASP, ON_PLATE) for causes in told]
    assert set(failures) == {None, "lost", "astray"}
    assert all((GRASP in causes.bad_grasps(STEP)) == (f == "lost") for causes, f in zip(told, failures, strict=True))


def test_one_grasp_of_a_step_is_always_good() -> None:
    assert all(len(Causes(0.0, seed).bad_grasps(STEP)) == len(STEP.grasps) - 1 for seed in SEEDS)


@pytest.mark.parametrize(("failure", "beside", "far"), [("lost", False, False), ("astray", True, True)])
def test_a_failed_object_ends_where_its_reason_says(failure: Failure, beside: bool, far: bool) -> None:
    block, plate = block_and_plate()
    found = befallen(failure, subtask(), {"block": block, "plate": plate}, block.pose, GROUND, np.random.default_rng(0))
    assert bool(holds("beside", block.moved(found).aabb, plate.aabb)) is beside
    assert bool(np.linalg.norm((found.p - block.pose.p)[:2]) > 0.03) is far


def test_an_object_without_room_beside_its_receptacle_is_lost() -> None:
    block, plate = block_and_plate()
    no_room = Ground(plate.pose.p[:2] - 0.01, plate.pose.p[:2] + 0.01, TABLE_TOP)
    found = befallen(
        "astray", subtask(), {"block": block, "plate": plate}, block.pose, no_room, np.random.default_rng(0)
    )
    assert np.linalg.norm((found.p - block.pose.p)[:2]) < 0.03


# --- what is counted -----------------------------------------------------------------------------------


def test_where_everything_is_good_one_attempt_does_a_step() -> None:
    assert attempts(Causes(1.0, 0), 3, steered=True) == (1, True)


def test_a_reason_spares_attempts_and_more_steps_are_done() -> None:
    told = counted((0.6,), retries=3, steps=300)["good_0.6"]
    assert told["resample"]["attempts_per_step"] < told["blind"]["attempts_per_step"]
    assert told["resample"]["verified"] > told["blind"]["verified"]


def test_figures_belong_to_the_measured_time() -> None:
    tally = Tally(accepted=4, false=1, attempts=30, failed=6, steps=24, named=[("lost", "lost"), ("astray", None)])
    figures = tally.figures(seconds=60.0)
    assert (figures["per_hour"], figures["true_per_hour"]) == (240.0, 180.0)
    assert (figures["attempts_per_step"], figures["attempts_per_accepted"]) == (1.25, 7.5)
    assert (figures["step_success"], figures["named"]) == (0.8, 0.5)


def test_rows_are_measured_by_the_plainest_of_the_same_failures() -> None:
    told = [
        ("chance", "resample", 30.0),
        ("chance", "abort", 10.0),
        ("causes", "resample", 8.0),
        ("causes", "blind", 0),
    ]
    rows = _compared([{"failures": kind, "mode": mode, "per_hour": rate} for kind, mode, rate in told])
    assert [row["over_plain"] for row in rows] == [3.0, 1.0, None, None]


# --- a chain that is carried out -----------------------------------------------------------------------


@pytest.mark.slow
def test_a_step_whose_first_choices_are_bad_is_verified_by_the_first_good_ones() -> None:
    chain = Chain("Put the block in the packaging box", 1)
    many = (chain.carried_out("resample", "perfect", Causes(0.5, seed), 8, seed) for seed in range(20))
    played = next(one for one in many if one.named)
    assert played.run.accepted
    assert all(planted == said for planted, said in played.named)
    assert [a.truth.success for a in played.run.attempts if a.truth] == [False] * len(played.named) + [True]
