"""The closed loop: verify every sub-task, go back to what was verified, or give up."""

from __future__ import annotations

import numpy as np
import pytest

from tests.example_scenes import (
    ON_PLATE,
    TABLE_TOP,
    Critic,
    block_and_plate,
    play_once,
    script_of,
    setting,
    subtask,
    thing,
    workplace,
)
from vcage.base.geometry import Pose
from vcage.episodes.store import confusion
from vcage.schema.episodes import Failure
from vcage.schema.goals import Goal
from vcage.schema.subtasks import Grasp
from vcage.sim.recording import StateLog
from vcage.tasks.chain_slots import slots_for_chain
from vcage.tasks.loop import EpisodeRun, run_episode
from vcage.tasks.task import Task, TaskFailed

pytestmark = pytest.mark.slow

FAR = Pose([0.3, 0.1, TABLE_TOP])


def spacing(log: StateLog) -> set[int]:
    return set(np.diff([frame.step for frame in log.frames]).tolist())


def same(a: StateLog, b: StateLog) -> bool:
    """Whether two recordings agree bit for bit."""
    return (
        len(a) == len(b)
        and all(
            np.array_equal(a.arm_array(arm, name), b.arm_array(arm, name))
            for arm in a.frames[0].arms
            for name in ("state", "command", "velocity", "joints", "tool")
        )
        and all(np.array_equal(a.object_array(key), b.object_array(key)) for key in a.frames[0].objects)
    )


def knock_away(task: Task) -> None:
    """A script that moves the block elsewhere and does not notice."""
    task.home()
    task.world.set_object_pose("block", FAR)
    task.world.settle()


def pick_out_of_reach(task: Task) -> None:
    """A script that cannot be planned."""
    task.world.set_object_pose("block", Pose([0.0, 0.9, TABLE_TOP]))
    task.pick("block", [(0, "right")])


@pytest.fixture(scope="module")
def critic() -> Critic:
    """Who looked at the accepted episode."""
    return Critic()


@pytest.fixture(scope="module")
def accepted(critic: Critic) -> EpisodeRun:
    return play_once(critic)


@pytest.fixture(scope="module")
def aborted() -> EpisodeRun:
    """The critic refuses the first attempt, and nobody tries again."""
    return play_once(Critic([False, True]), on_failure="abort")


@pytest.fixture(scope="module")
def silent() -> EpisodeRun:
    """The critic accepts a missing result."""
    return play_once(Critic([True]), play=knock_away, accept="critic")


@pytest.fixture(scope="module")
def unplanned() -> tuple[EpisodeRun, Critic]:
    """No grasp can be planned."""
    critic = Critic()
    return play_once(critic, play=pick_out_of_reach, on_failure="abort"), critic


@pytest.fixture(scope="module")
def resampled() -> EpisodeRun:
    """The critic refuses the first attempt and accepts the second."""
    return play_once(Critic([False, True]))


# --- an episode that succeeds --------------------------------------------------------------------------


def test_an_accepted_episode_really_brought_the_block_onto_the_plate(accepted: EpisodeRun):
    assert accepted.accepted
    assert accepted.segments[0].truth.success


def test_an_accepted_episode_says_so(accepted: EpisodeRun):
    assert accepted.reason == "all 1 sub-tasks were verified"


def test_the_log_of_a_clean_episode_has_one_finished_attempt(accepted: EpisodeRun):
    assert [(a.stage, a.accepted, a.attempt) for a in accepted.attempts] == [("done", True, 0)]


def test_the_segment_covers_all_frames_and_names_arm_and_contact(accepted: EpisodeRun):
    (segment,) = accepted.segments
    assert (segment.start, segment.end) == (0, len(accepted.log))
    assert (segment.arm, segment.contact, segment.attempts) == ("left", 0, 1)


