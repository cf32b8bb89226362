"""How steps, episodes and reasons are counted."""

from __future__ import annotations

from benchmarks.tasks import Tally, _count
from tests.example_scenes import ON_PLATE, Critic, block_and_plate, play_once, script_of, setting, subtask
from vcage.plans.actions import lasting
from vcage.schema.goals import Goal
from vcage.tasks.loop import run_episode

ON_THE_PLATE = Goal(subject="block", relation="on", reference="plate")


def test_an_episode_whose_goals_hold_counts_as_a_whole() -> None:
    step = subtask()
    made = setting(block_and_plate(), {step.id: ON_PLATE}, Critic([True]))
    done = run_episode(made, [(step, script_of(step))], 0, lasting([[ON_THE_PLATE]]))
    tally = Tally()
    _count([step], done, tally)
    assert (tally.steps, tally.done, tally.whole, dict(tally.failures)) == (1, 1, 1, {})


def test_a_step_that_did_nothing_is_a_failure_with_its_reason_though_a_critic_accepts_it() -> None:
    tally = Tally()
    _count([subtask()], play_once(Critic([True]), play=lambda task: task.home()), tally)
    assert (tally.steps, tally.done, tally.whole) == (1, 0, 0)
    (reason,) = tally.failures
    assert reason.startswith("place at ") and "block is" in reason
