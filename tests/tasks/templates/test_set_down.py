"""Putting something down on the table: aside, beside another, back, or before the customer."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import pytest

from tests.example_scenes import TABLE_TOP, thing, workplace
from vcage.base.geometry import Pose
from vcage.schema.goals import Goal
from vcage.schema.plan import TABLE
from vcage.schema.subtasks import Refusal, Subtask
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.templates import TEMPLATES

BLOCK, PLATE = thing("block", (-0.2, 0.0)), thing("plate", (0.1, 0.05))
SHOWN = Goal(subject="payment_sign", relation="presented")


def found(
    template: str, objects: Sequence[SceneObject], asked: Collection[Goal] = ()
) -> tuple[list[Subtask], list[Refusal]]:
    proposals, refused = TEMPLATES[template].proposals(objects, asked)  # pyrefly: ignore
    kept = []
    for proposal in proposals:
        subtask, complaints = proposal.examine(workplace(objects))
        kept += [subtask] if subtask else []
        refused += complaints
    return kept, refused


@pytest.mark.parametrize("word", ["left_of", "right_of", "in_front_of", "behind", "beside", "near"])
def test_an_object_is_put_beside_another_on_request(word: str) -> None:
    goal = Goal(subject=BLOCK.id, relation=word, reference=PLATE.id)  # pyrefly: ignore
    kept, _ = found("set_down", [BLOCK, PLATE], [goal])
    (subtask,) = (s for s in kept if goal in s.goals)
    assert subtask.receptacle == TABLE and subtask.functional_point is None
    assert Goal(subject=BLOCK.id, relation="on", reference=TABLE) in subtask.goals
    assert len({subtask.text, *subtask.texts}) >= 10


def test_without_a_request_nothing_is_put_beside_another() -> None:
    assert not any(s.goals[0].relation == "left_of" for s in found("set_down", [BLOCK, PLATE])[0])


def test_an_object_on_another_can_be_put_aside() -> None:
    lying = BLOCK.moved(Pose([0.1, 0.05, TABLE_TOP + 0.007]))
    lying = SceneObject(lying.record.model_copy(update={"container": PLATE.id}), lying.asset, lying.pose)
    kept, _ = found("set_down", [lying, PLATE])
    assert [s.goals[0] for s in kept] == [Goal(subject="block", relation="on", reference=TABLE)]


def test_an_object_that_cannot_be_carried_is_refused_by_name() -> None:
    goal = Goal(subject=PLATE.id, relation="left_of", reference=BLOCK.id)
    kept, refused = found("set_down", [BLOCK, PLATE], [goal])
    assert not any(s.object == PLATE.id for s in kept)
    assert "no contact point to carry it by" in refused[0].reason


def test_a_sign_is_there_to_be_shown() -> None:
    (subtask,), _ = found("present", [thing("payment_sign", (-0.1, 0.0)), PLATE])
    assert subtask.goals[0] == SHOWN


def test_other_objects_are_shown_on_request() -> None:
    box = thing("cereal_box", (-0.1, 0.0))
    goal = Goal(subject=box.id, relation="presented")
    assert not found("present", [box])[0]
    assert found("present", [box], [goal])[0][0].goals[0] == goal