def test_the_pictures_of_a_verdict_are_kept_under_the_names_it_gives(accepted: EpisodeRun):
    assert accepted.segments[0].verdict.pictures == [
        "critic/e000000-s0-a0-before-top.png",
        "critic/e000000-s0-a0-after-top.png",
        "critic/e000000-s0-a0-moment-top.png",
    ]
    assert list(accepted.pictures) == accepted.segments[0].verdict.pictures


@pytest.mark.usefixtures("accepted")
def test_the_critic_is_asked_about_the_sub_task_in_its_own_words(critic: Critic):
    assert [asked.text for asked in critic.asked] == ["Put the block on the plate."]


def test_the_same_episode_gives_the_same_states_bit_for_bit(accepted: EpisodeRun):
    assert same(accepted.log, play_once(Critic()).log)


# --- trying again --------------------------------------------------------------------------------------


def test_an_attempt_refused_by_the_critic_is_retried_and_accepted(resampled: EpisodeRun):
    assert resampled.accepted
    assert resampled.segments[0].attempts == 2


def test_the_log_keeps_the_refused_attempt(resampled: EpisodeRun):
    assert [(a.stage, a.accepted, a.attempt) for a in resampled.attempts] == [("verify", False, 0), ("done", True, 1)]


def test_the_pictures_of_a_refused_attempt_are_kept_too(resampled: EpisodeRun):
    assert {name.split("-")[2] for name in resampled.pictures} == {"a0", "a1"}


def test_after_a_retry_frames_are_evenly_spaced_and_complete(resampled: EpisodeRun):
    assert spacing(resampled.log) == {25}


def test_the_frames_of_the_refused_attempt_are_gone(resampled: EpisodeRun, accepted: EpisodeRun):
    assert resampled.log.frames[0].step == accepted.log.frames[0].step
    assert resampled.segments[0].end == len(resampled.log)


def test_the_second_attempt_begins_where_the_first_began(resampled: EpisodeRun, accepted: EpisodeRun):
    first, second = resampled.log.frames[0], accepted.log.frames[0]
    for key in first.objects:
        np.testing.assert_allclose(first.objects[key].matrix(), second.objects[key].matrix(), atol=1e-4)


def test_the_second_attempt_tries_another_grasp():
    grasps = [Grasp(contact=0, arm="left", score=-1.0), Grasp(contact=1, arm="right", score=-2.0)]
    run = play_once(Critic([False, True]), subtask(grasps=grasps))
    assert [(a.contact, a.arm) for a in run.attempts] == [(0, "left"), (1, "right")]


@pytest.mark.parametrize(
    ("failure", "changes"), [("lost", ["arm instead of"]), ("astray", ["from the slot"]), (False, ["arm", "slot"])]
)
def test_the_critics_reason_decides_the_next_change(failure: Failure | bool, changes: list[str]):
    grasps = [Grasp(contact=0, arm="left", score=-1.0), Grasp(contact=1, arm="right", score=-2.0)]
    run = play_once(Critic([failure, True]), subtask(grasps=grasps))
    assert run.accepted
    assert all(word in change for word, change in zip(changes, run.attempts[1].changes, strict=True))


def test_a_third_attempt_avoids_the_failures_of_both_others():
    grasps = [Grasp(contact=0, arm="left", score=-1.0), Grasp(contact=1, arm="right", score=-2.0)]
    run = play_once(Critic(["lost", "astray", True]), subtask(grasps=grasps))
    assert [(a.contact, a.arm) for a in run.attempts] == [(0, "left"), (1, "right"), (1, "right")]
    assert [any("from the slot" in change for change in a.changes) for a in run.attempts] == [False, False, True]


def test_a_slipped_object_is_held_differently_and_goes_to_the_same_slot():
    grasps = [Grasp(contact=0, arm="left", score=-1.0), Grasp(contact=1, arm="right", score=-2.0)]

    def lose_once(task: Task) -> None:
        task.pick("block", [(g.contact, g.arm) for g in grasps])
        if task.arm == "left":
            raise TaskFailed("grasp", "it slipped")
        task.place("plate")
        task.home()

    run = play_once(Critic(), subtask(grasps=grasps), lose_once)
    assert [a.stage for a in run.attempts] == ["grasp", "done"]
    assert run.attempts[1].changes == ["contact 1 with the right arm instead of contact 0 with the left arm"]


