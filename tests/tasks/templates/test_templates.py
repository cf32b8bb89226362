"""Every template that a record can name is there."""

from __future__ import annotations

from typing import get_args

import pytest

from tests.scenes import block_and_plate, subtask
from vcage.schema.subtasks import TemplateName
from vcage.tasks.templates import TEMPLATES
from vcage.tasks.templates.place import PLACE


def test_every_template_that_a_record_can_name_is_searched():
    assert set(TEMPLATES) == set(get_args(TemplateName))


@pytest.mark.parametrize("template", TEMPLATES.values())
def test_a_script_only_calls_the_task(template):
    calls = template.calls(subtask())
    assert calls and all(call.startswith("task.") for call in calls)


def test_a_pair_is_tried_at_each_contact_point_of_one_and_functional_point_of_the_other():
    block, plate = block_and_plate()
    pairs, refused = PLACE.proposals([block, plate], ())
    assert [(pair.thing.id, pair.receptacle.id, pair.candidates) for pair in pairs if pair.thing.id == "block"] == [
        ("block", "plate", len(block.asset.annotation.contact_points))
    ]
    assert {r.reason for r in refused} <= {
        "red block has no functional point",
        "white plate has no contact point to carry it by",
    }
