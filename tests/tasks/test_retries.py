"""What a further attempt does otherwise, by why the earlier ones failed."""

from __future__ import annotations

from dataclasses import replace

import pytest

from vcage.base.geometry import Pose
from vcage.schema.episodes import AttemptStage, Failure
from vcage.tasks.retries import Choice, Failed, Retry, blamed
from vcage.tasks.slots import Slot

GRASPS = [(0, "left"), (1, "left"), (0, "right")]
SLOTS = [Slot("box", 0, Pose([x, 0.0, 0.0])) for x in (0.0, 0.05, 0.1)]


def first(*failed: tuple[tuple[int, str], Slot, set[Choice]]) -> tuple[tuple[int, str], Slot]:
    """The grasp and the slot that are tried first after some failures."""
    past = tuple(Failed(*grasp, slot, frozenset(to_blame)) for grasp, slot, to_blame in failed)
    slot, grasps = next(Retry(past).choices(GRASPS, SLOTS))
    return grasps[0], slot


@pytest.mark.parametrize(
    ("stage", "failure", "choices"),
    [
        ("verify", "lost", {"grasp"}),
        ("verify", "astray", {"slot"}),
        ("verify", "disturbed", {"arm", "slot"}),
        ("verify", None, {"grasp", "slot"}),
        ("grasp", None, {"grasp"}),
        ("place", None, {"slot"}),
        ("plan", None, {"arm"}),
    ],
)
def test_the_failure_reason_names_the_part_to_blame(stage: AttemptStage, failure: Failure | None, choices: set[Choice]):
    assert blamed(stage, failure) == choices


def test_a_first_attempt_takes_the_first_of_everything():
    assert first() == (GRASPS[0], SLOTS[0])


@pytest.mark.parametrize(
    ("choices", "grasp", "slot"),
    [
        ({"grasp"}, GRASPS[1], SLOTS[0]),
        ({"slot"}, GRASPS[0], SLOTS[1]),
        ({"arm"}, GRASPS[2], SLOTS[0]),
        ({"arm", "slot"}, GRASPS[2], SLOTS[1]),
        ({"grasp", "slot"}, GRASPS[1], SLOTS[1]),
    ],
)
def test_the_part_to_blame_changes_and_the_rest_stays(choices: set[Choice], grasp: tuple[int, str], slot: Slot):
    assert first((GRASPS[0], SLOTS[0], choices)) == (grasp, slot)


def test_a_blamed_part_stays_avoided_when_something_else_fails_later():
    assert first((GRASPS[0], SLOTS[0], {"grasp"}), (GRASPS[1], SLOTS[0], {"slot"})) == (GRASPS[1], SLOTS[1])


def test_a_failed_combination_is_retried_only_after_everything_else():
    past = Retry((Failed(*GRASPS[0], SLOTS[0], frozenset({"grasp"})),))
    tried = [(grasp, slot) for slot, some in past.choices(GRASPS[:1], SLOTS) for grasp in some]
    assert tried == [(GRASPS[0], SLOTS[1]), (GRASPS[0], SLOTS[2]), (GRASPS[0], SLOTS[0])]


def test_a_slot_is_recognised_in_a_rebuilt_world():
    trifle = replace(SLOTS[0], pose=Pose(SLOTS[0].pose.p + 1e-6))
    assert first((GRASPS[0], trifle, {"slot"})) == (GRASPS[0], SLOTS[1])


def test_an_object_put_nowhere_is_held_differently():
    past = Retry((Failed(*GRASPS[0], None, frozenset({"slot"})),))
    assert [some for _, some in past.choices(GRASPS, [None])] == [GRASPS[1:], GRASPS[:1]]


def test_a_push_that_failed_is_tried_by_the_other_arm():
    past = Retry((Failed(None, "left", SLOTS[0], frozenset({"grasp"})),))
    assert next(past.choices([(None, "left"), (None, "right")], SLOTS)) == (SLOTS[0], [(None, "right")])


def test_without_any_grasp_each_slot_is_named_once():
    assert list(Retry().choices([], SLOTS)) == [(slot, []) for slot in SLOTS]