def test_an_episode_with_a_retry_is_the_same_bit_for_bit_when_it_is_run_again(resampled: EpisodeRun):
    assert same(resampled.log, play_once(Critic([False, True])).log)


def test_a_failure_after_an_accepted_sub_task_keeps_the_accepted_state():
    objects = [thing("marker", (-0.2, 0.0), np.pi / 2), thing("block", (0.22, 0.0)), thing("packaging_box", (0, 0.05))]
    steps = [
        subtask("marker", "packaging_box", "inside"),
        subtask("block", "packaging_box", "inside", grasps=[Grasp(contact=0, arm="right", score=0.0)]),
    ]
    slots = slots_for_chain(steps, workplace(objects))
    there = setting(objects, slots, Critic([True, False, True]), retries=1)
    run = run_episode(there, [(step, script_of(step)) for step in steps], 0)
    assert run.accepted
    assert [(a.step, a.attempt, a.accepted) for a in run.attempts] == [(0, 0, True), (1, 0, False), (1, 1, True)]
    assert spacing(run.log) == {25}
    first, second = run.segments
    assert (first.start, first.end, second.end) == (0, second.start, len(run.log))
    assert first.truth.success and second.truth.success


# --- giving up -----------------------------------------------------------------------------------------


def test_in_abort_mode_the_first_refusal_ends_the_episode(aborted: EpisodeRun):
    assert not aborted.accepted
    assert len(aborted.attempts) == 1


def test_when_the_retries_are_used_up_the_episode_is_rejected_with_the_reason():
    run = play_once(Critic([False]), retries=2)
    assert not run.accepted
    assert [a.stage for a in run.attempts] == ["verify"] * 3
    refused = "the critic says no: it is not there; the simulator's state says yes: block on plate"
    assert run.reason == f"block-onto-plate failed at verify: {refused}"


def test_the_recording_of_a_rejected_episode_ends_with_its_last_attempt_as_no_segment(aborted: EpisodeRun):
    assert (len(aborted.log) > 0, aborted.segments) == (True, [])


def test_a_failed_sub_task_ends_the_chain():
    objects, step = block_and_plate(), subtask()
    critic = Critic([False])
    there = setting(objects, {step.id: ON_PLATE}, critic, on_failure="abort")
    run = run_episode(there, [(step, script_of(step)), (step, script_of(step))], 0)
    assert {a.step for a in run.attempts} == {0}


def test_a_grasp_that_cannot_be_planned_is_an_attempt_that_ends_at_the_plan(unplanned: tuple[EpisodeRun, Critic]):
    run, critic = unplanned
    (attempt,) = run.attempts
    assert (attempt.stage, attempt.accepted, attempt.verdict) == ("plan", False, None)
    assert "no grasp of red block can be planned" in attempt.reason
    assert critic.asked == []


def test_a_plan_that_nothing_can_change_is_not_tried_again(unplanned: tuple[EpisodeRun, Critic]):
    run = play_once(Critic(), play=pick_out_of_reach, retries=3)
    assert [a.stage for a in run.attempts] == ["plan"]
    assert run.reason == f"block-onto-plate failed at plan: {unplanned[0].attempts[0].reason}"


def test_a_place_that_fails_is_tried_again():
    tries = []

    def fail_once(task: Task) -> None:
        tries.append(task)
        task.pick("block", [(0, "left")])
        if len(tries) == 1:
            task.world.set_object_pose("plate", Pose([0.0, 1.2, TABLE_TOP]))
        task.place("plate")
        task.home()

    run = play_once(Critic(), play=fail_once)
    assert [a.stage for a in run.attempts] == ["plan", "done"]
    assert run.segments[0].truth.success


