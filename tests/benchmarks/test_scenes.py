"""A sub-task of a scene is the same one before and after it was looked into, and its reason is its own."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from benchmarks.scenes import _name, _refusal
from tests.example_scenes import sensible, thing, workplace
from vcage.schema.base import Provenance
from vcage.schema.subtasks import Subtasks
from vcage.tasks.scene_objects import SceneObject
from vcage.tasks.search import find_subtasks
from vcage.tasks.search import sensible as proposed


def searched(objects: Sequence[SceneObject]) -> Subtasks:
    found = find_subtasks(workplace(objects), sensible)
    return Subtasks.model_construct(  # without a chain, where nothing is kept
        provenance=Provenance(producer="test", seed=0),
        instruction=None,
        candidates=found.candidates,
        kept=found.kept,
        refused=found.refused,
        chains=[],
    )


def names(objects: Sequence[SceneObject]) -> set[str]:
    return {_name(proposal.refusal("as any other")) for proposal in proposed(objects, sensible)[0]}


def test_each_proposal_is_kept_or_refused_under_its_name() -> None:
    objects = [
        thing("chocolate_bar", (-0.2, 0.0)),
        thing("electronic_scale", (0.1, 0.05)),
        thing("cabinet_two_drawers", (0.6, 0.9)),
    ]
    found = searched(objects)
    kept = {_name(subtask) for subtask in found.kept}
    assert "weigh chocolate_bar weighed 0" in kept
    refused = names(objects) - kept
    assert refused and not any("no reason given" in _refusal(name, found) for name in refused)


def test_an_infeasible_weighing_says_why() -> None:
    found = searched([thing("chocolate_bar", (0.0, 0.9)), thing("electronic_scale", (0.1, 0.05))])
    assert "does not reach" in _refusal("weigh chocolate_bar weighed 0", found)


@pytest.mark.parametrize("part", ["top", "bottom"])
def test_each_drawer_has_a_reason_of_its_own(part: str) -> None:
    found = searched([thing("cabinet_two_drawers", (0.0, 0.9))])
    reason = _refusal(f"open cabinet_two_drawers/drawer_{part} open None", found)
    assert part in reason