def test_an_attempt_states_its_changes():
    grasps = [Grasp(contact=0, arm="left", score=-1.0), Grasp(contact=1, arm="right", score=-2.0)]
    run = play_once(Critic([False, True]), subtask(grasps=grasps))
    assert run.attempts[0].changes == []
    grasp, slot = run.attempts[1].changes
    assert grasp == "contact 1 with the right arm instead of contact 0 with the left arm"
    assert "cm from the slot that was planned" in slot


# --- who must say yes ----------------------------------------------------------------------------------


def test_an_attempt_accepted_by_the_critic_against_the_state_is_retried_and_then_rejected():
    run = play_once(Critic([True]), play=knock_away, retries=1)
    assert not run.accepted
    assert [(a.stage, a.disputed) for a in run.attempts] == [("verify", True)] * 2
    assert "the simulator's state says no: block is" in run.reason
    assert "the critic says yes: it is there" in run.reason


def test_an_attempt_refused_by_the_critic_is_accepted_where_the_state_decides():
    run = play_once(Critic([False]), accept="state")
    assert run.accepted
    assert [(a.stage, a.disputed) for a in run.attempts] == [("done", True)]


def test_an_attempt_refused_by_the_state_is_rejected_where_the_state_decides():
    assert not play_once(Critic([True]), play=knock_away, accept="state", retries=0).accepted


def test_an_attempt_both_agree_on_is_not_disputed(accepted: EpisodeRun):
    assert [a.disputed for a in accepted.attempts] == [False]


@pytest.mark.parametrize(("accept", "accepted"), [("both", False), ("state", False), ("critic", True)])
def test_an_episode_whose_goals_do_not_hold_at_its_end_is_rejected_unless_the_critic_decides(accept, accepted):
    objects, step = block_and_plate(), subtask()
    there = setting(objects, {step.id: ON_PLATE}, Critic(), accept=accept)
    undone = Goal(subject="plate", relation="on", reference="block")
    run = run_episode(there, [(step, script_of(step))], 0, [undone])
    assert run.accepted is accepted
    assert accepted or run.reason.startswith("every sub-task was verified, but at the end ")


# --- the simulator's truth -----------------------------------------------------------------------------


def test_a_silent_failure_is_known_to_the_truth_though_the_critic_accepts_it(silent: EpisodeRun):
    assert silent.accepted
    assert not silent.segments[0].truth.success
    assert "outside plate" in silent.segments[0].truth.reason


def test_a_silent_failure_counts_as_a_false_acceptance_of_the_critic(silent: EpisodeRun):
    counts = confusion(silent.attempts)
    assert (counts.judged, counts.false_accepted) == (1, 1)


def test_a_refused_success_counts_as_a_false_refusal_of_the_critic(resampled: EpisodeRun):
    counts = confusion(resampled.attempts)
    assert (counts.judged, counts.false_refused, counts.true_accepted) == (2, 1, 1)


def test_an_attempt_that_never_reached_the_critic_is_not_held_against_it(unplanned: tuple[EpisodeRun, Critic]):
    assert confusion(unplanned[0].attempts).judged == 0


# --- an arm that is asked for --------------------------------------------------------------------------


def test_an_attempt_with_the_requested_arm_is_accepted():
    run = play_once(Critic(), subtask(arm="left"))
    assert run.accepted and run.segments[0].arm == "left"


def test_an_attempt_with_another_arm_is_refused_though_the_critic_says_yes():
    run = play_once(Critic(), subtask(arm="right"), retries=0)
    assert not run.accepted
    told = "the simulator's state says no: the left arm took hold of block, which was asked of the right arm"
    assert told in run.reason


def test_further_attempts_stay_with_the_requested_arm():
    grasps = [Grasp(contact=contact, arm="left", score=-1.0) for contact in (0, 1)]
    run = play_once(Critic(["disturbed", False, True]), subtask(arm="left", grasps=grasps))
    assert run.accepted
    assert [a.arm for a in run.attempts] == ["left"] * 3
